#include "compute/scene/triangle_tree.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <span>

#include "compute/scene/exact.h"
#include "compute/scene/shares.h"

namespace palpate {
namespace {

constexpr std::size_t kEight = TriangleTree::kEight;
constexpr std::size_t kWorthSharing = std::size_t{1} << 15;  // triangles (chosen: milliseconds)

constexpr std::size_t kTried = 64;  // triangles by which a cut is judged, a power of two (chosen)

struct Item {
  Int3 low, high;  ///< the triangle's box
  std::uint32_t id;

  std::int32_t middle(int axis) const { return low[axis] + high[axis]; }  ///< twice that, within 2^29
};

struct Part {
  std::size_t begin, size;
};

/// The first `first` are those of the lowest middles along an axis.
void cut(std::span<Item> items, std::size_t first, int axis) {
  std::nth_element(items.begin(), items.begin() + static_cast<std::ptrdiff_t>(first), items.end(),
                   [&](const Item& a, const Item& b) {
                     return a.middle(axis) != b.middle(axis) ? a.middle(axis) < b.middle(axis) : a.id < b.id;
                   });
}

/// Along which axis to cut so that halves cost least: half the surface of each one's box, times its
/// triangles, which is about how often they are looked at. `share`: of the triangles that go into the first.
int best_axis(std::span<const Item> items, double share) {
  std::array<Item, kTried> tried;
  const std::size_t count = std::min(items.size(), kTried);
  for (std::size_t i = 0; i < count; ++i) tried[i] = items[i * items.size() / count];
  const std::size_t first =
      std::clamp<std::size_t>(static_cast<std::size_t>(share * static_cast<double>(count)), 1, count - 1);
  int best = 0;
  double least = std::numeric_limits<double>::infinity();
  for (int axis = 0; axis < 3; ++axis) {
    std::array<std::int64_t, kTried> order;  // by middle; the place in `tried` below
    for (std::size_t i = 0; i < count; ++i)
      order[i] = std::int64_t{tried[i].middle(axis)} * std::int64_t{kTried} + static_cast<std::int64_t>(i);
    std::nth_element(order.begin(), order.begin() + first, order.begin() + count);
    const auto cost = [&](std::size_t begin, std::size_t end) {
      Int3 low(INT32_MAX), high(INT32_MIN);
      for (std::size_t i = begin; i < end; ++i) {
        const Item& item = tried[static_cast<std::uint64_t>(order[i]) % kTried];
        low = glm::min(low, item.low);
        high = glm::max(high, item.high);
      }
      const Vec3 side(high - low);
      return (side.x * side.y + side.y * side.z + side.z * side.x) * static_cast<double>(end - begin);
    };
    const double costs = cost(0, first) + cost(first, count);
    if (costs < least) {
      least = costs;
      best = axis;
    }
  }
  return best;
}

/// Halves of a part, of which the first fills children of its node.
std::array<Part, 2> halves(std::span<Item> all, const Part& part) {
  std::size_t child = kEight;
  while (child * kEight < part.size) child *= kEight;
  const std::size_t children = (part.size + child - 1) / child, first = child * (children / 2);
  const std::span<Item> items = all.subspan(part.begin, part.size);
  cut(items, first, best_axis(items, static_cast<double>(first) / static_cast<double>(part.size)));
  return {{{part.begin, first}, {part.begin + first, part.size - first}}};
}

void sort_part(std::span<Item> all, const Part& part) {
  if (part.size <= kEight) return;
  for (const Part& half : halves(all, part)) sort_part(all, half);
}

void set(TriangleTree::Boxes& boxes, std::size_t i, const Int3& low, const Int3& high) {
  for (std::size_t k = 0; k < 3; ++k) {
    boxes.low[k][i] = low[static_cast<int>(k)];
    boxes.high[k][i] = high[static_cast<int>(k)];
  }
}

constexpr std::int32_t kNowhere = std::int32_t{1} << 30;  // beyond the lattice
constexpr std::size_t kGroupsAShare = 64;                 // of eight boxes (chosen: milliseconds)

/// The box of a run along the mean of its normals, its longest side as seen along that, and what is at right
/// angles to both.
void set(TriangleTree::TurnedBoxes& boxes, std::size_t i, const LatticeMesh& mesh,
         std::span<const std::uint32_t> run) {
  const Int3 origin = mesh.corner(run.front(), 0);
  Vec3 normal(0), along(0);
  for (const std::uint32_t id : run) {
    const exact::Normal n = exact::raw_normal(mesh.corner(id, 0), mesh.corner(id, 1), mesh.corner(id, 2));
    normal += Vec3(static_cast<double>(n.x), static_cast<double>(n.y), static_cast<double>(n.z));
  }
  if (glm::dot(normal, normal) == 0) normal = Vec3(0, 0, 1);
  normal = glm::normalize(normal);
  for (const std::uint32_t id : run)
    for (int k = 0; k < 3; ++k) {
      Vec3 side(mesh.corner(id, k == 2 ? 0 : k + 1) - mesh.corner(id, k));
      side -= glm::dot(side, normal) * normal;
      if (glm::dot(side, side) > glm::dot(along, along)) along = side;
    }
  if (glm::dot(along, along) < 1)
    along = glm::cross(normal, std::abs(normal.x) < 0.5 ? Vec3(1, 0, 0) : Vec3(0, 1, 0));
  along = glm::normalize(along);
  const Vec3 axes[3] = {normal, along, glm::cross(normal, along)};
  for (std::size_t a = 0; a < 3; ++a) {
    boxes.corner[a][i] = origin[static_cast<int>(a)];
    Vec3 axis;  // as it is rounded
    for (std::size_t k = 0; k < 3; ++k)
      axis[static_cast<int>(k)] = boxes.axis[a][k][i] = static_cast<float>(axes[a][static_cast<int>(k)]);
    double low = 0, high = 0;
    for (const std::uint32_t id : run)
      for (int corner = 0; corner < 3; ++corner) {
        const double at = glm::dot(axis, Vec3(mesh.corner(id, corner) - origin));
        low = std::min(low, at);
        high = std::max(high, at);
      }
    constexpr float kFar = std::numeric_limits<float>::infinity();
    boxes.low[a][i] = std::nextafter(static_cast<float>(low), -kFar);
    boxes.high[a][i] = std::nextafter(static_cast<float>(high), kFar);
  }
}

}  // namespace

TriangleTree TriangleTree::make(const LatticeMesh& mesh, const std::function<bool()>& go_on,
                                std::uint8_t without, bool turns) {
  std::vector<Item> items;
  items.reserve(mesh.triangles.size());
  for (std::uint32_t id = 0; id < mesh.triangles.size(); ++id) {
    if ((mesh.flags[id] & without) != 0) continue;
    const Int3 a = mesh.corner(id, 0), b = mesh.corner(id, 1), c = mesh.corner(id, 2);
    items.push_back({glm::min(glm::min(a, b), c), glm::max(glm::max(a, b), c), id});
  }

  std::vector<Part> large{{0, items.size()}}, shares;
  while (!large.empty()) {
    const Part part = large.back();
    large.pop_back();
    if (!go_on()) return {};
    if (part.size <= kWorthSharing)
      shares.push_back(part);
    else
      for (const Part& half : halves(items, part)) large.push_back(half);
  }
  if (!in_shares(
          static_cast<std::uint32_t>(shares.size()),
          [&](std::uint32_t share) { sort_part(items, shares[share]); },
          [&](std::uint32_t) { return go_on(); }))
    return {};

  TriangleTree out;
  out.order.reserve(items.size());
  for (const Item& item : items) out.order.push_back(item.id);
  std::vector<std::array<Int3, 2>> below;
  for (std::size_t first = 0; first < items.size(); first += kEight) {
    std::array<Int3, 2>& box = below.emplace_back(std::array{Int3(kNowhere), Int3(-kNowhere)});
    for (std::size_t place = first; place < std::min(first + kEight, items.size()); ++place)
      box = {glm::min(box[0], items[place].low), glm::max(box[1], items[place].high)};
  }
  while (!below.empty()) {
    out.level_begin.push_back(static_cast<std::uint32_t>(out.boxes.size()));
    std::vector<std::array<Int3, 2>> above;
    for (std::size_t node = 0; node < below.size(); ++node) {
      if (node % kEight == 0) {
        out.boxes.emplace_back();
        above.push_back({Int3(kNowhere), Int3(-kNowhere)});
      }
      set(out.boxes.back(), node % kEight, below[node][0], below[node][1]);
      above.back() = {glm::min(above.back()[0], below[node][0]), glm::max(above.back()[1], below[node][1])};
    }
    if (above.size() <= 1) break;
    below = std::move(above);
  }

  if (!turns) return out;
  // Boxes by their numbers in all levels that have turned ones: level after level, eight a group.
  const std::size_t levels = std::min(out.level_begin.size(), TriangleTree::kTurnedLevels);
  const std::size_t groups = levels < out.level_begin.size() ? out.level_begin[levels] : out.boxes.size();
  out.turned.resize(groups);
  const auto turn = [&](std::uint32_t share) {
    for (std::size_t group = share * kGroupsAShare; group < std::min((share + 1) * kGroupsAShare, groups);
         ++group) {
      std::size_t level = levels - 1;
      while (out.level_begin[level] > group) --level;
      std::size_t size = kEight;  // triangles a box
      for (std::size_t above = 0; above < level; ++above) size *= kEight;
      for (std::size_t i = 0; i < kEight; ++i) {
        const std::size_t first = (kEight * (group - out.level_begin[level]) + i) * size;
        if (first >= out.order.size()) break;
        set(out.turned[group], i, mesh,
            std::span(out.order).subspan(first, std::min(size, out.order.size() - first)));
      }
    }
  };
  if (!in_shares(static_cast<std::uint32_t>((groups + kGroupsAShare - 1) / kGroupsAShare), turn,
                 [&](std::uint32_t) { return go_on(); }))
    return {};
  return out;
}

}  // namespace palpate
