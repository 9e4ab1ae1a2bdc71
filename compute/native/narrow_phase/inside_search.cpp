#include "compute/native/narrow_phase/inside_search.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdlib>
#include <cstring>
#include <optional>

#include "compute/native/broad_phase/turned_boxes.h"
#include "compute/native/narrow_phase/crossing.h"
#include "compute/native/processor.h"
#include "compute/scene/exact.h"
#include "compute/scene/search_tables.h"

namespace palpate {

using namespace gpu;  // names of shaders/shared/scene.h

namespace {

bool bounds_solid(const LatticeMesh& mesh, std::uint32_t id) {
  return (mesh.flags[id] & (kTriangleCollapsed | kTriangleSheet)) == 0;
}

}  // namespace

InsideSearch::InsideSearch(const LatticeMesh& mesh, const PartitionLookup& partition,
                           std::span<const std::uint8_t> boxes)
    : mesh_(&mesh),
      partition_(&partition),
      boxes_(boxes),
      per_part_(static_cast<double>(kVoxelParts) / partition.grid().size),
      way_(mesh.closed ? partition.grid().boundary_voxels : 0) {
  constexpr std::size_t kMostKnown = std::size_t{1} << 14;  // 256 KiB (chosen)
  windings_.resize(kMostKnown);
}

bool InsideSearch::inside(const Int3& point) {
  const Int3 voxel = partition_->voxel_of(point);
  const PartitionLookup::Voxel at = partition_->at(voxel);
  if (at.boundary == kNoVoxel) return at.kind == kVoxelInternal;
  return on_this_processor([&] { return inside_boundary(point, voxel, at.boundary); });
}

void InsideSearch::inside(std::span<const Int3> points, std::span<std::uint8_t> answers) {
  struct Place {
    Int3 voxel;
    std::uint32_t boundary;
  };
  std::array<Place, kMostPoints> places;
  on_this_processor([&] {
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Int3 voxel = partition_->voxel_of(points[i]);
      const PartitionLookup::Voxel at = partition_->at(voxel);
      places[i] = {voxel, at.boundary};
      answers[i] = at.kind == kVoxelInternal ? 1 : 0;
      if (at.boundary != kNoVoxel) known_->cells.prefetch(at.boundary);
    }
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (places[i].boundary == kNoVoxel) continue;
      if (const std::optional<bool> known =
              known_->cells.find(points[i], places[i].voxel, places[i].boundary)) {
        answers[i] = *known ? 1 : 0;
        places[i].boundary = kNoVoxel;
        continue;
      }
      known_->crossings.prefetch(places[i].boundary);
      known_->shells->prefetch(places[i].boundary);
    }
    for (std::size_t i = 0; i < points.size(); ++i)
      if (places[i].boundary != kNoVoxel)
        answers[i] = shells_at(points[i], places[i].voxel, places[i].boundary) > 0 ? 1 : 0;
  });
}

/// In a V_bnd voxel.
bool InsideSearch::inside_boundary(const Int3& point, const Int3& voxel, std::uint32_t boundary) {
  if (mesh_->closed) {
    std::uint8_t& way = way_[boundary];
    if (way == 0) way = shortest_way(voxel);
    const Walk out = walk(point, voxel, (way - 1) >> 1, ((way - 1) & 1) != 0 ? 1 : -1);
    return out.net + (out.kind == kVoxelInternal ? winding_of(out.voxel) : 0) != 0;
  }
  if (const std::optional<bool> known = known_->cells.find(point, voxel, boundary)) return *known;
  return shells_at(point, voxel, boundary) > 0;
}

int InsideSearch::shells_at(const Int3& point, const Int3& voxel, std::uint32_t boundary) const {
  const GridConstants& grid = partition_->grid();
  const Int3 middle = grid.origin + grid.size * voxel + Int3(grid.size / 2);
  const int shells = known_->shells->middle(boundary);
  if (!known_->crossings.empty())
    if (const MiddleCrossings::Net net = known_->crossings.crossed(point - middle, boundary); !net.unsure)
      return shells + net.crossed;
  return shells + (point == middle ? 0 : crossed_within(point, middle, voxel, boundary));
}

std::uint32_t InsideSearch::sure(std::uint32_t weight, const Int3& point) const {
  const OpenShells& shells = *known_->shells;
  if (shells.agree()) return weight;
  const GridConstants& grid = partition_->grid();
  const Int3 voxel = partition_->voxel_of(point), in = point - (grid.origin + grid.size * voxel);
  const std::uint32_t boundary = partition_->at(voxel).boundary;
  std::uint32_t less = 0;
  if (boundary != kNoVoxel) {
    less = shells.less(boundary);
    if (less == 0 || shells_at(point, voxel, boundary) != 1) return weight;
  }
  // Within half a voxel are only neighbours on the near side of the middle, along each axis.
  Int3 side, way;
  for (int k = 0; k < 3; ++k) {
    side[k] = 2 * in[k] < grid.size ? -1 : 1;
    way[k] = side[k] < 0 ? in[k] : grid.size - in[k];
  }
  std::int32_t nearest = grid.size;  // twice the way to the nearest that says less
  for (int axes = 1; axes < 8; ++axes) {
    const Int3 along(axes & 1, axes >> 1 & 1, axes >> 2);
    const Int3 to = along * side, ways = along * way;
    const std::int32_t twice = 2 * std::max({ways.x, ways.y, ways.z});
    if (twice >= nearest) continue;
    const auto number = static_cast<unsigned>(13 + to.x + 3 * to.y + 9 * to.z);
    bool says_less = (less >> number & 1) != 0;
    if (boundary == kNoVoxel) {
      const std::uint32_t there = partition_->at(voxel + to).boundary;
      says_less = there != kNoVoxel && (shells.more(there) >> (26 - number) & 1) != 0;
    }
    if (says_less) nearest = twice;
  }
  if (nearest == grid.size) return weight;
  const std::uint64_t part = std::uint64_t{static_cast<std::uint32_t>(nearest)} *
                             ((1u << 31) / static_cast<std::uint32_t>(grid.size));
  return static_cast<std::uint32_t>((weight * part) >> 31);
}

OpenShells::Halves InsideSearch::halves_of(const Int3& voxel, std::uint32_t boundary) const {
  const GridConstants& grid = partition_->grid();
  const Int3 low = grid.origin + grid.size * voxel, middle = low + Int3(grid.size / 2);
  OpenShells::Halves out{};
  for (int axis = 0; axis < 3; ++axis)
    for (const int up : {1, 0}) {
      Int3 face = middle;
      face[axis] = low[axis] + up * grid.size;
      out[static_cast<std::size_t>(2 * axis + 1 - up)] = crossed(middle, face, axis, voxel, boundary, false);
    }
  return out;
}

/// Calls take(id) for what a V_bnd voxel lists and whose box there meets a box of parts. Sixteen at a time:
/// the tables may be read beyond a list's end.
template <class Take>
void InsideSearch::for_listed(std::uint32_t boundary, const Parts& low, const Parts& high,
                              Take&& take) const {
  constexpr std::size_t kLanes = SearchTables::kBoxesAtOnce;
  using Bytes = std::uint8_t __attribute__((vector_size(kLanes)));
  using Halves = std::uint64_t __attribute__((vector_size(kLanes)));
  const auto list = partition_->list(boundary);
  const std::size_t count = list.size();
  const std::uint8_t* boxes = &boxes_[6 * std::size_t{partition_->list_begin(boundary)}];
  Bytes least[3], most[3];
  for (int k = 0; k < 3; ++k) {
    least[k] = Bytes{} + static_cast<std::uint8_t>(std::clamp(low[k], 0, kVoxelParts - 1));
    most[k] = Bytes{} + static_cast<std::uint8_t>(std::clamp(high[k], 0, kVoxelParts - 1));
  }
  for (std::size_t first = 0; first < count; first += kLanes) {
    Bytes lows[3], highs[3];
    for (std::size_t k = 0; k < 3; ++k) {
      std::memcpy(&lows[k], boxes + k * count + first, kLanes);
      std::memcpy(&highs[k], boxes + (k + 3) * count + first, kLanes);
    }
    const auto meet = (Halves)((Bytes)(lows[0] <= most[0]) & (Bytes)(lows[1] <= most[1]) &
                               (Bytes)(lows[2] <= most[2]) & (Bytes)(highs[0] >= least[0]) &
                               (Bytes)(highs[1] >= least[1]) & (Bytes)(highs[2] >= least[2]));
    for (std::size_t half = 0; half < 2; ++half)
      for (std::uint64_t rest = meet[half] & 0x0101010101010101; rest != 0; rest &= rest - 1) {
        const std::size_t i = first + 8 * half + static_cast<std::size_t>(std::countr_zero(rest)) / 8;
        if (i < count) take(list[i]);
      }
  }
}

/// What the straight way from one end to the other, both in the voxel, crosses of what the voxel lists and
/// what bounds a solid.
int InsideSearch::crossed_within(const Int3& from, const Int3& to, const Int3& voxel,
                                 std::uint32_t boundary) const {
  const GridConstants& grid = partition_->grid();
  Parts low, high;  // of the way, with a part to spare
  for (int k = 0; k < 3; ++k) {
    const double corner = grid.origin[k] + double(grid.size) * voxel[k];
    low[k] = static_cast<std::int32_t>((std::min(from[k], to[k]) - corner) * per_part_) - 1;
    high[k] = static_cast<std::int32_t>((std::max(from[k], to[k]) - corner) * per_part_) + 1;
  }
  int net = 0;
  for_listed(boundary, low, high, [&](std::uint32_t id) {
    if (bounds_solid(*mesh_, id))
      net += segment_crossing(from, to, {mesh_->corner(id, 0), mesh_->corner(id, 1), mesh_->corner(id, 2)});
  });
  return net;
}

/// Along an axis to the first voxel that is not V_bnd. `sheets`: their triangles count, too.
InsideSearch::Walk InsideSearch::walk(const Int3& point, const Int3& voxel, int axis, int way) const {
  const GridConstants& grid = partition_->grid();
  Walk out{0, voxel, kVoxelBoundary};
  Int3 from = point;
  PartitionLookup::Voxel here = partition_->at(voxel);
  do {
    Int3 to = from;
    to[axis] = grid.origin[axis] + grid.size * (out.voxel[axis] + (way > 0 ? 1 : 0));
    if (from != to) out.net += crossed(from, to, axis, out.voxel, here.boundary, true);
    from = to;
    out.voxel[axis] += way;
    here = partition_->at(out.voxel);
  } while (here.boundary != kNoVoxel);
  out.kind = here.kind;
  return out;
}

/// What the way from one end to the other, along an axis and within a voxel, crosses of what the voxel lists:
/// of those triangles that lie round it.
int InsideSearch::crossed(const Int3& from, const Int3& to, int axis, const Int3& voxel,
                          std::uint32_t boundary, bool sheets) const {
  const GridConstants& grid = partition_->grid();
  // A part to spare: both are rounded down, and a double's rounding may come out on either side of a part's
  // border.
  Parts low(0), high(kVoxelParts - 1);
  for (const int k : {(axis + 1) % 3, (axis + 2) % 3}) {
    const auto part =
        static_cast<std::int32_t>((from[k] - (grid.origin[k] + double(grid.size) * voxel[k])) * per_part_);
    low[k] = part - 1;
    high[k] = part + 1;
  }
  int net = 0;
  for_listed(boundary, low, high, [&](std::uint32_t id) {
    if (sheets || bounds_solid(*mesh_, id))
      net += segment_crossing(from, to, {mesh_->corner(id, 0), mesh_->corner(id, 1), mesh_->corner(id, 2)});
  });
  return net;
}

/// The way from a V_bnd voxel on which fewest of them lie; V_ext before V_int, whose winding has to be asked.
std::uint8_t InsideSearch::shortest_way(const Int3& voxel) const {
  for (std::int32_t steps = 1;; ++steps) {  // the grid's outermost layer is V_ext, so it ends
    std::uint8_t internal = 0;
    for (int axis = 0; axis < 3; ++axis)
      for (const int up : {0, 1}) {
        Int3 to = voxel;
        to[axis] += up != 0 ? steps : -steps;
        const PartitionLookup::Voxel there = partition_->at(to);
        if (there.boundary != kNoVoxel) continue;
        const auto way = static_cast<std::uint8_t>(axis * 2 + up + 1);
        if (there.kind != kVoxelInternal) return way;
        internal = way;
      }
    if (internal != 0) return internal;
  }
}

/// Of a V_int voxel of a closed body: what is crossed from its middle on along +x until nothing can be any
/// more.
int InsideSearch::winding_of(const Int3& voxel) {
  const GridConstants& grid = partition_->grid();
  const Int3 n = grid.bricks * 8;
  const std::uint64_t number = 1 + static_cast<std::uint64_t>(voxel.x) +
                               static_cast<std::uint64_t>(n.x) *
                                   (static_cast<std::uint64_t>(voxel.y) +
                                    static_cast<std::uint64_t>(n.y) * static_cast<std::uint64_t>(voxel.z));
  Known& known =
      windings_[(number * 0x9E3779B97F4A7C15) >> 32 & (windings_.size() - 1)];  // 2^64 / golden ratio
  if (known.voxel == number) return known.winding;
  int winding = 0;
  Int3 at = voxel, from = grid.origin + grid.size * voxel + Int3(grid.size / 2);
  for (; at.x < n.x; ++at.x) {
    const PartitionLookup::Voxel here = partition_->at(at);
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
