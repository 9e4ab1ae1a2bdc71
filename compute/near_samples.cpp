#include "compute/near_samples.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "compute/processor.h"

namespace palpate {
namespace {

constexpr double kRootThree = 1.7320508075688774;

std::size_t at(const Int3& cell, const Int3& cells) {
  return static_cast<std::size_t>(cell.x) +
         static_cast<std::size_t>(cells.x) * (static_cast<std::size_t>(cell.y) + static_cast<std::size_t>(cells.y) * static_cast<std::size_t>(cell.z));
}

std::int32_t ceil_div(std::int32_t a, std::int32_t b) {
  const std::int32_t q = a / b;
  return q + (q * b < a ? 1 : 0);
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
        for (other[axis] = std::max(c[axis] - reach, 0); other[axis] <= std::min(c[axis] + reach, n[axis] - 1); ++other[axis]) most |= before[at(other, n)];
        cells[at(c, n)] = most;
      }
}

}  // namespace

struct NearSamples::Search {
  const LatticePose& pose;
  double rotation[3][3];      // world from tool
  double translation[3];
  NearLists& lists;

  /// Tool lattice point of a world lattice point, off by less than 2^-20.
  void to_tool(const Int3& p, double (&out)[3]) const {
    const double d[3] = {p.x - translation[0], p.y - translation[1], p.z - translation[2]};
    for (std::size_t c = 0; c < 3; ++c) out[c] = rotation[0][c] * d[0] + rotation[1][c] * d[1] + rotation[2][c] * d[2];
  }
  /// The same as docs/EXACTNESS.md section 4 rounds it. |p − translation| < 2^31: sums within 3 · 2^61.
  Int3 rounded_to_tool(const Int3& p) const {
    const std::int64_t d[3] = {std::int64_t{p.x} - pose.translation.x, std::int64_t{p.y} - pose.translation.y, std::int64_t{p.z} - pose.translation.z};
    Int3 out;
    for (int c = 0; c < 3; ++c) {
      const std::int64_t sum = pose.rotation_q30[0][c] * d[0] + pose.rotation_q30[1][c] * d[1] + pose.rotation_q30[2][c] * d[2] + (std::int64_t{1} << 29);
      out[c] = static_cast<std::int32_t>(sum >> 30);
    }
    return out;
  }
};

Result<NearSamples> NearSamples::make(VulkanDevice& device, const SceneGeometry& geometry, const PreparedScene& scene) {
  NearSamples out;
  const PartitionBuffers& m = scene.mockup.partition;
  out.mockup_ = m.grid;
  out.fine_ = scene.constants.fine;
  out.per_fine_ = 1.0 / out.fine_.size;
  out.per_cube_ = 1.0 / (8.0 * out.fine_.size);
  out.has_near_ = static_cast<bool>(scene.tool_near);
  out.listed_ = scene.samples && scene.samples->listed();
  out.mesh_ = &geometry.mockup;
  out.spacing_ = geometry.sample_spacing;
  out.sampled_ = scene.samples;
  const Int3 cubes = out.fine_.bricks;
  const std::size_t count = static_cast<std::size_t>(cubes.x) * static_cast<std::size_t>(cubes.y) * static_cast<std::size_t>(cubes.z);
  const Int3 n = m.grid.bricks;
  if (auto r = out.slots_.read(device, m.brick_slot, static_cast<std::size_t>(n.x) * static_cast<std::size_t>(n.y) * static_cast<std::size_t>(n.z)); !r) return r.error();
  if (auto r = out.bricks_.read(device, m.bricks, m.grid.mixed_bricks); !r) return r.error();
  if (auto r = out.list_begin_.read(device, m.list_begin, std::size_t{m.grid.boundary_voxels} + 1); !r) return r.error();
  if (out.listed_) {
    const PartitionBuffers& fine = scene.fine.brick_slot ? scene.fine : scene.tool.partition;
    if (auto r = out.list_triangles_.read(device, m.list_triangles, m.grid.list_entries); !r) return r.error();
    if (auto r = out.fine_slots_.read(device, fine.brick_slot, count); !r) return r.error();
    if (auto r = out.fine_bricks_.read(device, fine.bricks, out.fine_.mixed_bricks); !r) return r.error();
  }
  std::vector<std::uint8_t> any(count, 1);
  if (out.has_near_) {
    if (auto r = out.near_.read(device, scene.tool_near, count * 16); !r) return r.error();
    std::fill(any.begin(), any.end(), std::uint8_t{0});
    const Int3 cells = 8 * cubes;
    Int3 c;
    std::size_t i = 0;
    for (c.z = 0; c.z < cells.z; ++c.z)
      for (c.y = 0; c.y < cells.y; ++c.y)
        for (c.x = 0; c.x < cells.x; ++c.x, ++i)
          if ((out.near_[i >> 5] >> (i & 31) & 1u) != 0) any[at(c / 8, cubes)] = 1;
  }
  // Centres of voxels are within 3.5 voxels an axis of their brick's centre, within 1.5 of their octant's; what is beyond the fine grid
  // counts as at its border up to a voxel away.
  out.brick_ = out.make_level(any, 3.5 * kRootThree * m.grid.size + m.grid.size);
  out.octant_ = out.make_level(any, 1.5 * kRootThree * m.grid.size + m.grid.size);
  return out;
}

NearSamples::Level NearSamples::make_level(const std::vector<std::uint8_t>& cubes, double reach) const {
  Level out;
  out.border = static_cast<std::int32_t>((reach + 2) * per_cube_) + 1;
  out.cells = fine_.bricks + 2 * out.border;
  out.near.resize(static_cast<std::size_t>(out.cells.x) * static_cast<std::size_t>(out.cells.y) * static_cast<std::size_t>(out.cells.z));
  Int3 c;
  for (c.z = 0; c.z < fine_.bricks.z; ++c.z)
    for (c.y = 0; c.y < fine_.bricks.y; ++c.y)
      for (c.x = 0; c.x < fine_.bricks.x; ++c.x) out.near[at(c + out.border, out.cells)] = cubes[at(c, fine_.bricks)];
  for (int axis = 0; axis < 3; ++axis) widen(out.near, out.cells, axis, out.border);
  return out;
}

bool NearSamples::near_cube(const Level& level, const double (&p)[3]) const {
  Int3 cell;
  for (int k = 0; k < 3; ++k) {
    const double along = (p[k] - fine_.origin[k]) * per_cube_ + level.border;
    if (!(along >= 0 && along < level.cells[k])) return false;
    cell[k] = static_cast<std::int32_t>(along);
  }
  return level.near[at(cell, level.cells)] != 0;
}

bool NearSamples::near_voxel(const double (&p)[3]) const {
  if (!has_near_) return true;
  Int3 cell;
  const Int3 n = 8 * fine_.bricks;
  for (int k = 0; k < 3; ++k) {
    // What reaches out of the grid has its nearest voxel of the solid seen from the border: the grid is padded by two voxels.
    const double d = p[k] - fine_.origin[k];
    if (d < -mockup_.size || d > static_cast<double>(n[k]) * fine_.size + mockup_.size) return false;
    cell[k] = static_cast<std::int32_t>(std::clamp(d * per_fine_, 0.0, n[k] - 1.0));
  }
  const std::size_t i = at(cell, n);
  return (near_[i >> 5] >> (i & 31) & 1u) != 0;
}

/// kVoxel… of the tool's fine partition; V_ext beyond the grid. For an open sample the device begins at the same voxel.
std::uint32_t NearSamples::fine_class(const Int3& p) const {
  Int3 v;
  for (int k = 0; k < 3; ++k) {
    // Half a step from the nearest integer quotient, which is far more than a double rounds.
    const double along = (p[k] - fine_.origin[k] + 0.5) * per_fine_;
    if (!(along >= 0 && along < 8 * fine_.bricks[k])) return gpu::kVoxelExternal;
    v[k] = static_cast<std::int32_t>(along);
  }
  const std::uint32_t slot = fine_slots_[at(Int3(v.x >> 3, v.y >> 3, v.z >> 3), fine_.bricks)];
  if (slot >= gpu::kBrickInternal) return slot == gpu::kBrickInternal ? gpu::kVoxelInternal : gpu::kVoxelExternal;
  const auto bit = static_cast<unsigned>((v.x & 7) | (v.y & 7) << 3 | (v.z & 7) << 6);
  if ((fine_bricks_[slot].boundary[bit >> 5] >> (bit & 31) & 1) != 0) return gpu::kVoxelBoundary;
  return (fine_bricks_[slot].internal_[bit >> 5] >> (bit & 31) & 1) != 0 ? gpu::kVoxelInternal : gpu::kVoxelExternal;
}

bool NearSamples::take_voxel(Search& search, const Int3& voxel, std::uint32_t boundary) const {
  const std::uint32_t begin = list_begin_[boundary], end = list_begin_[boundary + 1];
  if (listed_) {
    const HostSamples& from = *sampled_;
    const auto take = [&](const gpu::FrameSample& sample) {
      const std::uint32_t voxel_class = fine_class(search.rounded_to_tool(sample.point));
      if (voxel_class == gpu::kVoxelInternal) return search.lists.push(search.lists.inside, gpu::kListInsideSamples, sample);
      return voxel_class != gpu::kVoxelBoundary || search.lists.push(search.lists.open, gpu::kListOpenSamples, sample);
    };
    const Int3 low = mockup_.origin + mockup_.size * voxel;
    Int3 grid;   // the voxel's first grid point, axis by axis
    for (int k = 0; k < 3; ++k) grid[k] = spacing_ * ceil_div(low[k], spacing_);
    for (std::uint32_t e = begin; e < end; ++e) {
      const std::uint32_t head = from.begin[e], id = list_triangles_[e], last = from.begin[e + 1] & HostSamples::kBegin;
      if ((head & HostSamples::kCorner) != 0 && !take({mesh_->corner(id, 0), id | gpu::kCornerProbe})) return false;
      const int axis = static_cast<int>(head >> HostSamples::kAxisShift), u = axis == 2 ? 0 : axis + 1, v = axis == 0 ? 2 : axis - 1;
      for (std::uint32_t i = head & HostSamples::kBegin; i < last; ++i) {
        const std::uint32_t* at = &from.words[from.wide ? 2 * std::size_t{i} : i];
        const std::uint32_t place = from.wide ? at[1] : *at >> 20;
        gpu::FrameSample sample{{}, id};
        sample.point[axis] = low[axis] + static_cast<std::int32_t>(from.wide ? *at : *at & 0xFFFFF);
        sample.point[u] = grid[u] + spacing_ * static_cast<std::int32_t>(place & 63);
        sample.point[v] = grid[v] + spacing_ * static_cast<std::int32_t>(place >> 6);
        if (!take(sample)) return false;
      }
    }
    return true;
  }
  for (std::uint32_t e = begin; e < end; e += gpu::kSampleChunk)
    if (!search.lists.push(search.lists.samples, gpu::kListSampleChunks, {voxel, e, std::min(e + gpu::kSampleChunk, end)})) return false;
  return true;
}

void NearSamples::take_brick(Search& search, const Int3& brick, std::uint32_t slot) const {
  const std::int32_t size = mockup_.size;
  const Int3 origin = mockup_.origin + 8 * size * brick;
  double q[3];
  search.to_tool(origin + 4 * size, q);
  if (!near_cube(brick_, q)) return;
  const gpu::Brick& voxels = bricks_[slot];
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
      for (std::uint32_t rest = voxels.boundary[word] & mask; rest != 0; rest &= rest - 1) {
        const auto bit = static_cast<std::int32_t>(std::countr_zero(rest));
        const Int3 in_brick(bit & 7, 4 * octant.y + (bit >> 3), z);
        search.to_tool(origin + size * in_brick + size / 2, q);
        if (!near_voxel(q)) continue;
        const std::uint32_t before = voxels.boundary[word] & ((1u << bit) - 1);
        if (!take_voxel(search, 8 * brick + in_brick, voxels.first[word] + static_cast<std::uint32_t>(std::popcount(before)))) return;
      }
    }
  }
}

void NearSamples::find(const LatticePose& pose, const Int3& first, const Int3& last, NearLists& lists) const {
  Search search{pose, {}, {}, lists};
  for (std::size_t r = 0; r < 3; ++r) {
    for (std::size_t c = 0; c < 3; ++c) search.rotation[r][c] = pose.rotation_q30[r][c] * 0x1p-30;
    search.translation[r] = pose.translation[static_cast<int>(r)];
  }
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
