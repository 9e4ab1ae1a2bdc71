#include "cpu_ref/special_cases.h"

#include <algorithm>

#include "cpu_ref/direction.h"
#include "cpu_ref/heights.h"
#include "cpu_ref/ray.h"
#include "cpu_ref/triangle_triangle.h"

namespace palpate::cpu_ref {
namespace {

constexpr std::uint32_t kOneQ30 = 1u << 30;

bool lexicographically_less(const Int3& a, const Int3& b) {
  return a.x != b.x ? a.x < b.x : a.y != b.y ? a.y < b.y : a.z < b.z;
}

/// Adds to `ends` the points where the edges of one triangle pass through the plane of the other, inside it.
void include_crossing_points(const Triangle& edges_of, const Triangle& triangle, Box& ends) {
  for (int k = 0; k < 3; ++k) {
    Int3 p = edges_of[k], q = edges_of[(k + 1) % 3];
    if (lexicographically_less(q, p)) std::swap(p, q);
    const Int128 d_p = triangle.side(p), d_q = triangle.side(q);
    if (d_p == d_q || sign(d_p) * sign(d_q) > 0 || !segment_meets_triangle(p, q, triangle)) continue;
    const Int128 apart = d_p - d_q;   // not 0, of the sign of d_p where that is not 0
    const Int128 scaled = (Int128{1} << 30) * d_p;   // within 2^120
    const auto part_q30 = static_cast<std::int64_t>(apart > 0 ? floor_divide(scaled, apart) : floor_divide(-scaled, -apart));
    Int3 point;
    for (int c = 0; c < 3; ++c) point[c] = p[c] + static_cast<std::int32_t>(((std::int64_t{q[c]} - p[c]) * part_q30) >> 30);
    ends.include(point);
  }
}

}  // namespace

void measure_needle(const Frame& frame, Area& area) {
  if (area.cst.empty() || area.out.direction == Int3(0) || area.out.rays > 0) return;
  area.out.flags |= kFlagNeedle;
  const Int3 up = area.out.direction;

  // (a) from the middle of what each pair has in common, down through the tool
  std::vector<std::uint32_t> tool_vertices;
  for (const auto& [s, m] : frame.pairs) {
    if (!std::binary_search(area.cst.begin(), area.cst.end(), s)) continue;
    const auto& corners = frame.tool_mesh().triangles[m];
    tool_vertices.insert(tool_vertices.end(), corners.begin(), corners.end());
    const Triangle triangle_s = triangle_of(frame.mockup(), s);
    Box ends;
    include_crossing_points(triangle_s, frame.tool[m], ends);
    include_crossing_points(frame.tool[m], triangle_s, ends);
    if (ends.min.x > ends.max.x) continue;
    Int3 middle;
    for (int k = 0; k < 3; ++k) middle[k] = static_cast<std::int32_t>((std::int64_t{ends.min[k]} + ends.max[k]) >> 1);
    const auto found = height(frame, middle, -up);
    if (!found) continue;
    area.rays.push_back({middle, found->height});
    add_height(area, found->height, kOneQ30, middle, 0);
  }

  // (b) from each of the tool's vertices there, up to the surface
  std::sort(tool_vertices.begin(), tool_vertices.end());
  tool_vertices.erase(std::unique(tool_vertices.begin(), tool_vertices.end()), tool_vertices.end());
  for (const std::uint32_t vertex : tool_vertices) {
    const Int3 from = frame.vertices[vertex];
    std::optional<std::uint32_t> smallest;
    for (const std::uint32_t s : area.cst) {
      const auto crossing = ray_crosses_at(from, up, triangle_of(frame.mockup(), s));
      if (!crossing || (crossing->sign < 0 && !is_sheet(frame.mockup(), s))) continue;
      if (!smallest || crossing->height < *smallest) smallest = crossing->height;
    }
    if (!smallest) continue;
    Int3 at;
    for (int k = 0; k < 3; ++k) at[k] = from[k] + static_cast<std::int32_t>((std::int64_t{up[k]} * *smallest) >> 30);
    add_height(area, *smallest, kOneQ30, at, 0);
  }
}

void find_pierced(const Frame& frame, std::vector<Area>& areas, std::size_t a) {
  if (areas.size() < 2) return;
  const auto area_of = [&](std::uint32_t s) {   // or areas.size() for triangles that are not in C_s
    for (std::size_t b = 0; b < areas.size(); ++b)
      if (std::binary_search(areas[b].out.static_ids.begin(), areas[b].out.static_ids.end(), s)) return b;
    return areas.size();
  };
  const Int3 down = -areas[a].out.direction;
  std::vector<bool> pierced(areas.size(), false);
  std::vector<std::uint32_t> candidates;
  for (const MeasuredRay& ray : areas[a].rays) {
    // The first crossing out through another area, before the ray leaves the tool.
    candidates.clear();
    frame.scene.mockup_tree.along_ray(ray.from, down, candidates);
    std::uint32_t first = ray.height;
    std::vector<std::size_t> there;
    for (const std::uint32_t s : candidates) {
      const std::size_t b = area_of(s);
      if (b == a || b == areas.size()) continue;
      const auto crossing = ray_crosses_at(ray.from, down, triangle_of(frame.mockup(), s));
      if (!crossing || crossing->sign < 0 || crossing->height >= ray.height || crossing->height > first) continue;
      if (crossing->height < first) there.clear();
      first = crossing->height;
      there.push_back(b);
    }
    for (const std::size_t b : there) pierced[b] = true;
  }
  for (std::size_t b = 0; b < areas.size(); ++b)
    if (pierced[b]) areas[a].out.pierces.push_back(static_cast<std::uint32_t>(b));
}

void measure_swallowed(const Frame& frame, Contacts& out) {
  if (out.imt.empty() || !out.cst.empty() || !out.est.empty() || !frame.counting.empty()) return;
  out.flags |= kFlagSwallowed;
  const Partition& partition = frame.scene.mockup;
  if (frame.held != nullptr && frame.held->last_direction != Int3(0)) {
    out.swallowed_direction = frame.held->last_direction;
    out.flags |= kFlagHeld;
  } else {
    const Long3 way_out = partition.to_nearest_external(frame.pose.translation);
    if (way_out == Long3(0)) {
      out.flags |= kFlagNoDirection;
      return;
    }
    out.swallowed_direction = normalise(way_out);
    out.flags |= kFlagNearestExternal;
  }

  // March from every touched V_int voxel until it is out; the tool is out when the last one is.
  const std::int64_t half = partition.grid.size / 2;
  std::int64_t most = 0;
  for (const std::uint64_t number : frame.touched_internal) {
    const Int3 centre = partition.centre(partition.voxel(number));
    std::int64_t steps = 1;
    const auto at = [&](std::int64_t k) {   // direction within 2^29, k · half within the grid: far below 2^63
      Int3 point;
      for (int c = 0; c < 3; ++c)
        point[c] = centre[c] + static_cast<std::int32_t>((out.swallowed_direction[c] * k * half) >> 29);
      return point;
    };
    while (partition.class_of(at(steps)) == VoxelClass::kInternal) ++steps;
    most = std::max(most, steps);
  }
  out.swallowed_height = static_cast<std::uint32_t>(partition.grid.size * most);
}

}  // namespace palpate::cpu_ref
