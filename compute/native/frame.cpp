#include "compute/native/frame.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "compute/scene/tool_order.h"
#include "model/bytes_of.h"
#include "model/contact/contact_areas.h"

namespace palpate::native {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t kUsualItems =
    1u
    << 14;  // of a list to begin with (chosen: a deep contact of 100,000 by 2,000 triangles takes half of it)

/// Free of contact, but for the times.
void clear(Contacts& out) {
  out.contact = out.truncated = false;
  out.truncated_capacity = "";
  out.pairs = 0;
  for (auto* ids : {&out.cst, &out.bst, &out.est, &out.cmt, &out.bmt, &out.imt, &out.ignored_touched})
    ids->clear();
  out.areas.clear();
  out.flags = 0;
  out.field = {};
  out.carriers.clear();
}

}  // namespace

Frame::Frame(const SceneGeometry& geometry, const SceneTables& scene, const Plan& plan,
             const OpenBodies& open)
    : geometry_(geometry),
      plan_(plan),
      order_(order_in_space(geometry.tool)),
      runs_(geometry.tool, order_),
      posed_(geometry.tool),
      broad_phase_(BroadPhase::make(geometry, scene, runs_)),
      contact_(NarrowPhase::make(geometry, scene, order_, open)),
      flags_(scene.constants.tool_has_inside == 0 ? kFlagToolOpen : 0u),
      touch_(kUsualItems),
      candidate_pairs_(kUsualItems),
      swallowed_(kUsualItems),
      chunks_(kUsualItems),
      inside_(kUsualItems),
      open_(kUsualItems) {
  if (open.tool) broad_phase_.use(open.tool, scene.tool);
}

/// The helper, where one is wanted. Made by who asks first: a thread begins at its maker's priority and on
/// its processors, and a loop's are chosen well.
FrameHelper* Frame::helper() {
  if (!sharing_) return nullptr;
  if (!helper_tried_ && (helper_ = FrameHelper::make())) broad_phase_.share();
  helper_tried_ = true;
  return helper_.get();
}

bool Frame::enlarge(std::uint32_t list) {
  const auto twice = [](auto& room) { room.resize(2 * room.size()); };
  switch (list) {
    case kCandidateTouch:
      twice(touch_);
      return true;
    case kCandidatePairs:
      twice(candidate_pairs_);
      return true;
    case kCandidateSwallowed:
      twice(swallowed_);
      return true;
    case kCandidateChunks:
      twice(chunks_);
      return true;
    case kCandidateInside:
      twice(inside_);
      return true;
    case kCandidateOpen:
      twice(open_);
      return true;
    default:
      return false;
  }
}

/// What is near, with more room where there is too little. Whether anything is.
bool Frame::find(Candidates& near) {
  do {
    near = Candidates{.touch = {touch_},
                      .pairs = {candidate_pairs_},
                      .swallowed = {swallowed_},
                      .samples = {chunks_},
                      .inside = {inside_},
                      .open = {open_}};
    broad_phase_.find(posed_, helper(), near);
  } while (near.full != gpu::kNone && enlarge(near.full));
  return near.touch.count + near.swallowed.count + near.samples.count + near.inside.count + near.open.count !=
         0;  // every pair lies in a voxel that may be touched
}

Result<void> Frame::query(const LatticePose& pose, const Ignored* ignored, Contacts& out) {
  auto last = Clock::now();
  const auto stage = [&](const char* name, std::uint64_t looks) {
    const auto now = Clock::now();
    out.times.push_back({name, std::chrono::duration<double, std::micro>(now - last).count(), looks});
    last = now;
  };
  out.times.clear();
  clear(out);
  out.engine = "cpu";
  solved_ = false;
  out.contact_points = plan_.contact_point;
  out.lists = plan_.telemetry;
  if (pose.beyond_lattice) {
    stage("cull", 0);
    return {};
  }
  out.flags = flags_;
  posed_.begin(pose);
  Candidates near;
  const bool found = find(near);
  stage("cull", broad_phase_.looks());
  if (!found) return {};
  contact_->solve(posed_, ignored, near, helper(), out, stage);
  solved_ = true;
  if (out.contact && out.lists) {
    gather_areas(geometry_, pose, out);
    stage("areas", out.cst.size() + out.est.size());
  }
  return {};
}

std::span<const gpu::ContactPair> Frame::pairs() const {
  if (!solved_) return {};
  return contact_->pairs();
}

std::uint64_t Frame::memory_bytes() const {
  return sizeof *this + bytes_of(order_) + runs_.bytes() + posed_.bytes() + broad_phase_.bytes() +
         contact_->bytes() + bytes_of(touch_) + bytes_of(candidate_pairs_) + bytes_of(swallowed_) +
         bytes_of(chunks_) + bytes_of(inside_) + bytes_of(open_);
}

}  // namespace palpate::native
