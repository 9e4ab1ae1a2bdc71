#include "service/report/section_svg.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <optional>

#include "service/cli/numbers.h"
#include "service/report/markup.h"

namespace palpate {
namespace {

constexpr double kWidth = 460, kHeight = 340;  // of the picture, its own units
constexpr std::size_t kMostLines = 20'000;     // of a body (chosen: a megabyte)

constexpr std::size_t kTurns = 12;  // of a plane, half a turn in all (chosen)

struct Line {
  double x[2], y[2];
};

/// Where a triangle crosses the plane, seen in the picture; empty: nowhere, or out of sight.
std::optional<Line> cut(const Vec3 corners[3], const SectionView& view, const Vec3& normal) {
  double height[3];
  for (int k = 0; k < 3; ++k) height[k] = glm::dot(normal, corners[k] - view.middle);
  Line line{};
  int ends = 0;
  for (int k = 0; k < 3 && ends < 2; ++k) {
    const double a = height[k], b = height[(k + 1) % 3];
    if ((a < 0) == (b < 0)) continue;
    const Vec3 p = corners[k] + (corners[(k + 1) % 3] - corners[k]) * (a / (a - b)) - view.middle;
    const double scale = kWidth / view.width_m;
    line.x[ends] = kWidth / 2 + scale * glm::dot(p, view.right);
    line.y[ends] = kHeight / 2 - scale * glm::dot(p, view.up);
    ++ends;
  }
  if (ends < 2) return std::nullopt;
  if (std::max(line.x[0], line.x[1]) < 0 || std::min(line.x[0], line.x[1]) > kWidth ||
      std::max(line.y[0], line.y[1]) < 0 || std::min(line.y[0], line.y[1]) > kHeight)
    return std::nullopt;
  return line;
}

template <class Corner>
std::string outline(std::size_t triangles, const char* colour, const SectionView& view,
                    const Corner& corner) {
  const Vec3 normal = glm::cross(view.right, view.up);
  std::string path;
  std::size_t lines = 0;
  for (std::uint32_t t = 0; t < triangles && lines < kMostLines; ++t) {
    const Vec3 corners[3] = {corner(t, 0), corner(t, 1), corner(t, 2)};
    const auto line = cut(corners, view, normal);
    if (!line) continue;
    ++lines;
    path += fmt::format("M{:.2f} {:.2f}L{:.2f} {:.2f}", line->x[0], line->y[0], line->x[1], line->y[1]);
  }
  return fmt::format(
      "<path d=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"1.6\" stroke-linecap=\"round\"/>", path,
      colour);
}

/// The largest of 1, 2 and 5 times a power of ten that is at most a fifth of the width.
double bar_length(double width_m) {
  const double most = width_m / 5, power = std::pow(10, std::floor(std::log10(most)));
  return most >= 5 * power ? 5 * power : most >= 2 * power ? 2 * power : power;
}

}  // namespace

Vec3 in_world(const SceneGeometry& geometry, const Int3& p) {
  return geometry.lattice.origin_m + geometry.lattice.step_m * Vec3(p);
}

SectionView section_through(const Vec3& middle, const Vec3& apart, double width_m) {
  SectionView view;
  view.middle = view.mark = middle;
  view.width_m = width_m;
  const double size = glm::length(apart);
  if (!(size > 0)) return view;
  const Vec3 way = apart / size;
  // Upright, as the gap leads; where that leads up or down, across x.
  const Vec3 vertical(0, 0, 1);
  if (std::abs(glm::dot(way, vertical)) < 0.9) {
    view.right = way;
    view.up = glm::normalize(vertical - way * glm::dot(way, vertical));
  } else {
    view.up = way * (way.z < 0 ? -1.0 : 1.0);
    view.right = glm::normalize(Vec3(1, 0, 0) - view.up * view.up.x);
  }
  return view;
}

void turn_through_tool(const SceneGeometry& geometry, const LatticePose& pose, const Vec3& apart,
                       SectionView& view) {
  const double size = glm::length(apart);
  if (!(size > 0)) return;
  const Vec3 way = apart / size, across = glm::cross(view.right, view.up);
  const Vec3 beside = view.right - way * glm::dot(way, view.right),
             above = view.up - way * glm::dot(way, view.up);
  const bool level = glm::length(above) > glm::length(beside);  // the way leads to the right
  const Vec3 other = level ? view.up : view.right;
  double most = 0;
  std::array<double, kTurns> lengths{};
  std::array<SectionView, kTurns> views;
  for (std::size_t i = 0; i < kTurns; ++i) {
    const double angle = std::numbers::pi * static_cast<double>(i) / kTurns;
    views[i] = view;
    (level ? views[i].up : views[i].right) = std::cos(angle) * other + std::sin(angle) * across;
    const Vec3 normal = glm::cross(views[i].right, views[i].up);
    for (std::uint32_t t = 0; t < geometry.tool.triangles.size(); ++t) {
      const Vec3 corners[3] = {in_world(geometry, transform(pose, geometry.tool.corner(t, 0))),
                               in_world(geometry, transform(pose, geometry.tool.corner(t, 1))),
                               in_world(geometry, transform(pose, geometry.tool.corner(t, 2)))};
      if (const auto line = cut(corners, views[i], normal))
        lengths[i] += std::hypot(line->x[1] - line->x[0], line->y[1] - line->y[0]);
    }
    most = std::max(most, lengths[i]);
  }
  view = views[static_cast<std::size_t>(
      std::find_if(lengths.begin(), lengths.end(), [&](double l) { return 2 * l >= most; }) -
      lengths.begin())];
}

void show_tool(const SceneGeometry& geometry, const LatticePose& pose, SectionView& view) {
  double low[2] = {0, 0}, high[2] = {0, 0};  // from the mark, to the right and up
  for (const Int3& vertex : geometry.tool.vertices) {
    const Vec3 p = in_world(geometry, transform(pose, vertex)) - view.mark;
    const double at[2] = {glm::dot(p, view.right), glm::dot(p, view.up)};
    for (int k = 0; k < 2; ++k) {
      low[k] = std::min(low[k], at[k]);
      high[k] = std::max(high[k], at[k]);
    }
  }
  view.middle = view.mark + 0.5 * (low[0] + high[0]) * view.right + 0.5 * (low[1] + high[1]) * view.up;
  constexpr double kRoom = 1.15;  // of what is shown
  view.width_m =
      std::max(view.width_m, kRoom * std::max(high[0] - low[0], (high[1] - low[1]) * kWidth / kHeight));
}

std::string section_svg(const SceneGeometry& geometry, const LatticePose& pose, const SectionView& view) {
  std::string out =
      fmt::format("<svg style=\"overflow:hidden\" viewBox=\"0 0 {} {}\" role=\"img\" xmlns=\"http:{}\">",
                  kWidth, kHeight, "//www.w3.org/2000/svg");
  out += outline(geometry.mockup.triangles.size(), "var(--cst, #c2453f)", view,
                 [&](std::uint32_t t, int k) { return in_world(geometry, geometry.mockup.corner(t, k)); });
  out += outline(geometry.tool.triangles.size(), "var(--cmt, #2f6fd6)", view, [&](std::uint32_t t, int k) {
    return in_world(geometry, transform(pose, geometry.tool.corner(t, k)));
  });
  const double scale = kWidth / view.width_m;
  const auto x_of = [&](const Vec3& p) { return kWidth / 2 + scale * glm::dot(p - view.middle, view.right); };
  const auto y_of = [&](const Vec3& p) { return kHeight / 2 - scale * glm::dot(p - view.middle, view.up); };
  if (view.gap)
    out += fmt::format(
        "<line x1=\"{:.2f}\" y1=\"{:.2f}\" x2=\"{:.2f}\" y2=\"{:.2f}\" stroke=\"currentColor\" "
        "stroke-width=\"1.2\" stroke-dasharray=\"3 2\"/>",
        x_of(view.on_static), y_of(view.on_static), x_of(view.on_mobile), y_of(view.on_mobile));
  out += fmt::format(
      "<circle cx=\"{:.2f}\" cy=\"{:.2f}\" r=\"7\" fill=\"none\" stroke=\"currentColor\" "
      "stroke-width=\"1\"/>",
      x_of(view.mark), y_of(view.mark));
  out += fmt::format(
      "<text x=\"{:.2f}\" y=\"{:.2f}\" font-size=\"13\" fill=\"currentColor\" paint-order=\"stroke\" "
      "stroke=\"var(--card, #fff)\" stroke-width=\"3\">{}</text>",
      x_of(view.mark) + 12, y_of(view.mark) - 10, markup_text(view.label));
  const double bar = bar_length(view.width_m);
  out += fmt::format(
      "<path d=\"M12 {0}h{1:.2f}m0 -4v8M12 {2}v8\" fill=\"none\" stroke=\"currentColor\"/><text x=\"12\" "
      "y=\"{3}\" font-size=\"12\" fill=\"currentColor\">{4}</text>",
      kHeight - 14, scale * bar, kHeight - 18, kHeight - 22, length_text(bar));
  return out + "</svg>";
}

}  // namespace palpate
