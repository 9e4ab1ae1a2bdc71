#pragma once
#include <cstdint>

#include "model/contact/contacts.h"
#include "model/contact/response.h"
#include "model/lattice/lattice.h"
#include "model/lattice/pose.h"
#include "model/result.h"

namespace palpate {

/// One tick of the 1 kHz loop, as it is recorded: a row of trace.csv. Plain data, copied through a queue.
struct TickRecord {
  std::int64_t tick = 0;  ///< number of executed ticks before this one
  double time_s = 0;      ///< scheduled time since the first tick; missed ticks leave gaps
  Pose pose;              ///< world from tool, as the device reported it
  Wrench sent;            ///< what went to the device, after law, gate and limits; torque about gc
  Wrench response;        ///< sum over areas of the newest result, as the back end found it at its own pose
  Wrench uncontrolled;    ///< what would go out without the control law: `response`, as far as the device's
                          ///< axes exert it
  std::int32_t result_age_ticks = -1;  ///< now − tick of the newest result's pose; −1: no result yet
  bool contact = false;                ///< of the newest result
  std::int32_t stage = 0;              ///< of the path, 0: none
  bool ready = false;                  ///< whether the device was: else no force
  bool paused = false;                 ///< as the device reported it
  const char* guidance = "";  ///< what the person at the device should do now; text that outlives the run
  float lateness_us = 0;      ///< real time: wake-up of this tick after its time
  std::uint64_t missed_ticks = 0;  ///< real time: so far
};

/// One answered query. The references live for the call only.
struct FrameRecord {
  std::int64_t tick = 0;  ///< tick at which the pose was sensed (TickRecord::time_s of it × 1000)
  const Pose& pose;
  const LatticePose& lattice_pose;
  const Contacts& contacts;
  const ContactResponse& response;
  double total_us = 0;  ///< wall time from pose in to wrench out
  /// Whether frames between the record before and this one were answered and not recorded.
  bool after_gap = false;
};

/// Follows a run. Called by one thread at a time, never by the control loop's or the collision worker's
/// thread in real time (a recording thread drains their queues), so it may allocate, write and wait. An error
/// ends the run.
class RunObserver {
 public:
  virtual ~RunObserver() = default;
  /// Once a tick, in order. An Error ends the run with zero force.
  virtual Result<void> on_tick(const TickRecord&) { return {}; }
  /// Once a frame that was answered, in order; as on_tick.
  virtual Result<void> on_frame(const FrameRecord&) { return {}; }
};

}  // namespace palpate
