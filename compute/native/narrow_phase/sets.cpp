#include "compute/native/narrow_phase/sets.h"

#include <algorithm>
#include <glm/common.hpp>
#include <glm/vector_relational.hpp>

#include "compute/native/narrow_phase/crossing.h"
#include "compute/native/processor.h"

namespace palpate {

using namespace gpu;  // names of shaders/shared/frame.h

namespace {

constexpr std::uint32_t kOpenPart = 256;  // open samples that one thread takes at a time: some 50 us (chosen)
constexpr std::size_t kPairPart = 512;    // likewise of pairs
constexpr std::size_t kTouchPart = 512;   // likewise of voxels that may be touched: some 20 us
/// A moved triangle meets a moved segment only where, in the tool's own frame, they come this near, in steps:
/// the segment's ends are off by 2.4 an axis, for the way to the tool and back is rounded twice and the
/// matrix once, the corners by half; 5.1 in all (derived).
constexpr std::int32_t kWalkSlack = 8;
constexpr std::size_t kAhead =
    4;  // voxels whose lists are called for before their turn: they lie far apart (chosen)

std::uint32_t parts_of(std::size_t count, std::size_t part) {
  return static_cast<std::uint32_t>((count + part - 1) / part);
}

template <class T>
std::span<const T> piece(std::span<const T> all, std::size_t part, std::size_t size) {
  return all.subspan(part * size, std::min(size, all.size() - part * size));
}

}  // namespace

ContactSets ContactSets::make(const SceneGeometry& geometry, const SceneTables& scene,
                              std::span<const std::uint32_t> order, InsideSearch& in_tool) {
  ContactSets out;
  out.geometry_ = &geometry;
  out.in_tool_ = &in_tool;
  out.order_ = order;
  out.mockup_ = PartitionLookup(scene.mockup);
  out.fine_ = PartitionLookup(scene.fine);
  out.fine_exit_ = scene.fine_exit;
  for (Lane& lane : out.lanes_) lane.touched.resize(scene.mockup.grid.boundary_voxels);
  out.statics_.resize(geometry.mockup.triangles.size());
  out.mobiles_.resize(order.size());
  out.cells_ = CellMemo(scene.fine.grid.boundary_voxels);
  return out;
}

std::uint64_t ContactSets::bytes() const {
  std::uint64_t sum = cells_.bytes() + statics_.bytes() + mobiles_.bytes();
  for (const Lane& lane : lanes_)
    sum += bytes_of(lane.pairs) + bytes_of(lane.open) + bytes_of(lane.points) + bytes_of(lane.inside) +
           bytes_of(lane.near) + bytes_of(lane.mobiles) + bytes_of(lane.touched_voxels) +
           bytes_of(lane.touched);
  return sum;
}

/// The tool lattice point of a world lattice point (section 4). |p − translation| < 2^31: sums within 3 ·
/// 2^61.
Int3 ContactSets::tool_point(const LatticePose& pose, const Int3& point) const {
  Int3 at;
  for (int c = 0; c < 3; ++c) {
    std::int64_t sum = std::int64_t{1} << 29;
    for (int r = 0; r < 3; ++r)
      sum += pose.rotation_q30[r][c] * (std::int64_t{point[r]} - pose.translation[r]);
    at[c] = static_cast<std::int32_t>(sum >> 30);
  }
  return at;
}

/// Whether a point of the tool's lattice is beyond a closed tool's box, where its winding is 0. A voxel much
/// larger than the tool lists points far from it.
bool ContactSets::off(const Int3& at) const {
  return glm::any(glm::lessThan(at, geometry_->tool.box_min - kWalkSlack)) ||
         glm::any(glm::greaterThan(at, geometry_->tool.box_max + kWalkSlack));
}

/// Whether a world lattice point lies inside the tool.
bool ContactSets::inside(const LatticePose& pose, const Int3& point) const {
  const Int3 at = tool_point(pose, point);
  if (!geometry_->tool.closed) return in_tool_->inside(at);
  if (off(at)) return false;
  const std::uint32_t kind = fine_.at(fine_.voxel_of(at)).kind;
  return kind == kVoxelInternal || (kind == kVoxelBoundary && walks_out(pose, point));
}

/// Samples and first corners of listed triangles in a voxel, where preparation has not listed them.
template <class Take>
void ContactSets::scan(const SampleChunk& chunk, Take&& take) const {
  const LatticeMesh& mesh = geometry_->mockup;
  const Int3 low = mockup_.grid().origin + mockup_.grid().size * chunk.voxel,
             high = low + mockup_.grid().size - 1;  // half-open
  for (std::uint32_t i = chunk.begin; i < chunk.end; ++i) {
    const std::uint32_t id = mockup_.listed(i);
    const exact::Corners t{mesh.corner(id, 0), mesh.corner(id, 1), mesh.corner(id, 2)};
    if (t[0] == glm::clamp(t[0], low, high)) take(FrameSample{t[0], id | kCornerProbe});
    exact::for_samples(t, mesh.sample_axis[id], geometry_->sample_spacing, low, high,
                       [&](const Int3& p, std::int64_t, std::int64_t) {
                         take(FrameSample{p, id});
                       });
  }
}

/// The cells of open points. Point by point the way from voxel to list, triangles and sides is one long chain
/// of loads, and what is decided at its end keeps the processor from the next point; step by step all points'
/// loads run side by side.
void ContactSets::find_cells(const LatticePose& pose, std::span<const FrameSample> samples,
                             std::vector<OpenPoint>& all) const {
  // From a plane, in steps: roundings and the rounded matrix come to less than 2.5, the rounded normal to
  // less than 0.8 (derived).
  constexpr std::int64_t kFar = std::int64_t{4} << 30;
  const LatticeMesh& mesh = geometry_->tool;
  all.clear();
  for (std::uint32_t i = 0; i < samples.size(); ++i) {
    if (i != 0 && samples[i].point == samples[i - 1].point) continue;
    const Int3 at = tool_point(pose, samples[i].point);
    all.push_back({i, at, fine_.at(fine_.voxel_of(at)).boundary, {}, 0, false});
  }
  for (OpenPoint& open : all) {
    open.list = fine_.list(open.voxel);
    __builtin_prefetch(open.list.data());
  }
  for (OpenPoint& open : all) {
    std::uint32_t sides = 0;
    bool far = open.list.size() <= CellMemo::kMostPlanes;
    for (const std::uint32_t id : open.list) {
      const Int3 &n = mesh.unit_normal_q30[id], from = open.at - mesh.corner(id, 0);
      const std::int64_t height = std::int64_t{n.x} * from.x + std::int64_t{n.y} * from.y +
                                  std::int64_t{n.z} * from.z;  // within 2^62
      sides = sides << 1 | static_cast<std::uint32_t>(height > 0);
      far = far & (std::abs(height) > kFar);
    }
    open.sides = sides;
    open.in_cell = far;
    cells_.prefetch(open.voxel, sides);
  }
}

/// Whether the winding at an open sample is not 0. In the tool's frame the planes of all that the sample's
/// voxel lists divide the voxel into convex cells that nothing passes through, so that all samples of a cell
/// have one answer, at every pose (docs/EXACTNESS.md, section 9).
bool ContactSets::open_inside(const LatticePose& pose, const Int3& point, const OpenPoint& open) {
  if (!open.in_cell) return walks_out(pose, point);
  if (const std::optional<bool> answer = cells_.find(open.voxel, open.sides)) return *answer;
  const bool answer = walks_out(pose, point);
  cells_.keep(open.voxel, open.sides, answer);
  return answer;
}

/// The same by a walk: the winding is what a walk out of the tool crosses, along an axis of its fine grid.
/// shaders/frame/sample_walk.comp has the proof that each voxel on the way lists all that is crossed in it.
/// Moves what it meets itself, for the threads of a frame can't share moved triangles.
bool ContactSets::walks_out(const LatticePose& pose, const Int3& point) const {
  const LatticeMesh& mesh = geometry_->tool;
  Int3 from = point, at = tool_point(pose, point);
  Int3 voxel = fine_.voxel_of(at);
  PartitionLookup::Voxel here = fine_.at(voxel);
  const std::uint32_t exit = fine_exit_[here.boundary];
  const int axis = static_cast<int>(exit >> 1), up = static_cast<int>(exit & 1);
  int winding = 0;
  do {
    Int3 low = at, high = at;
    at[axis] = fine_.grid().origin[axis] + fine_.grid().size * (voxel[axis] + up);
    low = glm::min(low, at) - kWalkSlack;
    high = glm::max(high, at) + kWalkSlack;
    const Int3 to = transform(pose, at);
    if (here.boundary != kNoVoxel && from != to)
      for (const std::uint32_t id : fine_.list(here.boundary)) {
        const exact::Corners own{mesh.corner(id, 0), mesh.corner(id, 1), mesh.corner(id, 2)};
        const exact::Box box = exact::box_of(own);
        if (glm::any(glm::greaterThan(box.low, high)) || glm::any(glm::lessThan(box.high, low))) continue;
        winding += segment_crossing(
            from, to, {transform(pose, own[0]), transform(pose, own[1]), transform(pose, own[2])});
      }
    from = to;
    voxel[axis] += 2 * up - 1;
    here = fine_.at(voxel);
  } while (here.kind != kVoxelExternal);
  return winding != 0;
}

/// EST of open samples.
void ContactSets::decide_open(const LatticePose& pose, std::span<const FrameSample> samples, Lane& lane) {
  if (!geometry_->tool.closed) {
    static_assert(kOpenPart <= InsideSearch::kMostPoints);
    std::array<std::uint8_t, kOpenPart> inside;
    lane.points.clear();  // each once: those at one place follow each other
    for (std::size_t i = 0; i < samples.size(); ++i)
      if (i == 0 || samples[i].point != samples[i - 1].point)
        lane.points.push_back(tool_point(pose, samples[i].point));
    in_tool_->inside(lane.points, inside);
    std::size_t at = 0;
    for (std::size_t i = 0; i < samples.size(); ++i) {
      if (i != 0 && samples[i].point != samples[i - 1].point) ++at;
      if (inside[at] != 0) lane.inside.push_back(samples[i]);
    }
    return;
  }
  on_this_processor([&] { find_cells(pose, samples, lane.open); });
  for (std::size_t i = 0; i < lane.open.size(); ++i) {
    const std::size_t first = lane.open[i].first,
                      end = i + 1 < lane.open.size() ? lane.open[i + 1].first : samples.size();
    if (!open_inside(pose, samples[first].point, lane.open[i])) continue;
    for (std::size_t j = first; j < end; ++j) lane.inside.push_back(samples[j]);
  }
}

std::array<Int3, 2> ContactSets::reach(const LatticePose& pose) const {
  std::array<Int3, 2> out{Int3(INT32_MIN), Int3(INT32_MAX)};
  if (!geometry_->tool.closed) return out;  // V_int voxels may stand out of its triangles' box
  const std::array<Int3, 2> own{geometry_->tool.box_min - kWalkSlack, geometry_->tool.box_max + kWalkSlack};
  std::swap(out[0], out[1]);
  for (std::size_t corner = 0; corner < 8; ++corner) {
    const Int3 p = transform(pose, Int3(own[corner & 1].x, own[corner >> 1 & 1].y, own[corner >> 2].z));
    out[0] = glm::min(out[0], p - kWalkSlack);
    out[1] = glm::max(out[1], p + kWalkSlack);
  }
  return out;
}

std::span<const FrameSample> ContactSets::inside_of(const LatticePose& pose,
                                                    std::span<const FrameSample> samples, int number) {
  Lane& lane = lanes_[static_cast<std::size_t>(number)];
  lane.inside.clear();
  if (geometry_->tool.closed) {
    lane.near.clear();
    for (const FrameSample& sample : samples) {
      const Int3 at = tool_point(pose, sample.point);
      if (off(at)) continue;
      const std::uint32_t kind = fine_.at(fine_.voxel_of(at)).kind;
      if (kind == kVoxelInternal)
        lane.inside.push_back(sample);
      else if (kind == kVoxelBoundary)
        lane.near.push_back(sample);
    }
    samples = lane.near;
  }
  for (std::uint32_t part = 0; part < parts_of(samples.size(), kOpenPart); ++part)
    decide_open(pose, piece(samples, part, kOpenPart), lane);
  return lane.inside;
}

/// Pairs that meet. The search has moved their tool triangles.
void ContactSets::decide_pairs(const PosedTool& tool, std::span<const PairCandidate> candidates,
                               Lane& found) const {
  const LatticeMesh& mockup = geometry_->mockup;
  std::array<PairFilter::Verdict, PairFilter::kLanes> verdicts{};
  for (std::size_t begin = 0; begin < candidates.size(); begin += PairFilter::kLanes) {
    for (std::size_t i = begin + 2 * PairFilter::kLanes;
         i < std::min(begin + 3 * PairFilter::kLanes, candidates.size()); ++i)
      __builtin_prefetch(&mockup.triangles[candidates[i].static_id]);
    for (std::size_t i = begin + PairFilter::kLanes;
         i < std::min(begin + 2 * PairFilter::kLanes, candidates.size()); ++i)
      for (const std::uint32_t vertex : mockup.triangles[candidates[i].static_id])
        __builtin_prefetch(&mockup.vertices[vertex]);
    const std::span<const PairCandidate> now =
        candidates.subspan(begin, std::min(PairFilter::kLanes, candidates.size() - begin));
    for (std::size_t lane = 0; lane < now.size(); ++lane) {
      const std::uint32_t s = now[lane].static_id;
      found.filter.put(lane, {mockup.corner(s, 0), mockup.corner(s, 1), mockup.corner(s, 2)},
                       tool.moved(order_[now[lane].place]));
    }
    found.filter.judge(verdicts);
    for (std::size_t lane = 0; lane < now.size(); ++lane) {
      if (verdicts[lane] == PairFilter::kApart) continue;
      const std::uint32_t s = now[lane].static_id;
      if (verdicts[lane] == PairFilter::kUnknown) {
        const exact::Corners& t = tool.moved(order_[now[lane].place]);
        if (!exact::triangles_meet({mockup.corner(s, 0), mockup.corner(s, 1), mockup.corner(s, 2)}, t,
                                   exact::raw_normal(t)))
          continue;
      }
      found.pairs.push_back(now[lane]);
    }
  }
}

/// Voxels that tool triangles touch: IMT, BMT, and those whose lists are BST. What would tell this part or
/// thread nothing new is not asked. The search has moved the triangles.
void ContactSets::decide_voxels(const PosedTool& tool, std::span<const TouchCandidate> candidates,
                                Lane& lane) const {
  const GridConstants& grid = mockup_.grid();
  std::uint32_t place = kNone, marks = 0;   // candidates of one tool triangle follow each other
  const exact::Corners* corners = nullptr;  // of this triangle, once they are asked for
  exact::Box box{};
  for (const TouchCandidate& candidate : candidates) {
    if (candidate.place != place) {
      place = candidate.place;
      marks = mobiles_.marks(place);
      corners = nullptr;
    }
    // CMT outdoes IMT, and that BMT.
    const bool internal = candidate.boundary == kNoVoxel;
    const std::uint32_t outdone_by =
        internal ? kMobileHit | kMobileInternal : kMobileHit | kMobileInternal | kMobileBoundary;
    if ((marks & outdone_by) != 0 && (internal || lane.touched[candidate.boundary] != 0)) continue;
    if (corners == nullptr) {
      corners = &tool.moved(order_[place]);
      box = exact::box_of(*corners);
    }
    const Int3 voxel(candidate.xy & 0xFFFF, candidate.xy >> 16, candidate.z & ~kWholeBrick);
    const std::int32_t side = (candidate.z & kWholeBrick) != 0 ? 8 * grid.size : grid.size;
    if (!exact::triangle_touches_cube(*corners, box, grid.origin + grid.size * voxel, side)) continue;
    const std::uint32_t mark = internal ? kMobileInternal : kMobileBoundary;
    if ((marks & mark) == 0) lane.mobiles.push_back({place, mark});
    marks |= mark;
    if (internal || lane.touched[candidate.boundary] != 0) continue;
    lane.touched_voxels.push_back(candidate.boundary);
    lane.touched[candidate.boundary] = 1;
  }
}

/// BST: what touched voxels list. Afterwards none is touched.
void ContactSets::mark_lists(Lane& lane) {
  const std::vector<std::uint32_t>& voxels = lane.touched_voxels;
  for (std::size_t i = 0; i < voxels.size(); ++i) {
    if (i + kAhead < voxels.size()) __builtin_prefetch(mockup_.list(voxels[i + kAhead]).data());
    for (const std::uint32_t id : mockup_.list(voxels[i])) statics_.add(id, kStaticListed);
  }
  lane.untouch();
}

/// C_s and C_m, and how many there are of CST, EST and the tool's sets.
void ContactSets::list(FoundSets& out) {
  FrameState& state = out.state;
  statics_.take_all([&](std::uint32_t id, std::uint32_t marks) {
    const bool hit = (marks & kStaticHit) != 0;
    state.cst += hit ? 1u : 0u;
    state.est += !hit && (marks & kStaticSampled) != 0 ? 1u : 0u;
    out.statics.push_back({id, marks, kNone, kNone});
  });
  mobiles_.take_all([&](std::uint32_t place, std::uint32_t marks) {
    ((marks & kMobileHit) != 0 ? state.cmt : (marks & kMobileInternal) != 0 ? state.imt : state.bmt) += 1;
    out.mobiles.push_back({order_[place], marks});
  });
}

void ContactSets::decide(const PosedTool& tool, const Candidates& near, FrameHelper* helper, FoundSets& out) {
  out.state = {};
  out.statics.clear();
  out.mobiles.clear();
  out.samples.clear();
  out.pairs.clear();
  // Of a frame that ended for want of memory: others leave nothing marked or touched.
  statics_.clear();
  mobiles_.clear();
  for (Lane& lane : lanes_) {
    lane.pairs.clear();
    lane.inside.clear();
    lane.mobiles.clear();
    lane.untouch();
  }
  const auto lane_of = [&](int lane) -> Lane& { return lanes_[static_cast<std::size_t>(lane)]; };

  const std::span<const PairCandidate> candidates = near.pairs.room.first(near.pairs.count);
  share_parts(helper, parts_of(candidates.size(), kPairPart), [&](std::uint32_t part, int lane) {
    decide_pairs(tool, piece(candidates, part, kPairPart), lane_of(lane));
  });
  // CST and CMT.
  for (const Lane& lane : lanes_)
    for (const PairCandidate& pair : lane.pairs) {
      out.pairs.push_back({pair.static_id, order_[pair.place]});
      statics_.add(pair.static_id, kStaticHit);
      mobiles_.add(pair.place, kMobileHit);
    }

  // Samples inside the tool: EST. A first corner tells EST and does not count.
  const auto take = [&](const FrameSample& sample) {
    statics_.add(sample.static_id & ~kCornerProbe, kStaticSampled);
    if ((sample.static_id & kCornerProbe) == 0) out.samples.push_back(sample);
  };
  const std::span<const FrameSample> open = near.open.room.first(near.open.count);
  const std::span<const TouchCandidate> touch = near.touch.room.first(near.touch.count);
  const std::uint32_t of_touch = parts_of(touch.size(), kTouchPart);
  share_parts(helper, 1 + of_touch + parts_of(open.size(), kOpenPart), [&](std::uint32_t part, int lane) {
    if (part == 0)
      for (const FrameSample& sample : near.inside.room.first(near.inside.count)) take(sample);
    else if (part <= of_touch)
      decide_voxels(tool, piece(touch, part - 1, kTouchPart), lane_of(lane));
    else
      decide_open(tool.pose(), piece(open, part - 1 - of_touch, kOpenPart), lane_of(lane));
  });
  // IMT, BMT, BST and the rest of EST.
  for (Lane& lane : lanes_) {
    for (const TouchingPlace& mobile : lane.mobiles) mobiles_.add(mobile.place, mobile.mark);
    mark_lists(lane);
    for (const FrameSample& sample : lane.inside) take(sample);
  }
  for (const std::uint32_t run : near.swallowed.room.first(near.swallowed.count))
    for (std::uint32_t place = kRunSize * run;
         place < std::min<std::size_t>(kRunSize * (run + 1), order_.size()); ++place)
      mobiles_.add(place, kMobileInternal);
  for (const SampleChunk& chunk : near.samples.room.first(near.samples.count))
    scan(chunk, [&](const FrameSample& sample) {
      if (inside(tool.pose(), sample.point)) take(sample);
    });

  list(out);
  out.state.contact = out.state.cst + out.state.imt + out.state.est != 0 ? 1 : 0;
}

}  // namespace palpate
