#include "compute/native/broad_phase/candidate_pairs.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "compute/native/broad_phase/listed_boxes.h"
#include "compute/native/processor.h"
#include "compute/scene/search_tables.h"

namespace palpate {
namespace {

constexpr std::int32_t kFewVoxels = 64;  // beyond, a look at the brick as a whole comes first (chosen)

}  // namespace

CandidatePairs CandidatePairs::make(const SceneTables& scene) {
  CandidatePairs out;
  const PartitionView& mockup = scene.mockup;
  out.grid_ = mockup.grid;
  out.per_part_ = static_cast<double>(kVoxelParts) / mockup.grid.size;
  // Boxes of parts reach a part further than their highs. A test is off by less than a sixteenth of a half
  // part: sums in single precision below 2048 half parts by less than 2^-10, and doubles before that by far
  // less.
  out.slack_ = 1 + static_cast<float>(2 * out.per_part_ * (gpu::kCloseSteps + 1)) + 0x1p-4F;
  out.bricks_ = mockup.bricks;
  out.list_begin_ = mockup.list_begin;
  out.list_triangles_ = mockup.list_triangles;
  out.boxes_ = scene.search->boxes;
  return out;
}

bool CandidatePairs::begin(const exact::Corners& corners, std::uint32_t place, const EightRanges& boxes,
                           std::size_t i, Seen& seen, Triangle& out) const {
  const exact::Normal n = exact::raw_normal(corners);
  if (n == exact::Normal{}) return false;
  out.place = place;
  out.voxels = boxes.range(i);
  out.corner = corners[0];
  out.normal = {static_cast<double>(n.x), static_cast<double>(n.y), static_cast<double>(n.z)};
  out.normal_size = std::abs(out.normal[0]) + std::abs(out.normal[1]) + std::abs(out.normal[2]);
  const double each = 1 / out.normal_size;
  out.half_parts = each * (2 * per_part_);
  out.half_facing = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    out.look.facing[k] = static_cast<float>(2 * out.normal[k] * each);
    out.half_facing += 0.5F * out.look.facing[k];
    out.parts[k] = boxes.low[k][i];
    out.parts[k + 3] = boxes.high[k][i];
  }
  out.look.slack = slack_;
  if (++seen.looker_ == 0) {  // once in 2^32 triangles
    std::fill(seen.by_.begin(), seen.by_.end(), 0u);
    seen.looker_ = 1;
  }
  return true;
}

/// Whether all of a box of voxels, grown by kCloseSteps, lies on one side of the triangle's plane. A step is
/// taken for the rounding of doubles: with distances below 2^30 the sum is off by less than 2^-20 of the
/// normal's size.
bool CandidatePairs::off_plane(const Triangle& triangle, const Int3& low, std::int32_t side) const {
  const double half = 0.5 * side;
  const Int3& a = triangle.corner;
  const double distance = triangle.normal[0] * (low.x - a.x + half) +
                          triangle.normal[1] * (low.y - a.y + half) +
                          triangle.normal[2] * (low.z - a.z + half);
  return std::abs(distance) > triangle.normal_size * (half + gpu::kCloseSteps + 1);
}

/// Of the static triangles that a voxel lists, those whose boxes there meet the triangle's and its plane.
/// Where two triangles are within kCloseSteps of each other, the static one is so in some voxel that lists
/// it, and there all of this lets it pass.
bool CandidatePairs::take_list(Triangle& triangle, const Int3& voxel, std::uint32_t boundary, Seen& seen,
                               Candidates& lists) const {
  ListLook& look = triangle.look;
  double distance = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const int axis = static_cast<int>(k);
    look.box[k] = triangle.parts[k] - kVoxelParts * voxel[axis];
    look.box[k + 3] = triangle.parts[k + 3] - kVoxelParts * voxel[axis];
    distance += triangle.normal[k] * (grid_.origin[axis] + grid_.size * voxel[axis] - triangle.corner[axis]);
  }
  look.plane = static_cast<float>(distance * triangle.half_parts) + triangle.half_facing;
  const std::size_t begin = list_begin_[boundary], count = list_begin_[boundary + 1] - begin;
  seen.looks += 1 + count;
  for (std::size_t first = 0; first < count; first += kMostBoxes)
    for (std::uint64_t rest =
             near_boxes(look, &boxes_[6 * begin + first], count, std::min(count - first, kMostBoxes));
         rest != 0; rest &= rest - 1) {
      const std::uint32_t id =
          list_triangles_[begin + first + static_cast<std::size_t>(std::countr_zero(rest))];
      if (seen.by_[id] == seen.looker_) continue;  // one pair lies in many voxels
      seen.by_[id] = seen.looker_;
      if (!lists.push(lists.pairs, kCandidatePairs, {id, triangle.place})) return false;
    }
  return true;
}

bool CandidatePairs::take(Triangle& triangle, const Int3& brick, std::uint32_t slot, Seen& seen,
                          Candidates& lists) const {
  return on_this_processor([&] { return take_brick(triangle, brick, slot, seen, lists); });
}

bool CandidatePairs::take_brick(Triangle& triangle, const Int3& brick, std::uint32_t slot, Seen& seen,
                                Candidates& lists) const {
  const std::int32_t size = grid_.size;
  const Int3 origin = grid_.origin + 8 * size * brick;
  if (slot == gpu::kBrickInternal) {
    if (off_plane(triangle, origin, 8 * size)) return true;
    return lists.push(
        lists.touch, kCandidateTouch,
        {triangle.place, gpu::kNoVoxel, brick.x * 8 | brick.y * 8 << 16, brick.z * 8 | kWholeBrick});
  }
  Int3 first, last;
  for (int k = 0; k < 3; ++k) {
    first[k] = std::max(triangle.voxels.first[k] - 8 * brick[k], 0);
    last[k] = std::min(triangle.voxels.last[k] - 8 * brick[k], 7);
    if (first[k] > last[k]) return true;
  }
  const Int3 n = last - first + 1;
  if (n.x * n.y * n.z > kFewVoxels && off_plane(triangle, origin, 8 * size)) return true;
  const std::uint32_t along_x = (2u << last.x) - (1u << first.x);
  const gpu::Brick& voxels = bricks_[slot];
  for (std::int32_t z = first.z; z <= last.z; ++z)
    for (std::int32_t y = first.y; y <= last.y; ++y) {
      const std::uint32_t word = static_cast<std::uint32_t>(y >> 2 | z << 1),
                          shift = static_cast<std::uint32_t>(y & 3) * 8;
      const std::uint32_t boundary = voxels.boundary[word];
      for (std::uint32_t row = (boundary | voxels.internal_[word]) >> shift & along_x; row != 0;
           row &= row - 1) {
        const auto x = static_cast<std::int32_t>(std::countr_zero(row));
        const std::uint32_t bit = 1u << (static_cast<std::uint32_t>(x) + shift);
        if (off_plane(triangle, origin + Int3(x, y, z) * size, size)) continue;
        const bool listed = (boundary & bit) != 0;
        const std::uint32_t number =
            listed ? voxels.first[word] + static_cast<std::uint32_t>(std::popcount(boundary & (bit - 1)))
                   : gpu::kNoVoxel;
        const Int3 voxel = 8 * brick + Int3(x, y, z);
        if (!lists.push(lists.touch, kCandidateTouch,
                        {triangle.place, number, voxel.x | voxel.y << 16, voxel.z}))
          return false;
        if (listed && !take_list(triangle, voxel, number, seen, lists)) return false;
      }
    }
  return true;
}

}  // namespace palpate
