#include "service/loop/collision_frame.h"

#include <algorithm>
#include <chrono>
#include <exception>
#include <numeric>
#include <string>
#include <string_view>

namespace palpate {
namespace {

/// Free of contact, keeping the lists' memory.
void clear(Contacts& contacts) {
  contacts.contact = contacts.truncated = false;
  contacts.truncated_capacity = "";
  contacts.pairs = 0;
  for (auto* list :
       {&contacts.cst, &contacts.bst, &contacts.cmt, &contacts.bmt, &contacts.imt, &contacts.est})
    list->clear();
  contacts.areas.clear();
  contacts.flags = 0;
  contacts.field = {};
  contacts.carriers.clear();
  contacts.ignored_touched.clear();
  contacts.times.clear();
  contacts.engine = "";
}

/// What summing the samples took.
double field_us(const Contacts& contacts) {
  double out = 0;
  for (const Contacts::StageTime& time : contacts.times)
    if (std::string_view(time.stage) == "field") out += time.us;
  return out;
}

}  // namespace

CollisionFrame::CollisionFrame(const SceneGeometry& geometry, CollisionBackend& backend, Profile profile,
                               double stiffness, bool torques, PlanSwitch* plans, StartContacts start,
                               double slow_us, double budget_us)
    : geometry_(geometry),
      backend_(&backend),
      plans_(plans),
      profile_(profile),
      stiffness_(stiffness),
      torques_(torques),
      budget_(budget_us),
      slow_us_(slow_us) {
  if (start != StartContacts::kIgnoreInitial) return;
  ignored_.patches.resize(geometry.mockup.patch_count);
  std::iota(ignored_.patches.begin(), ignored_.patches.end(), 0u);
  ignored_known_ = false;
}

/// A patch in which nothing would push any more has opened, and pushes from then on.
void CollisionFrame::ignore_what_has_not_opened(const Contacts& contacts) {
  if (ignored_.patches.empty() || contacts.truncated) return;
  ignored_.patches = contacts.ignored_touched;
  if (!ignored_known_) ignored_at_first_ = ignored_.patches.size();
  ignored_known_ = true;
}

void CollisionFrame::note_slow(const FrameSlot& slot) noexcept {
  if (slot.total_us <= slow_us_) return;
  ++slow_frames_;
  if (slot.total_us <= slowest_.us) return;
  slowest_ = {.sample = slot.sample, .us = slot.total_us};
  for (const Contacts::StageTime& time : slot.contacts.times)
    if (time.us > slowest_.stage_us) slowest_.stage = time.stage, slowest_.stage_us = time.us;
}

/// Goes over to another plan, if one is ready.
void CollisionFrame::take_plan(std::int64_t tick) noexcept {
  const PlanTarget* next = plans_ ? plans_->take(backend_) : nullptr;
  if (!next) return;
  ++plan_changes_;
  if (next->plan.profile == profile_ && next->torques == torques_) return;
  ++felt_changes_;
  if (next->plan.profile != profile_ && profile_change_count_ < kToldChanges)
    profile_changes_[profile_change_count_++] = {tick, next->plan.profile};
  profile_ = next->plan.profile;
  torques_ = next->torques;
}

Result<void> CollisionFrame::solve(FrameSlot& slot, LawResult& result) noexcept {
  // A library's exception must not pass the control loop's thread, nor end the program with force on.
  try {
    return answer(slot, result);
  } catch (const std::exception& error) {
    return Error{ErrorCode::kInternal, std::string("the collision query failed: ") + error.what()};
  } catch (...) {
    return Error{ErrorCode::kInternal, "the collision query failed for an unknown reason"};
  }
}

Result<void> CollisionFrame::answer(FrameSlot& slot, LawResult& result) {
  take_plan(slot.sample.tick);
  const auto start = std::chrono::steady_clock::now();  // recorded, decides nothing
  const auto lattice_pose = to_lattice(slot.sample.pose, geometry_);
  if (!lattice_pose) return lattice_pose.error();
  slot.lattice_pose = *lattice_pose;

  const bool refined = profile_ == Profile::kRefined;
  if (slot.lattice_pose.beyond_lattice) {
    clear(slot.contacts);
  } else {
    ignored_.coarser = budget_.coarser();
    if (auto answered = backend_->query(slot.lattice_pose, refined ? &ignored_ : nullptr, slot.contacts);
        !answered)
      return answered;
  }
  if (refined) ignore_what_has_not_opened(slot.contacts);
  respond(slot.contacts, slot.lattice_pose, geometry_, profile_, stiffness_, slot.response);

  result = {};
  result.tick = slot.sample.tick;
  result.change = felt_changes_;
  result.rotation = slot.sample.pose.rotation;
  result.gc = slot.sample.pose.position + slot.sample.pose.rotation * geometry_.tool_gc_m;
  fill_law_result(slot.response, refined, stiffness_, result);
  if (!torques_) {
    result.wrench.torque = Vec3(0);
    for (ContactPlane& plane : result.planes) plane.lever = Vec3(0);
  }

  const auto taken = std::chrono::steady_clock::now() - start;
  const auto ns = std::chrono::duration_cast<std::chrono::nanoseconds>(taken).count();
  slot.total_us = static_cast<double>(ns) / 1000;
  frame_ns_.add(ns);
  note_slow(slot);
  if (refined) budget_.frame(slot.total_us, field_us(slot.contacts));
  if (slot.contacts.truncated) ++truncated_frames_, truncated_capacity_ = slot.contacts.truncated_capacity;
  // Where contacts are left out, nothing pushes because nobody wants it to.
  const bool unknown = (slot.response.flags & kFlagNoDirection) != 0 && slot.contacts.ignored_touched.empty();
  if (unknown && no_direction_frames_++ == 0) no_direction_first_ = slot.sample;
  areas_max_ = std::max(areas_max_, result.areas);
  if (result.areas > kMaxLawPlanes) ++merged_frames_;
  return {};
}

}  // namespace palpate
