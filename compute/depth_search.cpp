#include "compute/depth_search.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "compute/host_exact.h"

namespace palpate {

using namespace gpu;   // names of shaders/shared/scene.h

namespace {

constexpr std::int64_t kRounding = 16;   // steps by which a distance may be off, and more (EXACTNESS section 4)

std::int64_t product(const Int3& a, const Int3& b) { return std::int64_t{a.x} * b.x + std::int64_t{a.y} * b.y + std::int64_t{a.z} * b.z; }

/// floor(√v), 0 ≤ v < 2^62: a double's root is off by less than one there.
std::int64_t root(std::int64_t v) {
  auto r = static_cast<std::int64_t>(std::sqrt(static_cast<double>(v)));
  while (r * r > v) --r;
  while ((r + 1) * (r + 1) <= v) ++r;
  return r;
}

std::int64_t floor_quotient(std::int64_t a, std::int64_t b) {
  const std::int64_t q = a / b;
  return a % b < 0 ? q - 1 : q;
}

bool bounds_solid(const LatticeMesh& mesh, std::uint32_t id) { return (mesh.flags[id] & (kTriangleCollapsed | kTriangleSheet)) == 0; }

}  // namespace

struct DepthSearch::Search {
  Int3 point;
  std::int64_t best = INT64_MAX;   ///< steps
  std::uint32_t triangle = kNobody;
};

/// The distance to one triangle, where it may be the least.
void DepthSearch::look_at(Search& search, std::uint32_t id) const {
  if (id == search.triangle) return;
  const LatticeMesh& mesh = *mesh_;
  const auto& [ia, ib, ic] = mesh.triangles[id];
  const Int3 n = mesh.unit_normal_q30[id], corners[3] = {mesh.vertices[ia], mesh.vertices[ib], mesh.vertices[ic]};
  const std::int64_t height = std::abs((product(n, search.point - corners[0]) + (std::int64_t{1} << 29)) >> 30);
  if (height > search.best || !bounds_solid(mesh, id)) return;

  // Each edge in doubles first. A side is off by less than 4 steps and 2^-27 of the way there: m is rounded by a step in 2^28, L likewise, n by 2^-31.
  const double best = static_cast<double>(search.best), h = static_cast<double>(height);
  bool unsure = false;
  for (int k = 0; k < 3; ++k) {
    const Int3 &u = corners[k], &v = corners[k == 2 ? 0 : k + 1];
    const double ex = v.x - double(u.x), ey = v.y - double(u.y), ez = v.z - double(u.z);
    const double fx = search.point.x - double(u.x), fy = search.point.y - double(u.y), fz = search.point.z - double(u.z);
    const double out = (ey * n.z - ez * n.y) * fx + (ez * n.x - ex * n.z) * fy + (ex * n.y - ey * n.x) * fz;   // side · |e| · 2^30
    const double size = ex * ex + ey * ey + ez * ez;
    const double slack = 8 + 0x1p-26 * (std::fabs(fx) + std::fabs(fy) + std::fabs(fz));
    const double limit = 0x1p30 * std::sqrt(size);
    if (out < -slack * limit) continue;                      // surely side ≤ 0
    if (out > slack * limit) {
      const double side = out / limit - slack;
      if (h * h + side * side > (best + 2) * (best + 2)) return;   // too far away
    }
    unsure = true;
  }
  std::int64_t distance = height;
  if (unsure) {
    std::int64_t least = -1;
    for (int k = 0; k < 3; ++k) {
      const Int3 &u = corners[k], &v = corners[k == 2 ? 0 : k + 1];
      const Int3 edge = v - u, from = search.point - u;
      const Int3 along = exact::normalise({edge.x, edge.y, edge.z});
      const exact::Normal across = exact::cross(along, n);
      const Int3 out(static_cast<std::int32_t>(across.x >> 30), static_cast<std::int32_t>(across.y >> 30), static_cast<std::int32_t>(across.z >> 30));
      const std::int64_t size = root(product(along, along)), side = floor_quotient(product(out, from), size);
      if (side <= 0) continue;
      const std::int64_t at = floor_quotient(product(along, from), size);
      const std::int64_t over = std::max({std::int64_t{0}, -at, at - root(product(edge, edge))});
      const std::int64_t squared = height * height + side * side + over * over;
      if (least < 0 || squared < least) least = squared;
    }
    if (least >= 0) distance = root(least);
  }
  if (distance < search.best || (distance == search.best && id < search.triangle)) {
    search.best = distance;
    search.triangle = id;
  }
}

void DepthSearch::look_into(Search& search, const Int3& voxel) const {
  const HostPartition::Voxel at = partition_->at(voxel);
  if (at.boundary == kNoVoxel) return;
  for (const std::uint32_t id : partition_->list(at.boundary)) look_at(search, id);
}

DepthSearch::Depth DepthSearch::below(const Int3& point) const {
  Search search{.point = point};
  const GridConstants& grid = partition_->grid();
  const Int3 home = partition_->voxel_of(point), in_home = point - (grid.origin + grid.size * home);
  const std::int64_t size = grid.size;
  look_into(search, home);
  // How far the point is from a row of voxels `by` away along an axis.
  const auto gap = [&](int axis, std::int32_t by) -> std::int64_t {
    return by == 0 ? 0 : by > 0 ? by * size - in_home[axis] : in_home[axis] + 1 - size * (by + 1) - 1;
  };
  const Int3 voxels = grid.bricks * 8;
  const std::int32_t last = std::max({voxels.x, voxels.y, voxels.z, std::abs(home.x), std::abs(home.y), std::abs(home.z)}) + 1;
  for (std::int32_t ring = 1; ring <= last; ++ring) {
    std::int64_t nearest = INT64_MAX;
    for (int axis = 0; axis < 3; ++axis) nearest = std::min({nearest, gap(axis, ring), gap(axis, -ring)});
    if (search.best != INT64_MAX && nearest > search.best + kRounding) break;
    const auto near = [&](std::int64_t squared) {
      return search.best == INT64_MAX || squared <= (search.best + kRounding) * (search.best + kRounding);
    };
    const Int3 low = glm::max(home - Int3(ring), Int3(0)), high = glm::min(home + Int3(ring), voxels - Int3(1));
    for (std::int32_t z = low.z; z <= high.z; ++z) {
      const std::int64_t gz = gap(2, z - home.z), square_z = gz * gz;
      if (!near(square_z)) continue;
      for (std::int32_t y = low.y; y <= high.y; ++y) {
        const std::int64_t gy = gap(1, y - home.y), square_y = square_z + gy * gy;
        if (!near(square_y)) continue;
        const bool face = std::abs(z - home.z) == ring || std::abs(y - home.y) == ring;
        for (std::int32_t x = low.x; x <= high.x; ++x) {
          if (!face && std::abs(x - home.x) != ring) {   // the ring's inside
            x = std::max(x, home.x + ring - 1);
            continue;
          }
          const std::int64_t gx = gap(0, x - home.x);
          if (near(square_y + gx * gx)) look_into(search, Int3(x, y, z));
        }
      }
    }
  }
  return {static_cast<std::uint32_t>(search.best), search.triangle};
}

bool InsideSearch::inside(const Int3& point) {
  const Int3 voxel = partition_->voxel_of(point);
  const HostPartition::Voxel at = partition_->at(voxel);
  if (at.boundary == kNoVoxel) return at.kind == kVoxelInternal;
  if (!mesh_->closed) return by_walks(point, voxel);
  // The planes of what the voxel lists cut it into cells through which nothing passes: the winding is one number for a cell. A point nearer to a plane than
  // its rounded normal may be off is asked by itself.
  constexpr std::int64_t kFar = std::int64_t{2} << 30;
  const auto list = partition_->list(at.boundary);
  std::uint32_t sides = 0;
  bool far = list.size() <= CellMemo::kMostPlanes;
  for (const std::uint32_t id : list) {
    const std::int64_t height = product(mesh_->unit_normal_q30[id], point - mesh_->corner(id, 0));
    sides = sides << 1 | static_cast<std::uint32_t>(height > 0);
    far = far & (std::abs(height) > kFar);
  }
  if (!far) return by_winding(point, voxel);
  if (const std::optional<bool> known = cells_.find(at.boundary, sides)) return *known;
  const bool answer = by_winding(point, voxel);
  cells_.keep(at.boundary, sides, answer);
  return answer;
}

/// What is crossed along +x until nothing can be any more.
bool InsideSearch::by_winding(const Int3& point, const Int3& voxel) const {
  const GridConstants& grid = partition_->grid();
  int winding = 0;
  Int3 from = point, at = voxel;
  for (; at.x < 8 * grid.bricks.x; ++at.x) {
    const HostPartition::Voxel here = partition_->at(at);
    if (here.kind == kVoxelExternal) break;
    Int3 to = from;
    to.x = grid.origin.x + grid.size * (at.x + 1);
    if (here.boundary != kNoVoxel)
      for (const std::uint32_t id : partition_->list(here.boundary))
        winding += exact::segment_crossing(from, to, {mesh_->corner(id, 0), mesh_->corner(id, 1), mesh_->corner(id, 2)});
    from = to;
  }
  return winding != 0;
}

bool InsideSearch::by_walks(const Int3& point, const Int3& voxel) const {
  const GridConstants& grid = partition_->grid();
  int inside = 0;
  for (int axis = 0; axis < 3; ++axis)
    for (const int way : {1, -1}) {
      int net = 0;
      Int3 from = point, at = voxel;
      HostPartition::Voxel here = partition_->at(at);
      do {
        Int3 to = from;
        to[axis] = grid.origin[axis] + grid.size * (at[axis] + (way > 0 ? 1 : 0));
        if (from != to)
          for (const std::uint32_t id : partition_->list(here.boundary))
            if (bounds_solid(*mesh_, id)) net += exact::segment_crossing(from, to, {mesh_->corner(id, 0), mesh_->corner(id, 1), mesh_->corner(id, 2)});
        from = to;
        at[axis] += way;
        here = partition_->at(at);
      } while (here.boundary != kNoVoxel);
      inside += (here.kind == kVoxelInternal ? net >= 0 : net != 0) ? 1 : 0;
    }
  return inside > 3;
}

}  // namespace palpate
