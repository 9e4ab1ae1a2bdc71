#include "service/report/scene_picture.h"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

namespace palpate {
namespace {

constexpr std::uint32_t kPictureWidth = 420,
                        kPictureHeight = 300;                    // pixels (chosen: three beside each other)
constexpr int kFiner = 2;                                        // each pixel is the mean of so many squared
const Vec3 kTowardsEye = glm::normalize(Vec3(0.35, -1.0, 0.6));  // x to the right, from above
const Vec3 kLight = glm::normalize(Vec3(-0.4, -0.7, 1.0));
constexpr std::array<double, 3> kGrey{0.74, 0.75, 0.77}, kBlue{0.0, 0.447, 0.698};  // the viewer's cmt
constexpr double kShinesThrough = 0.45;  // of the tool, where the mock-up hides it

/// An orthographic look: pixels to the right and down, and how near the eye, m.
struct Look {
  Vec3 right, up, middle;
  double pixels_per_m = 1;
  Vec3 at(const Vec3& p) const {
    const Vec3 from = p - middle;
    return Vec3(kFiner * kPictureWidth / 2.0 + pixels_per_m * glm::dot(from, right),
                kFiner * kPictureHeight / 2.0 - pixels_per_m * glm::dot(from, up),
                glm::dot(from, kTowardsEye));
  }
};

/// How near the nearest surface is at each fine pixel, and how bright.
struct Layer {
  std::vector<float> nearness = std::vector<float>(
      std::size_t{kFiner} * kFiner * kPictureWidth * kPictureHeight, -std::numeric_limits<float>::infinity());
  std::vector<float> light = std::vector<float>(nearness.size(), 0.0f);

  void draw(const std::array<Vec3, 3>& corners, const Look& look) {
    const Vec3 normal = glm::cross(corners[1] - corners[0], corners[2] - corners[0]);
    const double size = glm::length(normal);
    if (!(size > 0)) return;
    const std::array<Vec3, 3> p{look.at(corners[0]), look.at(corners[1]), look.at(corners[2])};
    const double area = (p[1].x - p[0].x) * (p[2].y - p[0].y) - (p[1].y - p[0].y) * (p[2].x - p[0].x);
    if (area == 0) return;
    constexpr int kPixelColumns = kFiner * static_cast<int>(kPictureWidth),
                  kPixelRows = kFiner * static_cast<int>(kPictureHeight);
    const auto range = [&](int axis, int most, int& first, int& last) {
      const double low = std::min({p[0][axis], p[1][axis], p[2][axis]}),
                   high = std::max({p[0][axis], p[1][axis], p[2][axis]});
      first = static_cast<int>(std::clamp(std::ceil(low - 0.5), 0.0, static_cast<double>(most)));
      last = static_cast<int>(std::clamp(std::floor(high - 0.5), -1.0, most - 1.0));
    };
    int x0, x1, y0, y1;
    range(0, kPixelColumns, x0, x1);
    range(1, kPixelRows, y0, y1);
    const auto bright = static_cast<float>(0.35 + 0.65 * std::fabs(glm::dot(normal, kLight)) / size);
    for (int y = y0; y <= y1; ++y)
      for (int x = x0; x <= x1; ++x) {
        const double px = x + 0.5, py = y + 0.5;
        std::array<double, 3> share{};
        for (std::size_t k = 0; k < 3; ++k) {
          const Vec3 &a = p[(k + 1) % 3], &b = p[(k + 2) % 3];
          share[k] = ((b.x - a.x) * (py - a.y) - (b.y - a.y) * (px - a.x)) / area;
        }
        if (share[0] < 0 || share[1] < 0 || share[2] < 0) continue;
        const auto near = static_cast<float>(share[0] * p[0].z + share[1] * p[1].z + share[2] * p[2].z);
        const std::size_t at = static_cast<std::size_t>(y) * kPixelColumns + static_cast<std::size_t>(x);
        if (near > nearness[at]) nearness[at] = near, light[at] = bright;
      }
  }
};

Image merged(const Layer& mockup, const Layer& tool) {
  Image out{kPictureWidth, kPictureHeight, {}};
  constexpr float kNothing = -std::numeric_limits<float>::infinity();
  for (std::size_t row = 0; row < kPictureHeight; ++row)
    for (std::size_t column = 0; column < kPictureWidth; ++column) {
      std::array<double, 3> sum{};
      int covered = 0;
      for (std::size_t k = 0; k < std::size_t{kFiner} * kFiner; ++k) {
        const std::size_t at =
            (row * kFiner + k / kFiner) * kFiner * kPictureWidth + column * kFiner + k % kFiner;
        const bool fixed = mockup.nearness[at] > kNothing, moving = tool.nearness[at] > kNothing;
        if (!fixed && !moving) continue;
        ++covered;
        const double blue = !moving ? 0 : tool.nearness[at] >= mockup.nearness[at] ? 1 : kShinesThrough;
        for (std::size_t c = 0; c < 3; ++c)
          sum[c] += blue * kBlue[c] * (moving ? tool.light[at] : 0) +
                    (1 - blue) * kGrey[c] * (fixed ? mockup.light[at] : 0);
      }
      for (std::size_t c = 0; c < 3; ++c)
        out.pixels.push_back(
            static_cast<std::uint8_t>(covered > 0 ? std::lround(255 * std::min(1.0, sum[c] / covered)) : 0));
      out.pixels.push_back(static_cast<std::uint8_t>(255 * covered / (kFiner * kFiner)));
    }
  return out;
}

void append_number(std::string& out, std::uint32_t value) {
  for (int shift = 24; shift >= 0; shift -= 8) out.push_back(static_cast<char>(value >> shift & 0xff));
}

void append_chunk(std::string& out, const char* type, const std::string& data) {
  append_number(out, static_cast<std::uint32_t>(data.size()));
  const std::string body = type + data;
  out += body;
  append_number(out, static_cast<std::uint32_t>(crc32(0, reinterpret_cast<const Bytef*>(body.data()),
                                                      static_cast<uInt>(body.size()))));
}

std::string png(const Image& image) {
  std::string rows;  // each begins with its filter, none
  const std::size_t length = std::size_t{4} * image.width;
  for (std::size_t y = 0; y < image.height; ++y) {
    rows.push_back('\0');
    rows.append(reinterpret_cast<const char*>(image.pixels.data()) + y * length, length);
  }
  std::string packed(compressBound(static_cast<uLong>(rows.size())), '\0');
  auto size = static_cast<uLongf>(packed.size());
  if (compress2(reinterpret_cast<Bytef*>(packed.data()), &size, reinterpret_cast<const Bytef*>(rows.data()),
                static_cast<uLong>(rows.size()), Z_BEST_COMPRESSION) != Z_OK)
    return {};
  packed.resize(size);
  std::string head;
  append_number(head, image.width);
  append_number(head, image.height);
  head.append("\x08\x06\x00\x00\x00", 5);  // eight bits, colour and opacity
  std::string out = "\x89PNG\r\n\x1a\n";
  append_chunk(out, "IHDR", head);
  append_chunk(out, "IDAT", packed);
  append_chunk(out, "IEND", "");
  return out;
}

std::string base64(const std::string& bytes) {
  constexpr const char* kLetters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t three = 0;
    for (std::size_t k = 0; k < 3; ++k)
      three = three << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
    for (std::size_t k = 0; k < 4; ++k)
      out.push_back(i + k <= bytes.size() ? kLetters[three >> (18 - 6 * k) & 63] : '=');
  }
  return out;
}

}  // namespace

std::vector<Image> scene_pictures(const SceneGeometry& geometry, const std::vector<Pose>& poses) {
  const auto world = [&](const Int3& p) {
    return geometry.lattice.origin_m + geometry.lattice.step_m * Vec3(p);
  };
  Look look;
  look.right = glm::normalize(glm::cross(Vec3(0, 0, 1), kTowardsEye));
  look.up = glm::cross(kTowardsEye, look.right);
  // The box of all places of the tool, along the picture's own axes.
  std::vector<std::optional<LatticePose>> places;
  Vec3 low(HUGE_VAL), high(-HUGE_VAL);
  for (const Pose& pose : poses) {
    const auto rounded = to_lattice(pose, geometry);
    places.emplace_back(rounded ? std::optional(*rounded) : std::nullopt);
    if (!rounded) continue;
    for (std::uint32_t t = 0; t < geometry.tool.triangles.size(); ++t)
      for (int k = 0; k < 3; ++k) {
        const Vec3 p = world(transform(*rounded, geometry.tool.corner(t, k)));
        const Vec3 seen(glm::dot(p, look.right), glm::dot(p, look.up), glm::dot(p, kTowardsEye));
        low = glm::min(low, seen), high = glm::max(high, seen);
      }
  }
  std::vector<Image> out(poses.size());
  if (!(low.x <= high.x)) return out;
  const Vec3 middle = 0.5 * (low + high), size = high - low;
  look.middle = middle.x * look.right + middle.y * look.up + middle.z * kTowardsEye;
  const double room = 4.0 / 3;
  look.pixels_per_m = kFiner * std::min(kPictureWidth / std::max(room * size.x, 1e-9),
                                        kPictureHeight / std::max(room * size.y, 1e-9));
  Layer mockup;
  for (std::uint32_t t = 0; t < geometry.mockup.triangles.size(); ++t)
    mockup.draw({world(geometry.mockup.corner(t, 0)), world(geometry.mockup.corner(t, 1)),
                 world(geometry.mockup.corner(t, 2))},
                look);
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (!places[i]) continue;
    Layer tool;
    const auto corner = [&](std::uint32_t t, int k) {
      return world(transform(*places[i], geometry.tool.corner(t, k)));
    };
    for (std::uint32_t t = 0; t < geometry.tool.triangles.size(); ++t)
      tool.draw({corner(t, 0), corner(t, 1), corner(t, 2)}, look);
    out[i] = merged(mockup, tool);
  }
  return out;
}

std::string png_address(const Image& image) {
  return image.pixels.empty() ? std::string() : "data:image/png;base64," + base64(png(image));
}

}  // namespace palpate
