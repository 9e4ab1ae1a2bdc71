#include "compute/native/broad_phase/broad_phase.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include "compute/native/processor.h"
#include "compute/scene/search_tables.h"
#include "model/bytes_of.h"

namespace palpate {
namespace {

constexpr std::size_t kMostGroups = 256;  // into which the tool is divided for two threads (chosen)
constexpr std::int32_t kManyBricks =
    3;  // along an axis, beyond which bricks are asked and not voxels (chosen)

// Transformed vertices are rounded by half a step an axis, and doubles by far less than a thousandth: two
// steps hold both, and voxels are closed.
constexpr double kMargin = gpu::kCloseSteps + 2.0;

static_assert(gpu::kRunSize == kEight);

/// Whether a triangle stays one at every pose. A pose is a rounded matrix, which turns the product of two
/// edges as a whole, and then half a step a corner: an edge is off by at most a step an axis. So a component
/// of the product is off by less than √3 of the edges' sizes together, and 2; turned, its largest component
/// is no less than 1/√3 of the largest there was. Doubles round by far less than what the factor 4 leaves.
bool is_stout(const LatticeMesh& mesh, std::uint32_t id) {
  double edge[2][3], size[2] = {};
  for (std::size_t e = 0; e < 2; ++e)
    for (std::size_t k = 0; k < 3; ++k) {
      const int axis = static_cast<int>(k);
      edge[e][k] = static_cast<double>(mesh.corner(id, e == 0 ? 1 : 2)[axis]) - mesh.corner(id, 0)[axis];
      size[e] += std::abs(edge[e][k]);
    }
  double largest = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t l = (k + 1) % 3, m = (k + 2) % 3;
    largest = std::max(largest, std::abs(edge[0][l] * edge[1][m] - edge[0][m] * edge[1][l]));
  }
  return largest > 4 * (size[0] + size[1]) + 8;
}

}  // namespace

/// A pose in doubles. Its products are within 2^29 and off by less than 2^-20.
struct BroadPhase::Turn {
  explicit Turn(const LatticePose& pose) {
    for (std::size_t r = 0; r < 3; ++r) {
      for (std::size_t c = 0; c < 3; ++c) {
        rotation[r][c] = pose.rotation_q30[r][c] * 0x1p-30;
        size[r][c] = std::abs(rotation[r][c]);
      }
      translation[r] = pose.translation[static_cast<int>(r)];
    }
  }
  double rotation[3][3], size[3][3], translation[3];
};

struct BroadPhase::Search {
  PosedTool& tool;
  VoxelTurn voxels;
};

BroadPhase BroadPhase::make(const SceneGeometry& geometry, const SceneTables& scene, const RunTree& runs) {
  BroadPhase out;
  out.tree_ = &runs;
  out.order_ = runs.order();
  out.has_inside_ = scene.constants.refined != 0 && scene.constants.tool_has_inside != 0;
  out.always_samples_ = out.has_inside_ && scene.constants.tool.closed == 0;
  out.pairs_ = CandidatePairs::make(scene);
  out.seen_[0].resize(geometry.mockup.triangles.size());
  out.statics_ = geometry.mockup.triangles.size();
  if (out.has_inside_) out.samples_ = CandidateSamples::make(geometry, scene);
  out.inside_margin_ = 1.75 * geometry.tool_grid.size + 16;  // a grown voxel's diagonal
  out.make_runs(geometry.tool);
  out.tool_radius_ = geometry.tool_radius;
  out.make_occupancy(scene.mockup);
  out.parts_ = scene.search->parts;
  return out;
}

void BroadPhase::make_runs(const LatticeMesh& tool) {
  runs_.resize((order_.size() + kEight - 1) / kEight);
  stout_.assign(runs_.size(), 1);
  for (EightTriangles& run : runs_)
    for (auto& coordinate : run) coordinate.fill(kNowhere);
  Int3 low(INT32_MAX), high(INT32_MIN);
  for (std::size_t place = 0; place < order_.size(); ++place) {
    if (tool.collapsed(order_[place]) || !is_stout(tool, order_[place])) stout_[place / kEight] = 0;
    if (tool.collapsed(order_[place])) continue;
    for (int corner = 0; corner < 3; ++corner) {
      const Int3 p = tool.corner(order_[place], corner);
      low = glm::min(low, p);
      high = glm::max(high, p);
      for (int k = 0; k < 3; ++k)
        runs_[place / kEight][static_cast<std::size_t>(3 * corner + k)][place % kEight] =
            static_cast<float>(p[k]);
    }
  }
  for (std::size_t k = 0; k < 3; ++k) {
    const double l = low[static_cast<int>(k)], h = high[static_cast<int>(k)];
    whole_.centre[k] = (l + h) / 2;
    whole_.half[k] = (h - l) / 2;  // below 0: no triangle is left
  }
}

void BroadPhase::make_occupancy(const PartitionView& mockup) {
  grid_ = mockup.grid;
  per_voxel_ = 1.0 / grid_.size;
  occupied_.emplace_back().make(mockup, BrickBits::Of::kOccupied);
  cubes_.make(occupied_.front());
  while (std::max({occupied_.back().size().x, occupied_.back().size().y, occupied_.back().size().z}) >
         kManyBricks)
    occupied_.push_back(occupied_.back().coarser());
}

BroadPhase::Reach BroadPhase::reach(const Turn& turn, const Box& box) const {
  Reach out;
  for (std::size_t r = 0; r < 3; ++r) {
    const double centre = turn.rotation[r][0] * box.centre[0] + turn.rotation[r][1] * box.centre[1] +
                          turn.rotation[r][2] * box.centre[2] + turn.translation[r];
    const double half = turn.size[r][0] * box.half[0] + turn.size[r][1] * box.half[1] +
                        turn.size[r][2] * box.half[2] + kMargin;
    out.low[r] = centre - half;
    out.high[r] = centre + half;
  }
  return out;
}

bool BroadPhase::meets(const Reach& reach) const {
  BrickBits::Range voxels{};
  for (std::size_t k = 0; k < 3; ++k) {
    const int axis = static_cast<int>(k);
    const double end = grid_.bricks[axis] * 8;
    const double low = (reach.low[k] - grid_.origin[axis]) * per_voxel_,
                 high = (reach.high[k] - grid_.origin[axis]) * per_voxel_;
    if (high < 0 || low >= end) return false;
    voxels.first[k] = static_cast<std::int32_t>(std::max(low, 0.0));  // rounded down
    voxels.last[k] = static_cast<std::int32_t>(std::min(high, end - 1));
  }
  return meets(voxels);
}

/// Whether any of the voxels is occupied; of many voxels, whether any of their bricks has one.
bool BroadPhase::meets(BrickBits::Range voxels) const {
  std::size_t level = 0;
  const auto many = [&](std::size_t k) {
    return (voxels.last[k] >> 3) - (voxels.first[k] >> 3) >= kManyBricks;
  };
  while (level + 1 < occupied_.size() && (many(0) || many(1) || many(2))) {
    for (std::size_t k = 0; k < 3; ++k) {
      voxels.first[k] >>= 3;
      voxels.last[k] >>= 3;
    }
    ++level;
  }
  return occupied_[level].for_bricks(voxels, [](std::int32_t, std::int32_t, std::int32_t) { return true; });
}

void BroadPhase::share() {
  for (CandidatePairs::Seen& seen : seen_) seen.resize(statics_);
}

std::uint64_t BroadPhase::bytes() const {
  std::uint64_t sum = bytes_of(second_touch_) + bytes_of(second_pairs_) + bytes_of(second_swallowed_) +
                      samples_.bytes() + bytes_of(runs_) + bytes_of(stout_) + bytes_of(occupied_) +
                      cubes_.bytes();
  for (const CandidatePairs::Seen& seen : seen_) sum += seen.bytes();
  for (const BrickBits& level : occupied_) sum += level.bytes();
  return sum;
}

/// A bit each: which of eight ranges of voxels have one that is occupied.
unsigned BroadPhase::occupied(const EightRanges& voxels) const {
  unsigned out = 0;
  for (unsigned near = cubes_.near(voxels); near != 0; near &= near - 1)
    if (const int i = std::countr_zero(near); meets(voxels.range(static_cast<std::size_t>(i))))
      out |= 1u << i;
  return out;
}

/// Whether all of the voxels lie in bricks that are V_int. What reaches out of the grid has been clipped to
/// bricks at its border, which never are.
bool BroadPhase::all_internal(const BrickBits::Range& voxels) const {
  const BrickBits& occupied = occupied_.front();
  for (std::int32_t z = voxels.first[2] >> 3; z <= voxels.last[2] >> 3; ++z)
    for (std::int32_t y = voxels.first[1] >> 3; y <= voxels.last[1] >> 3; ++y)
      for (std::int32_t x = voxels.first[0] >> 3; x <= voxels.last[0] >> 3; ++x)
        if (occupied.slot(occupied.number(x, y, z)) != gpu::kBrickInternal) return false;
  return true;
}

/// From some nodes of the tool's tree to runs of triangles.
void BroadPhase::descend(const Search& search, const RunTree::Group& from, CandidatePairs::Seen& seen,
                         Candidates& lists) const {
  on_this_processor([&] {
    tree_->descend(
        search.voxels, from, [&](const EightRanges& voxels) { return occupied(voxels); },
        [&](std::uint32_t run) { return take_run(search, run, seen, lists); },
        [&](const BrickBits::Range& voxels) { return all_internal(voxels); },
        [&](std::size_t first, std::size_t end) {
          for (std::size_t run = first; run < end; ++run)
            if (stout_[run] != 0
                    ? !lists.push(lists.swallowed, kCandidateSwallowed, static_cast<std::uint32_t>(run))
                    : !take_run(search, run, seen, lists))
              return false;
          seen.looks += end - first;
          return true;
        });
  });
}

/// The triangles of a run, each by the box of its corners. False: a list had no room.
bool BroadPhase::take_run(const Search& search, std::size_t run, CandidatePairs::Seen& seen,
                          Candidates& lists) const {
  const BrickBits& occupied = occupied_.front();
  EightRanges voxels;
  voxels_of(search.voxels, runs_[run], voxels);
  for (unsigned near = cubes_.near(voxels); near != 0; near &= near - 1) {
    const auto i = static_cast<std::size_t>(std::countr_zero(near));
    const auto place = static_cast<std::uint32_t>(run * gpu::kRunSize + i);
    bool begun = false;
    CandidatePairs::Triangle triangle;
    occupied.for_bricks(voxels.range(i), [&](std::int32_t x, std::int32_t y, std::int32_t z) {
      const Int3 brick(x, y, z);
      const std::uint32_t slot = occupied.slot(occupied.number(x, y, z));
      if (!begun && !pairs_.begin(search.tool.corners(order_[place]), place, voxels, i, seen, triangle))
        return true;
      begun = true;
      return !pairs_.take(triangle, brick, slot, seen, lists);
    });
    if (lists.full != gpu::kNone) return false;
  }
  return true;
}

namespace {

/// Puts what `more` holds behind what `list` holds. False: there is no room.
template <class T>
bool append(WorkList<T>& list, const WorkList<T>& more) {
  if (more.count > list.room.size() - list.count) return false;
  std::copy_n(more.room.begin(), more.count, list.room.begin() + list.count);
  list.count += more.count;
  return true;
}

}  // namespace

/// Pairs in parts beside each other, and samples, too, where `samples_of` is not null.
void BroadPhase::find_beside(const Search& search, const Reach* samples_of, FrameHelper& helper,
                             Candidates& lists) {
  std::array<RunTree::Group, kMostGroups> groups;
  const std::size_t count = tree_->divide(
      search.voxels, [&](const EightRanges& voxels) { return occupied(voxels); }, groups);
  if (second_touch_.size() != lists.touch.room.size())
    second_touch_.resize(lists.touch.room.size());  // at first, and when the lists have been enlarged
  if (second_pairs_.size() != lists.pairs.room.size()) second_pairs_.resize(lists.pairs.room.size());
  if (second_swallowed_.size() != lists.swallowed.room.size())
    second_swallowed_.resize(lists.swallowed.room.size());
  alignas(kOwnLines) Candidates samples = lists;
  alignas(kOwnLines) Candidates second{.touch = {second_touch_},
                                       .pairs = {second_pairs_},
                                       .swallowed = {second_swallowed_},
                                       .samples = {},
                                       .inside = {},
                                       .open = {}};
  const std::uint32_t ahead = samples_of != nullptr ? 1 : 0;
  share_parts(&helper, static_cast<std::uint32_t>(count) + ahead, [&](std::uint32_t part, int lane) {
    if (part < ahead)
      find_samples(search.tool.pose(), *samples_of, samples);
    else
      descend(search, groups[part - ahead], seen_[static_cast<std::size_t>(lane)],
              lane == 0 ? lists : second);
  });
  if (lists.full == gpu::kNone) lists.full = second.full;
  if (lists.full == gpu::kNone && !append(lists.touch, second.touch)) lists.full = kCandidateTouch;
  if (lists.full == gpu::kNone && !append(lists.pairs, second.pairs)) lists.full = kCandidatePairs;
  if (lists.full == gpu::kNone && !append(lists.swallowed, second.swallowed))
    lists.full = kCandidateSwallowed;
  if (ahead == 0) return;
  lists.samples = samples.samples;
  lists.inside = samples.inside;
  lists.open = samples.open;
  if (lists.full == gpu::kNone) lists.full = samples.full;
}

void BroadPhase::find_samples(const LatticePose& pose, const Reach& whole, Candidates& lists) const {
  // The tool's inside reaches beyond its triangles by less than a grown voxel of its partition (EXACTNESS.md,
  // section 2).
  const double margin = inside_margin_, brick = 8.0 * grid_.size;
  Int3 first, last;
  for (std::size_t k = 0; k < 3; ++k) {
    const int axis = static_cast<int>(k);
    const double low = (whole.low[k] - margin - grid_.origin[axis]) / brick,
                 high = (whole.high[k] + margin - grid_.origin[axis]) / brick;
    if (high < 0 || low >= grid_.bricks[axis]) return;
    first[axis] = static_cast<std::int32_t>(std::max(low, 0.0));
    last[axis] = static_cast<std::int32_t>(std::min(high, grid_.bricks[axis] - 1.0));
  }
  samples_.find(pose, first, last, lists);
}

void BroadPhase::find(PosedTool& tool, FrameHelper* helper, Candidates& lists) {
  search_all(tool, helper, lists);
  looks_ = lists.samples.count + lists.inside.count + lists.open.count;
  for (CandidatePairs::Seen& seen : seen_) looks_ += std::exchange(seen.looks, 0);
}

void BroadPhase::search_all(PosedTool& tool, FrameHelper* helper, Candidates& lists) {
  const LatticePose& pose = tool.pose();
  if (whole_.half[0] < 0) return;
  const Turn turn(pose);
  const Reach whole = reach(turn, whole_);
  if (!meets(whole) && !always_samples_) return;
  Search search{tool, {}};
  for (std::size_t r = 0; r < 3; ++r) {
    for (std::size_t c = 0; c < 3; ++c)
      search.voxels.rotation[r][c] = static_cast<float>(turn.rotation[r][c] * per_voxel_);
    // Coordinates and entries rounded to 24 bits, three products, their sum, a box's half besides its centre,
    // and the sum with the place: below 16 · 2^-24 of the tool's radius and the place, in voxels.
    const double at = (turn.translation[r] - grid_.origin[static_cast<int>(r)]) * per_voxel_;
    const double margin = kMargin * per_voxel_ + (std::abs(at) + tool_radius_ * per_voxel_) * 0x1p-20;
    search.voxels.below[r] = static_cast<float>(at - margin);
    search.voxels.above[r] = static_cast<float>(at + margin);
    search.voxels.end[r] = static_cast<float>(8 * grid_.bricks[static_cast<int>(r)]);
  }
  // Where the last pose wanted samples this one mostly does, too: they are looked for beside the pairs.
  const bool ahead = helper != nullptr && has_inside_ && met_;
  if (helper != nullptr)
    find_beside(search, ahead ? &whole : nullptr, *helper, lists);
  else
    descend(search, tree_->root(), seen_[0], lists);
  if (lists.full != gpu::kNone || !has_inside_) return;
  bool meet = always_samples_ || lists.pairs.count != 0;
  // A whole connected part of the mock-up may lie inside the tool.
  for (std::size_t i = 0; i < parts_.size() && !meet; ++i) {
    const auto& part = parts_[i];
    meet = part[0] >= whole.low[0] && part[1] >= whole.low[1] && part[2] >= whole.low[2] &&
           part[3] <= whole.high[0] && part[4] <= whole.high[1] && part[5] <= whole.high[2];
  }
  met_ = meet;
  if (ahead && !meet) lists.samples.count = lists.inside.count = lists.open.count = 0;
  if (meet && !ahead) find_samples(pose, whole, lists);
}

}  // namespace palpate
