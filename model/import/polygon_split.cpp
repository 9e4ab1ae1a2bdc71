#include "model/import/polygon_split.h"

#include <algorithm>
#include <cmath>

namespace palpate {
namespace {

struct Flat {
  double x, y;
  bool operator==(const Flat&) const = default;
};

/// Twice the area of abc, > 0 for a turn to the left.
double turn(const Flat& a, const Flat& b, const Flat& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// Seen against the mean normal, so that the polygon goes round to the left.
std::vector<Flat> flattened(std::span<const Vec3> corners) {
  Vec3 normal(0), largest(0);
  double sizes = 0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vec3 more = glm::cross(corners[i] - corners[0], corners[(i + 1) % corners.size()] - corners[0]);
    normal += more;
    sizes += glm::length(more);
    if (glm::length(more) > glm::length(largest)) largest = more;
  }
  if (glm::length(normal) < 1e-9 * sizes) normal = largest;  // as much to the left as to the right: a bow
  int axis = 0;
  for (int k = 1; k < 3; ++k)
    if (std::abs(normal[k]) > std::abs(normal[axis])) axis = k;
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  const double facing = normal[axis] < 0 ? -1 : 1;
  std::vector<Flat> out;
  for (const Vec3& p : corners) out.push_back({facing * (p[u] - corners[0][u]), p[v] - corners[0][v]});
  return out;
}

/// No turn to the right, and once round: the way goes to and fro but once.
bool is_convex(const std::vector<Flat>& p) {
  const std::size_t n = p.size();
  int reversals = 0;
  double last = 0, first = 0;
  for (std::size_t i = 0; i < n; ++i) {
    if (turn(p[i], p[(i + 1) % n], p[(i + 2) % n]) < 0) return false;
    const double along = p[(i + 1) % n].x - p[i].x;
    if (along == 0) continue;
    if (last != 0 && (along > 0) != (last > 0)) ++reversals;
    if (first == 0) first = along;
    last = along;
  }
  if (first != 0 && (last > 0) != (first > 0)) ++reversals;
  return reversals <= 2;
}

bool sides_cross(const std::vector<Flat>& p) {
  const std::size_t n = p.size();
  const auto between = [](double a, double b) { return (a > 0 && b < 0) || (a < 0 && b > 0); };
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = i + 2; j < n; ++j) {
      if (i == 0 && j == n - 1) continue;
      const Flat &a = p[i], &b = p[i + 1], &c = p[j], &d = p[(j + 1) % n];
      if (std::max(a.x, b.x) < std::min(c.x, d.x) || std::max(c.x, d.x) < std::min(a.x, b.x)) continue;
      if (between(turn(a, b, c), turn(a, b, d)) && between(turn(c, d, a), turn(c, d, b))) return true;
    }
  return false;
}

/// Whether corner `i` of what is left can be cut off: none of the others lies in its triangle.
bool is_ear(const std::vector<Flat>& p, const std::vector<std::uint32_t>& left, std::size_t i) {
  const std::size_t n = left.size();
  const Flat &a = p[left[(i + n - 1) % n]], &b = p[left[i]], &c = p[left[(i + 1) % n]];
  if (turn(a, b, c) <= 0) return false;
  for (std::size_t j = 0; j < n; ++j) {
    const Flat& q = p[left[j]];
    if (q == a || q == b || q == c) continue;  // the corners themselves, and others in their place
    if (turn(a, b, q) >= 0 && turn(b, c, q) >= 0 && turn(c, a, q) >= 0) return false;
  }
  return true;
}

}  // namespace

PolygonKind split_polygon(std::span<const Vec3> corners, std::vector<std::array<std::uint32_t, 3>>& out) {
  const auto n = static_cast<std::uint32_t>(corners.size());
  const auto fan = [&] {
    for (std::uint32_t i = 2; i < n; ++i) out.push_back({0, i - 1, i});
  };
  if (n == 3) {
    fan();
    return PolygonKind::kConvex;
  }
  const std::vector<Flat> p = flattened(corners);
  if (is_convex(p)) {
    fan();
    return PolygonKind::kConvex;
  }
  if (sides_cross(p)) {
    fan();
    return PolygonKind::kCrossing;
  }
  const std::size_t before = out.size();
  std::vector<std::uint32_t> left(n);
  for (std::uint32_t i = 0; i < n; ++i) left[i] = i;
  std::size_t at = 0;  // go round, so that no corner is the apex of all
  while (left.size() > 3) {
    const std::size_t count = left.size();
    std::size_t ear = count;
    for (std::size_t step = 0; step < count && ear == count; ++step)
      if (is_ear(p, left, (at + step) % count)) ear = (at + step) % count;
    // None: what is left goes to and fro. A corner on the line between its neighbours takes no area away.
    for (std::size_t i = 0; i < count && ear == count; ++i)
      if (turn(p[left[(i + count - 1) % count]], p[left[i]], p[left[(i + 1) % count]]) == 0) ear = i;
    if (ear == count) {  // sides that touch or lie on each other, in roundings
      out.resize(before);
      fan();
      return PolygonKind::kCrossing;
    }
    out.push_back({left[(ear + count - 1) % count], left[ear], left[(ear + 1) % count]});
    left.erase(left.begin() + static_cast<std::ptrdiff_t>(ear));
    at = ear < left.size() ? ear : 0;
  }
  out.push_back({left[0], left[1], left[2]});
  return PolygonKind::kConcave;
}

}  // namespace palpate
