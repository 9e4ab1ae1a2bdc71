#include "compute/native/broad_phase/candidate_samples.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <optional>
#include <span>

#include "compute/native/processor.h"

namespace palpate {
namespace {

constexpr double kRootThree = 1.7320508075688774;

std::size_t at(const Int3& cell, const Int3& cells) {
  return static_cast<std::size_t>(cell.x) +
         static_cast<std::size_t>(cells.x) *
             (static_cast<std::size_t>(cell.y) +
              static_cast<std::size_t>(cells.y) * static_cast<std::size_t>(cell.z));
}

/// Every cell takes the largest of those up to `reach` before and behind it along an axis.
void widen(std::vector<std::uint8_t>& cells, const Int3& n, int axis, std::int32_t reach) {
  const std::vector<std::uint8_t> before = cells;
  Int3 c;
  for (c.z = 0; c.z < n.z; ++c.z)
    for (c.y = 0; c.y < n.y; ++c.y)
      for (c.x = 0; c.x < n.x; ++c.x) {
        Int3 other = c;
        std::uint8_t most = 0;
        for (other[axis] = std::max(c[axis] - reach, 0);
             other[axis] <= std::min(c[axis] + reach, n[axis] - 1); ++other[axis])
          most |= before[at(other, n)];
        cells[at(c, n)] = most;
      }
}

constexpr std::size_t kEight = VoxelSamples::kPointsAtOnce;

/// From the mock-up's voxels to cubes of the tool at a pose, numbers of the latter.
struct NearTurn {
  double column[3][3];  ///< a mock-up voxel further along [1] is so much along [0]
};

/// From 1024ths of the mock-up's voxels to cubes of the tool at a pose, numbers of the latter.
struct PointTurn {
  float column[3][3];  ///< a 1024th further along [1] is so much along [0]
  float end[3];        ///< the grid's cubes
  float error;         ///< of a point, along each axis
};

/// Boundary voxels of a brick.
struct BrickVoxels {
  double first_centre[3];          ///< the centre of the brick's first voxel, in cubes
  std::int32_t bit[512 + kEight];  ///< x + 8y + 64z
  std::uint32_t number[512];
  std::size_t count = 0;
};

/// Which of these cubes are near to the tool's solid.
struct NearCells {
  std::span<const std::uint32_t> bits;
  std::int32_t size[3];  ///< cubes, …
  double end[3];         ///< … the same
  double beyond;  ///< what reaches so far out of the grid has its nearest voxel of the solid seen from the
                  ///< border: the grid is padded by two voxels
};

/// Points in cubes of the tool.
struct SolidPoints {
  unsigned may, unsure;  ///< a bit each: may lie in the solid; the cube may be the next one
  std::uint32_t block[kEight], bit[kEight];  ///< which cube, where it is sure (SolidBits)
};

namespace plain {
constexpr std::size_t kWidth = 4;
#include "compute/native/broad_phase/candidate_samples_simd.h"
}  // namespace plain
#if PALPATE_TWO_CODES
PALPATE_SECOND_CODE_BEGIN
namespace second {
constexpr std::size_t kWidth = 8;
#include "compute/native/broad_phase/candidate_samples_simd.h"
}  // namespace second
PALPATE_SECOND_CODE_END
#endif

std::size_t near_voxels(const NearTurn& turn, const BrickVoxels& voxels, const NearCells& cells,
                        std::uint16_t* near) {
#if PALPATE_TWO_CODES
  if (has_second_code()) return second::near_voxels(turn, voxels, cells, near);
#endif
  return plain::near_voxels(turn, voxels, cells, near);
}

void solid_points(const PointTurn& turn, const float (&low)[3], const SolidBits& solid,
                  const std::uint32_t* points, SolidPoints& out) {
#if PALPATE_TWO_CODES
  if (has_second_code()) return second::solid_points(turn, low, solid, points, out);
#endif
  plain::solid_points(turn, low, solid, points, out);
}

}  // namespace

struct CandidateSamples::Search {
  const LatticePose& pose;
  double rotation[3][3];  // world from tool
  double translation[3];
  Candidates& lists;
  NearTurn near{};
  PointTurn points{};

  /// Tool lattice point of a world lattice point, off by less than 2^-20.
  void to_tool(const Int3& p, double (&out)[3]) const {
    const double d[3] = {p.x - translation[0], p.y - translation[1], p.z - translation[2]};
    for (std::size_t c = 0; c < 3; ++c)
      out[c] = rotation[0][c] * d[0] + rotation[1][c] * d[1] + rotation[2][c] * d[2];
  }
  /// The same as docs/EXACTNESS.md section 4 rounds it. |p − translation| < 2^31: sums within 3 · 2^61.
  Int3 rounded_to_tool(const Int3& p) const {
    const std::int64_t d[3] = {std::int64_t{p.x} - pose.translation.x, std::int64_t{p.y} - pose.translation.y,
                               std::int64_t{p.z} - pose.translation.z};
    Int3 out;
    for (int c = 0; c < 3; ++c) {
      const std::int64_t sum = pose.rotation_q30[0][c] * d[0] + pose.rotation_q30[1][c] * d[1] +
                               pose.rotation_q30[2][c] * d[2] + (std::int64_t{1} << 29);
      out[c] = static_cast<std::int32_t>(sum >> 30);
    }
    return out;
  }
};

CandidateSamples CandidateSamples::make(const SceneGeometry& geometry, const SceneTables& scene) {
  CandidateSamples out;
  const PartitionView& m = scene.mockup;
  const gpu::GridConstants& fine = scene.constants.fine;
  out.mockup_ = m.grid;
  out.listed_ = scene.samples && scene.samples->listed();
  out.mesh_ = &geometry.mockup;
  out.spacing_ = geometry.sample_spacing;
  out.sampled_ = scene.samples;
  out.slots_ = m.brick_slot;
  out.bricks_ = m.bricks;
  out.list_begin_ = m.list_begin;
  if (out.listed_) {
    out.list_triangles_ = m.list_triangles;
    BrickBits may, all;
    may.make(scene.fine, BrickBits::Of::kOccupied);
    all.make(scene.fine, BrickBits::Of::kInternal);
    out.cubes_ = {fine.origin, 1.0 / fine.size, fine.bricks, {may, all}};
  }
  out.use({fine.origin, 1.0 / fine.size, fine.bricks, scene.tool_near});
  return out;
}

void CandidateSamples::use(const Near& near) {
  near_ = near;
  const Int3 cubes = near.bricks;
  std::vector<std::uint8_t> any(brick_count(cubes), 1);
  if (!near.bits.empty()) {
    std::fill(any.begin(), any.end(), std::uint8_t{0});
    const Int3 cells = 8 * cubes;
    Int3 c;
    std::size_t i = 0;
    for (c.z = 0; c.z < cells.z; ++c.z)
      for (c.y = 0; c.y < cells.y; ++c.y)
        for (c.x = 0; c.x < cells.x; ++c.x, ++i)
          if ((near.bits[i >> 5] >> (i & 31) & 1u) != 0) any[at(c / 8, cubes)] = 1;
  }
  // Centres of voxels are within 3.5 voxels an axis of their brick's centre, within 1.5 of their octant's;
  // what is beyond the grid counts as at its border up to a voxel away.
  brick_ = make_level(any, 3.5 * kRootThree * mockup_.size + mockup_.size);
  octant_ = make_level(any, 1.5 * kRootThree * mockup_.size + mockup_.size);
}

void CandidateSamples::use(std::shared_ptr<const OpenInside> known, const PartitionView& partition) {
  Cubes cells;
  BrickBits may, all;
  if (!listed_ || !known->cells.spread(partition, may, all)) return;
  const gpu::GridConstants& grid = partition.grid;
  cells.origin = grid.origin;
  cells.per_step = static_cast<double>(InsideCells::kCells) / grid.size;
  cells.bricks = InsideCells::kCells * grid.bricks;
  cells.solid = {may, all};
  cubes_ = std::move(cells);
  known_ = std::move(known);
  use(Near{grid.origin, static_cast<double>(OpenInside::kNearParts) / grid.size,
           OpenInside::kNearParts * grid.bricks, known_->near});
}

CandidateSamples::Level CandidateSamples::make_level(const std::vector<std::uint8_t>& cubes,
                                                     double reach) const {
  Level out;
  out.border = static_cast<std::int32_t>((reach + 2) * near_.per_step / 8) + 1;
  out.cells = near_.bricks + 2 * out.border;
  out.near.resize(static_cast<std::size_t>(out.cells.x) * static_cast<std::size_t>(out.cells.y) *
                  static_cast<std::size_t>(out.cells.z));
  Int3 c;
  for (c.z = 0; c.z < near_.bricks.z; ++c.z)
    for (c.y = 0; c.y < near_.bricks.y; ++c.y)
      for (c.x = 0; c.x < near_.bricks.x; ++c.x)
        out.near[at(c + out.border, out.cells)] = cubes[at(c, near_.bricks)];
  for (int axis = 0; axis < 3; ++axis) widen(out.near, out.cells, axis, out.border);
  return out;
}

bool CandidateSamples::near_cube(const Level& level, const double (&p)[3]) const {
  Int3 cell;
  for (int k = 0; k < 3; ++k) {
    const double along = (p[k] - near_.origin[k]) * near_.per_step / 8 + level.border;
    if (!(along >= 0 && along < level.cells[k])) return false;
    cell[k] = static_cast<std::int32_t>(along);
  }
  return level.near[at(cell, level.cells)] != 0;
}

/// kVoxel… of the cube that holds a point; V_ext beyond the grid. V_bnd: it may lie inside, and may not.
std::uint32_t CandidateSamples::class_at(const Int3& p) const {
  Int3 v;
  for (int k = 0; k < 3; ++k) {
    // Of fine voxels half a step from the nearest integer quotient, which is far more than a double rounds.
    const double along = (p[k] - cubes_.origin[k] + 0.5) * cubes_.per_step;
    if (!(along >= 0 && along < 8 * cubes_.bricks[k])) return gpu::kVoxelExternal;
    v[k] = static_cast<std::int32_t>(along);
  }
  const SolidBits::Block& block = cubes_.solid.block(cubes_.solid.number(at(v >> 3, cubes_.bricks)));
  const auto bit = static_cast<std::uint32_t>((v.x & 7) | (v.y & 7) << 3 | (v.z & 7) << 6);
  return block.all_at(bit)   ? gpu::kVoxelInternal
         : block.may_at(bit) ? gpu::kVoxelBoundary
                             : gpu::kVoxelExternal;
}

bool CandidateSamples::take_listed(Search& search, const Int3& voxel, std::uint32_t boundary) const {
  const VoxelSamples& from = *sampled_;
  const Int3 lowest = mockup_.origin + mockup_.size * voxel;
  std::optional<VoxelSamples::Voxel> grid;  // once a point is wanted
  double at[3];
  search.to_tool(lowest, at);
  float low[3];
  for (std::size_t k = 0; k < 3; ++k) {
    const float(&column)[3] = search.points.column[k];
    // Half a step, since points are rounded to steps (class_at), and half a 1024th.
    low[k] = static_cast<float>((at[k] - cubes_.origin[static_cast<int>(k)] + 0.5) * cubes_.per_step) +
             0.5F * (column[0] + column[1] + column[2]);
  }
  const std::uint32_t* const ids = &list_triangles_[list_begin_[boundary]];
  const VoxelSamples::Begin begin = from.begin[boundary], end = from.begin[boundary + 1];
  const std::uint32_t first_sample = end.point - (end.sample - begin.sample);
  const std::uint16_t* const owners = from.owners.data() + begin.owner;
  for (std::uint32_t first = begin.point; first < end.point; first += kEight) {
    SolidPoints solid;
    solid_points(search.points, low, cubes_.solid, &from.points[first], solid);
    if (end.point - first < kEight) solid.may &= (1u << (end.point - first)) - 1;
    for (; solid.may != 0; solid.may &= solid.may - 1) {
      const auto lane = static_cast<unsigned>(std::countr_zero(solid.may));
      const std::uint32_t point = first + lane;
      const bool sure = (solid.unsure >> lane & 1) == 0;
      std::uint32_t kind = sure && cubes_.solid.block(solid.block[lane]).all_at(solid.bit[lane])
                               ? gpu::kVoxelInternal
                               : gpu::kVoxelBoundary;
      gpu::FrameSample sample{};
      std::span<const std::uint16_t> triangles(&from.entries[point], 1);
      std::uint32_t mark = 0;
      if (point < first_sample) {
        const std::uint32_t last =
            point + 1 < first_sample ? from.entries[point + 1] : end.owner - begin.owner;
        triangles = {owners + from.entries[point], owners + last};
        if (kind == gpu::kVoxelBoundary)
          sample.point = mesh_->corner(ids[triangles.front()],
                                       0);  // two loads, anywhere in the mesh; inside nobody asks
        mark = gpu::kCornerProbe;
      } else {
        if (!grid) grid.emplace(lowest, spacing_);
        sample.point = from.sample(*grid, static_cast<int>(from.points[point] >> VoxelSamples::kAxisShift),
                                   begin.sample + (point - first_sample));
      }
      if (!sure) kind = class_at(search.rounded_to_tool(sample.point));
      if (kind == gpu::kVoxelExternal) continue;
      const bool internal = kind == gpu::kVoxelInternal;
      auto& list = internal ? search.lists.inside : search.lists.open;
      for (const std::uint16_t entry : triangles) {
        sample.static_id = ids[entry] | mark;
        if (!search.lists.push(list, internal ? kCandidateInside : kCandidateOpen, sample)) return false;
      }
    }
  }
  return true;
}

bool CandidateSamples::take_voxel(Search& search, const Int3& voxel, std::uint32_t boundary) const {
  if (listed_) return take_listed(search, voxel, boundary);
  const std::uint32_t end = list_begin_[boundary + 1];
  for (std::uint32_t e = list_begin_[boundary]; e < end; e += gpu::kSampleChunk)
    if (!search.lists.push(search.lists.samples, kCandidateChunks,
                           {voxel, e, std::min(e + gpu::kSampleChunk, end)}))
      return false;
  return true;
}

void CandidateSamples::take_brick(Search& search, const Int3& brick, std::uint32_t slot) const {
  const std::int32_t size = mockup_.size;
  const Int3 origin = mockup_.origin + 8 * size * brick;
  double q[3];
  search.to_tool(origin + 4 * size, q);
  if (!near_cube(brick_, q)) return;
  const gpu::Brick& voxels = bricks_[slot];
  BrickVoxels found;
  for (std::int32_t o = 0; o < 8; ++o) {
    const Int3 octant(o & 1, o >> 1 & 1, o >> 2);
    const std::uint32_t mask = 0x0F0F0F0Fu << 4 * octant.x;
    std::uint32_t any = 0;
    for (std::int32_t z = 0; z < 4; ++z) any |= voxels.boundary[2 * (4 * octant.z + z) + octant.y] & mask;
    if (any == 0) continue;
    search.to_tool(origin + size * (4 * octant + 2), q);
    if (!near_cube(octant_, q)) continue;
    for (std::int32_t z = 4 * octant.z; z < 4 * octant.z + 4; ++z) {
      const auto word = static_cast<std::uint32_t>(2 * z + octant.y);
      const std::uint32_t boundary = voxels.boundary[word];
      for (std::uint32_t rest = boundary & mask; rest != 0; rest &= rest - 1) {
        const auto bit = static_cast<std::uint32_t>(std::countr_zero(rest));
        found.bit[found.count] = static_cast<std::int32_t>(word << 5 | bit);
        found.number[found.count++] =
            voxels.first[word] + static_cast<std::uint32_t>(std::popcount(boundary & ((1u << bit) - 1)));
      }
    }
  }
  std::uint16_t near[512 + kEight];
  std::size_t count = found.count;
  if (!near_.bits.empty()) {
    std::fill_n(&found.bit[count], kEight, 0);
    search.to_tool(origin + size / 2, q);
    NearCells cells{near_.bits, {}, {}, mockup_.size * near_.per_step};
    for (std::size_t k = 0; k < 3; ++k) {
      found.first_centre[k] = (q[k] - near_.origin[static_cast<int>(k)]) * near_.per_step;
      cells.size[k] = 8 * near_.bricks[static_cast<int>(k)];
      cells.end[k] = cells.size[k];
    }
    count = near_voxels(search.near, found, cells, near);
  } else {
    for (std::size_t i = 0; i < count; ++i) near[i] = static_cast<std::uint16_t>(i);
  }
  if (listed_)
    for (std::size_t i = 0; i < count; ++i) {
      const std::uint32_t boundary = found.number[near[i]];
      const std::uint32_t point = sampled_->begin[boundary].point;
      __builtin_prefetch(sampled_->points.data() + point);
      __builtin_prefetch(sampled_->entries.data() + point);
      __builtin_prefetch(sampled_->words.data() +
                         std::size_t{sampled_->wide ? 2U : 1U} * sampled_->begin[boundary].sample);
      __builtin_prefetch(sampled_->owners.data() + sampled_->begin[boundary].owner);
      __builtin_prefetch(&list_triangles_[list_begin_[boundary]]);
    }
  for (std::size_t i = 0; i < count; ++i) {
    const std::int32_t bit = found.bit[near[i]];
    if (!take_voxel(search, 8 * brick + Int3(bit & 7, bit >> 3 & 7, bit >> 6), found.number[near[i]])) return;
  }
}

void CandidateSamples::find(const LatticePose& pose, const Int3& first, const Int3& last,
                            Candidates& lists) const {
  Search search{pose, {}, {}, lists};
  for (std::size_t r = 0; r < 3; ++r) {
    for (std::size_t c = 0; c < 3; ++c) search.rotation[r][c] = pose.rotation_q30[r][c] * 0x1p-30;
    search.translation[r] = pose.translation[static_cast<int>(r)];
  }
  const double ratio = mockup_.size * cubes_.per_step;
  double most = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    for (std::size_t r = 0; r < 3; ++r) {
      search.near.column[k][r] = search.rotation[r][k] * (mockup_.size * near_.per_step);
      search.points.column[k][r] =
          static_cast<float>(search.rotation[r][k] * ratio / (1 << VoxelSamples::kPointBits));
    }
    const double cubes = 8.0 * cubes_.bricks[static_cast<int>(k)];
    search.points.end[k] = static_cast<float>(cubes);
    most = std::max(most, cubes);
  }
  // A point lies within half a 1024th of its word's middle along each axis, √3 / 2 of one at most along a
  // turned one. Single precision: the voxel's low corner, three columns, their products and sums, all below
  // the grid's size and a few voxels: eight roundings.
  search.points.error = static_cast<float>(kRootThree / 2 * ratio / (1 << VoxelSamples::kPointBits) +
                                           (most + 4 * ratio + 4) * 0x1p-21);
  on_this_processor([&] {
    Int3 b;
    for (b.z = first.z; b.z <= last.z; ++b.z)
      for (b.y = first.y; b.y <= last.y; ++b.y)
        for (b.x = first.x; b.x <= last.x; ++b.x) {
          const std::uint32_t slot = slots_[at(b, mockup_.bricks)];
          if (slot >= gpu::kBrickInternal) continue;
          take_brick(search, b, slot);
          if (lists.full != gpu::kNone) return;
        }
  });
}

}  // namespace palpate
