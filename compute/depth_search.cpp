#include "compute/depth_search.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdlib>

#include "compute/host_exact.h"
#include "compute/processor.h"
#include "compute/turned_boxes.h"

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

namespace {

/// A number for each edge of a triangle, and a fourth that counts for nothing. Every processor has such vectors.
using Lanes = float __attribute__((vector_size(16)));

Lanes lanes(float value) { return Lanes{value, value, value, value}; }
Lanes larger(Lanes a, Lanes b) { return a > b ? a : b; }

}  // namespace

/// A triangle as the search asks for it time and again. Floats are relative to the first corner, in steps.
struct DepthSearch::Known {
  Lanes out_x, out_y, out_z, out_at;   ///< by edge, of unit length: away from the triangle in its plane; the last lane is never outside
  Lanes along_x, along_y, along_z, along_at, length;
  Int3 normal, corner;
  float slack;                     ///< by how much the floats' sides may be off, besides kFloatSlack of the way to the first corner
  std::uint32_t id = kNobody;
  bool solid;
  unsigned edges;                  ///< bits: those that are known in integers
  struct Edge {
    Int3 from, along, out;         ///< as EXACTNESS section 4 has them: u, e, m
    std::int64_t size, length;     ///< L, floor(√((v − u)·(v − u)))
  } edge[3];
};

struct DepthSearch::Search {
  Int3 point;
  Int3 home{0}, parts{0};          ///< the voxel of the point, and where it lies there in parts of a voxel, rounded down
  std::int64_t best = INT64_MAX;   ///< steps
  std::uint32_t triangle = kNobody;
};

namespace {

/// Of a float's side or place along an edge: three products of a rounded unit vector and a rounded difference, and three sums, each off by 2^-24 of itself, are off by less
/// than 2^-21 of the way; a quarter of it is room.
constexpr float kFloatSlack = 0x1p-19F;

}  // namespace

DepthSearch::Known& DepthSearch::know(std::uint32_t id) {
  Known& known = known_[id % kKnown];
  if (known.id == id) return known;
  const LatticeMesh& mesh = *mesh_;
  const auto& [ia, ib, ic] = mesh.triangles[id];
  const Int3 corners[3] = {mesh.vertices[ia], mesh.vertices[ib], mesh.vertices[ic]};
  known.id = id;
  known.edges = 0;
  known.solid = bounds_solid(mesh, id);
  known.normal = mesh.unit_normal_q30[id];
  known.corner = corners[0];
  const double nx = known.normal.x * 0x1p-30, ny = known.normal.y * 0x1p-30, nz = known.normal.z * 0x1p-30;
  double reach = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const Int3 &u = corners[k], &v = corners[k == 2 ? 0 : k + 1];
    const double fx = double(u.x) - corners[0].x, fy = double(u.y) - corners[0].y, fz = double(u.z) - corners[0].z;
    const double ex = double(v.x) - u.x, ey = double(v.y) - u.y, ez = double(v.z) - u.z, length = std::sqrt(ex * ex + ey * ey + ez * ez);
    const double ax = ex / length, ay = ey / length, az = ez / length;
    const double ox = ay * nz - az * ny, oy = az * nx - ax * nz, oz = ax * ny - ay * nx;
    known.out_x[k] = static_cast<float>(ox);
    known.out_y[k] = static_cast<float>(oy);
    known.out_z[k] = static_cast<float>(oz);
    known.out_at[k] = static_cast<float>(ox * fx + oy * fy + oz * fz);
    known.along_x[k] = static_cast<float>(ax);
    known.along_y[k] = static_cast<float>(ay);
    known.along_z[k] = static_cast<float>(az);
    known.along_at[k] = static_cast<float>(ax * fx + ay * fy + az * fz);
    known.length[k] = static_cast<float>(length);
    reach = std::max({reach, std::fabs(fx) + std::fabs(fy) + std::fabs(fz), length});
  }
  for (Lanes* of : {&known.out_x, &known.out_y, &known.out_z, &known.along_x, &known.along_y, &known.along_z, &known.along_at, &known.length}) (*of)[3] = 0;
  known.out_at[3] = 0x1p60F;
  known.slack = 8 + kFloatSlack * static_cast<float>(reach);   // 8: m is rounded by a step in 2^28, L likewise, n by 2^-31, and what is left is rounded down
  return known;
}

/// As EXACTNESS section 4 has it, over the edges of `mask`; of the others it is known that the point is not outside them.
std::int64_t DepthSearch::distance_to(const Int3& point, Known& known, std::int64_t height, unsigned mask) const {
  std::int64_t least = -1;
  for (int k = 0; k < 3; ++k) {
    if ((mask >> k & 1) == 0) continue;
    Known::Edge& edge = known.edge[k];
    if ((known.edges >> k & 1) == 0) {
      edge.from = mesh_->corner(known.id, k);
      const Int3 way = mesh_->corner(known.id, k == 2 ? 0 : k + 1) - edge.from;
      edge.along = exact::normalise({way.x, way.y, way.z});
      const exact::Normal across = exact::cross(edge.along, known.normal);
      edge.out = Int3(static_cast<std::int32_t>(across.x >> 30), static_cast<std::int32_t>(across.y >> 30), static_cast<std::int32_t>(across.z >> 30));
      edge.size = root(product(edge.along, edge.along));
      edge.length = root(product(way, way));
      known.edges |= 1U << k;
    }
    const Int3 from = point - edge.from;
    const std::int64_t side = floor_quotient(product(edge.out, from), edge.size);
    if (side <= 0) continue;
    const std::int64_t at = floor_quotient(product(edge.along, from), edge.size);
    const std::int64_t over = std::max({std::int64_t{0}, -at, at - edge.length});
    const std::int64_t squared = height * height + side * side + over * over;
    if (least < 0 || squared < least) least = squared;
  }
  return least < 0 ? height : root(least);
}

/// The distance to one triangle, where it may be the least.
void DepthSearch::look_at(Search& search, std::uint32_t id) {
  if (id == search.triangle) return;
  Known& known = know(id);
  const Int3 from = search.point - known.corner;
  const std::int64_t height = std::abs((product(known.normal, from) + (std::int64_t{1} << 29)) >> 30);
  if (height > search.best || !known.solid) return;

  const float x = static_cast<float>(from.x), y = static_cast<float>(from.y), z = static_cast<float>(from.z), h = static_cast<float>(height);
  const float slack = known.slack + kFloatSlack * (std::fabs(x) + std::fabs(y) + std::fabs(z));
  const Lanes out = known.out_x * x + known.out_y * y + known.out_z * z - known.out_at, at = known.along_x * x + known.along_y * y + known.along_z * z - known.along_at;
  const Lanes over = larger(larger(-at, at - known.length) - slack, lanes(0)), side = larger(out - slack, lanes(0)), squared = side * side + over * over;
  // Outside no edge: the height. Outside some: the least of theirs, and no less than the floats say with all their slack against it.
  unsigned mask = 0;
  bool certain = false;
  float least = 0x1p120F;
  for (int k = 0; k < 3; ++k) {
    if (out[k] < -slack) continue;
    mask |= 1U << k;
    certain = certain || out[k] > slack;
    least = std::min(least, squared[k]);
  }
  if (certain) {
    const float best = static_cast<float>(search.best) + 2;
    if ((h * h + least) * (1 - 0x1p-20F) > best * best * (1 + 0x1p-20F)) return;   // each side is off by at most 6 roundings
  }
  const std::int64_t distance = mask == 0 ? height : distance_to(search.point, known, height, mask);
  if (distance < search.best || (distance == search.best && id < search.triangle)) {
    search.best = distance;
    search.triangle = id;
  }
}

/// What the V_bnd voxel lists, as far as its boxes there are near enough.
void DepthSearch::look_into(Search& search, const Int3& voxel, std::uint32_t boundary) {
  const auto list = partition_->list(boundary);
  const std::size_t count = list.size();
  const std::uint8_t* boxes = &boxes_[6 * std::size_t{partition_->list_begin(boundary)}];
  // Everything in parts of the voxel, rounded down: a box reaches a part further than its highs, the point a part further than its place.
  constexpr std::int32_t kFar = 20000;   // further away nothing is asked
  const Int3 at = glm::clamp(search.parts - (voxel - search.home) * static_cast<std::int32_t>(kVoxelParts), Int3(-kFar), Int3(kFar));
  const auto limit = [&] {
    const double reach = (static_cast<double>(search.best) + kRounding) * per_part_ + 1;
    return reach > kFar ? std::int32_t{INT32_MAX} : static_cast<std::int32_t>(reach * reach) + 1;
  };
  constexpr std::size_t kAtOnce = 64;
  for (std::size_t first = 0; first < count; first += kAtOnce) {
    const std::size_t some = std::min(kAtOnce, count - first);
    std::uint8_t near[kAtOnce];
    const std::int32_t most = limit(), x = at[0], y = at[1], z = at[2];
    const std::uint8_t *lx = boxes + first, *ly = lx + count, *lz = ly + count, *hx = lz + count, *hy = hx + count, *hz = hy + count;
    for (std::size_t i = 0; i < some; ++i) {
      const std::int32_t dx = std::max(std::max(lx[i] - x - 1, x - hx[i] - 1), 0), dy = std::max(std::max(ly[i] - y - 1, y - hy[i] - 1), 0),
                         dz = std::max(std::max(lz[i] - z - 1, z - hz[i] - 1), 0);
      near[i] = dx * dx + dy * dy + dz * dz <= most ? 1 : 0;   // within 3 · 2^29
    }
    for (std::size_t i = 0; i < some; ++i)
      if (near[i] != 0) look_at(search, list[first + i]);
  }
}

DepthSearch::DepthSearch(const LatticeMesh& mesh, const HostPartition& partition, std::span<const std::uint8_t> boxes)
    : mesh_(&mesh), partition_(&partition), boxes_(boxes), per_part_(static_cast<double>(kVoxelParts) / partition.grid().size), known_(kKnown) {}
DepthSearch::DepthSearch() = default;
DepthSearch::DepthSearch(const DepthSearch&) = default;
DepthSearch& DepthSearch::operator=(const DepthSearch&) = default;
DepthSearch::~DepthSearch() = default;

/// Voxels in rings round the point's own, as far as they may hold something nearer.
void DepthSearch::look_round(Search& search) {
  const GridConstants& grid = partition_->grid();
  const Int3 home = partition_->voxel_of(search.point), in_home = search.point - (grid.origin + grid.size * home);
  search.home = home;
  for (int k = 0; k < 3; ++k) search.parts[k] = static_cast<std::int32_t>(std::floor(std::clamp(in_home[k] * per_part_, -1e8, 1e8)));
  const std::int64_t size = grid.size;
  const Int3 voxels = grid.bricks * 8;
  if (const HostPartition::Voxel at = partition_->at(home); at.boundary != kNoVoxel) look_into(search, home, at.boundary);
  // How far the point is from voxels `by` away along an axis.
  const auto gap = [&](int axis, std::int32_t by) -> std::int64_t { return by == 0 ? 0 : by > 0 ? by * size - in_home[axis] : in_home[axis] - size * (by + 1); };
  const auto near = [&](std::int64_t squared) {
    return search.best == INT64_MAX || squared <= (search.best + kRounding) * (search.best + kRounding);
  };
  const std::int32_t last = std::max({voxels.x, voxels.y, voxels.z, std::abs(home.x), std::abs(home.y), std::abs(home.z)}) + 1;
  for (std::int32_t ring = 1; ring <= last; ++ring) {
    std::int64_t nearest = INT64_MAX;
    for (int axis = 0; axis < 3; ++axis) nearest = std::min({nearest, gap(axis, ring), gap(axis, -ring)});
    if (search.best != INT64_MAX && nearest > search.best + kRounding) return;
    const Int3 low = glm::max(home - Int3(ring), Int3(0)), high = glm::min(home + Int3(ring), voxels - Int3(1));
    for (std::int32_t z = low.z; z <= high.z; ++z) {
      const std::int64_t gz = gap(2, z - home.z), square_z = gz * gz;
      if (!near(square_z)) continue;
      for (std::int32_t y = low.y; y <= high.y; ++y) {
        const std::int64_t gy = gap(1, y - home.y), square_y = square_z + gy * gy;
        if (!near(square_y)) continue;
        const bool face = std::abs(z - home.z) == ring || std::abs(y - home.y) == ring;
        for (std::int32_t brick = low.x >> 3; brick <= high.x >> 3; ++brick) {
          HostPartition::Row row = partition_->row(brick, y, z);
          for (std::uint32_t bits = row.boundary; bits != 0; bits &= bits - 1, ++row.first) {
            const std::int32_t x = 8 * brick + std::countr_zero(bits), away = std::abs(x - home.x);
            if (away > ring || (!face && away != ring)) continue;
            const std::int64_t gx = gap(0, x - home.x);
            if (near(square_y + gx * gx)) look_into(search, Int3(x, y, z), row.first);
          }
        }
      }
    }
  }
}

DepthSearch::Depth DepthSearch::below(const Int3& point, std::uint32_t guess) {
  return on_this_processor([&] {
    Search search{.point = point};
    if (guess != kNobody) look_at(search, guess);
    look_round(search);
    return Depth{static_cast<std::uint32_t>(search.best), search.triangle};
  });
}

InsideSearch::InsideSearch(const LatticeMesh& mesh, const HostPartition& partition, std::span<const std::uint8_t> boxes)
    : mesh_(&mesh), partition_(&partition), boxes_(boxes), per_part_(static_cast<double>(kVoxelParts) / partition.grid().size), way_(mesh.closed ? partition.grid().boundary_voxels : 0) {
  constexpr std::size_t kMostKnown = std::size_t{1} << 14;   // 256 KiB (chosen)
  windings_.resize(kMostKnown);
  if (!mesh.closed) middle_.assign(partition.grid().boundary_voxels, kUnknown);
}

bool InsideSearch::inside(const Int3& point) {
  const Int3 voxel = partition_->voxel_of(point);
  const HostPartition::Voxel at = partition_->at(voxel);
  if (at.boundary == kNoVoxel) return at.kind == kVoxelInternal;
  return on_this_processor([&] { return inside_boundary(point, voxel, at.boundary); });
}

/// In a V_bnd voxel.
bool InsideSearch::inside_boundary(const Int3& point, const Int3& voxel, std::uint32_t boundary) {
  if (mesh_->closed) {
    std::uint8_t& way = way_[boundary];
    if (way == 0) way = shortest_way(voxel);
    const Walk out = walk(point, voxel, (way - 1) >> 1, ((way - 1) & 1) != 0 ? 1 : -1, true);
    return out.net + (out.kind == kVoxelInternal ? winding_of(out.voxel) : 0) != 0;
  }
  std::int16_t& winding = middle_[boundary];
  if (winding == kUnknown) winding = winding_by_walks(voxel);
  const Int3 middle = partition_->grid().origin + partition_->grid().size * voxel + Int3(partition_->grid().size / 2);
  return winding + (point == middle ? 0 : crossed_within(point, middle, voxel, boundary)) > 0;
}

/// Of a V_bnd voxel's middle: what most of six walks say.
std::int16_t InsideSearch::winding_by_walks(const Int3& voxel) const {
  const Int3 middle = partition_->grid().origin + partition_->grid().size * voxel + Int3(partition_->grid().size / 2);
  std::array<int, 6> said{};
  for (int axis = 0; axis < 3; ++axis)
    for (const int way : {1, -1}) {
      const Walk out = walk(middle, voxel, axis, way, false);
      said[static_cast<std::size_t>(2 * axis + (way > 0 ? 1 : 0))] = out.net + (out.kind == kVoxelInternal ? 1 : 0);
    }
  std::sort(said.begin(), said.end());
  return static_cast<std::int16_t>(std::clamp(said[2], -30000, 30000));
}

/// What the straight way from one end to the other, both in the voxel, crosses of what the voxel lists and what bounds a solid.
int InsideSearch::crossed_within(const Int3& from, const Int3& to, const Int3& voxel, std::uint32_t boundary) const {
  const GridConstants& grid = partition_->grid();
  const auto list = partition_->list(boundary);
  const std::size_t count = list.size();
  const std::uint8_t* boxes = &boxes_[6 * std::size_t{partition_->list_begin(boundary)}];
  std::int32_t low[3], high[3];   // of the way, in parts of the voxel, with a part to spare
  for (int k = 0; k < 3; ++k) {
    const double corner = grid.origin[k] + double(grid.size) * voxel[k];
    low[k] = static_cast<std::int32_t>((std::min(from[k], to[k]) - corner) * per_part_) - 1;
    high[k] = static_cast<std::int32_t>((std::max(from[k], to[k]) - corner) * per_part_) + 1;
  }
  int net = 0;
  constexpr std::size_t kAtOnce = 64;
  for (std::size_t first = 0; first < count; first += kAtOnce) {
    const std::size_t some = std::min(kAtOnce, count - first);
    std::uint8_t near[kAtOnce];
    const std::uint8_t *lx = boxes + first, *ly = lx + count, *lz = ly + count, *hx = lz + count, *hy = hx + count, *hz = hy + count;
    for (std::size_t i = 0; i < some; ++i)
      near[i] = lx[i] <= high[0] && hx[i] >= low[0] && ly[i] <= high[1] && hy[i] >= low[1] && lz[i] <= high[2] && hz[i] >= low[2] ? 1 : 0;
    for (std::size_t i = 0; i < some; ++i) {
      if (near[i] == 0) continue;
      const std::uint32_t id = list[first + i];
      if (bounds_solid(*mesh_, id)) net += exact::segment_crossing(from, to, {mesh_->corner(id, 0), mesh_->corner(id, 1), mesh_->corner(id, 2)});
    }
  }
  return net;
}

/// Along an axis to the first voxel that is not V_bnd. `sheets`: their triangles count, too.
InsideSearch::Walk InsideSearch::walk(const Int3& point, const Int3& voxel, int axis, int way, bool sheets) const {
  const GridConstants& grid = partition_->grid();
  Walk out{0, voxel, kVoxelBoundary};
  Int3 from = point;
  HostPartition::Voxel here = partition_->at(voxel);
  do {
    Int3 to = from;
    to[axis] = grid.origin[axis] + grid.size * (out.voxel[axis] + (way > 0 ? 1 : 0));
    if (from != to) out.net += crossed(from, to, axis, out.voxel, here.boundary, sheets);
    from = to;
    out.voxel[axis] += way;
    here = partition_->at(out.voxel);
  } while (here.boundary != kNoVoxel);
  out.kind = here.kind;
  return out;
}

/// What the way from one end to the other, along an axis and within a voxel, crosses of what the voxel lists: of those triangles that lie round it.
int InsideSearch::crossed(const Int3& from, const Int3& to, int axis, const Int3& voxel, std::uint32_t boundary, bool sheets) const {
  const GridConstants& grid = partition_->grid();
  const auto list = partition_->list(boundary);
  const std::size_t count = list.size();
  const std::uint8_t* boxes = &boxes_[6 * std::size_t{partition_->list_begin(boundary)}];
  const int u = axis == 2 ? 0 : axis + 1, v = axis == 0 ? 2 : axis - 1;
  const auto part = [&](int k) { return static_cast<std::int32_t>((from[k] - (grid.origin[k] + double(grid.size) * voxel[k])) * per_part_); };
  const std::int32_t at_u = part(u), at_v = part(v);
  int net = 0;
  constexpr std::size_t kAtOnce = 64;
  for (std::size_t first = 0; first < count; first += kAtOnce) {
    const std::size_t some = std::min(kAtOnce, count - first);
    std::uint8_t near[kAtOnce];
    const std::uint8_t *lu = boxes + static_cast<std::size_t>(u) * count + first, *hu = lu + 3 * count, *lv = boxes + static_cast<std::size_t>(v) * count + first, *hv = lv + 3 * count;
    // A part to spare: both are rounded down, and a double's rounding may come out on either side of a part's border.
    for (std::size_t i = 0; i < some; ++i) near[i] = lu[i] <= at_u + 1 && hu[i] + 1 >= at_u && lv[i] <= at_v + 1 && hv[i] + 1 >= at_v ? 1 : 0;
    for (std::size_t i = 0; i < some; ++i) {
      if (near[i] == 0) continue;
      const std::uint32_t id = list[first + i];
      if (sheets || bounds_solid(*mesh_, id)) net += exact::segment_crossing(from, to, {mesh_->corner(id, 0), mesh_->corner(id, 1), mesh_->corner(id, 2)});
    }
  }
  return net;
}

/// The way from a V_bnd voxel on which fewest of them lie; V_ext before V_int, whose winding has to be asked.
std::uint8_t InsideSearch::shortest_way(const Int3& voxel) const {
  for (std::int32_t steps = 1;; ++steps) {   // the grid's outermost layer is V_ext, so it ends
    std::uint8_t internal = 0;
    for (int axis = 0; axis < 3; ++axis)
      for (const int up : {0, 1}) {
        Int3 to = voxel;
        to[axis] += up != 0 ? steps : -steps;
        const HostPartition::Voxel there = partition_->at(to);
        if (there.boundary != kNoVoxel) continue;
        const auto way = static_cast<std::uint8_t>(axis * 2 + up + 1);
        if (there.kind != kVoxelInternal) return way;
        internal = way;
      }
    if (internal != 0) return internal;
  }
}

/// Of a V_int voxel of a closed body: what is crossed from its middle on along +x until nothing can be any more.
int InsideSearch::winding_of(const Int3& voxel) {
  const GridConstants& grid = partition_->grid();
  const Int3 n = grid.bricks * 8;
  const std::uint64_t number = 1 + static_cast<std::uint64_t>(voxel.x) + static_cast<std::uint64_t>(n.x) * (static_cast<std::uint64_t>(voxel.y) + static_cast<std::uint64_t>(n.y) * static_cast<std::uint64_t>(voxel.z));
  Known& known = windings_[(number * 0x9E3779B97F4A7C15) >> 32 & (windings_.size() - 1)];   // 2^64 / golden ratio
  if (known.voxel == number) return known.winding;
  int winding = 0;
  Int3 at = voxel, from = grid.origin + grid.size * voxel + Int3(grid.size / 2);
  for (; at.x < n.x; ++at.x) {
    const HostPartition::Voxel here = partition_->at(at);
    if (here.kind == kVoxelExternal) break;
    Int3 to = from;
    to.x = grid.origin.x + grid.size * (at.x + 1);
    if (here.boundary != kNoVoxel) winding += crossed(from, to, 0, at, here.boundary, true);
    from = to;
  }
  known = {number, winding};
  return winding;
}

}  // namespace palpate
