#pragma once
#include <memory>
#include <string>

#include "driver/haptic_device.h"
#include "model/result.h"

namespace palpate::replay {

/// Does again what a recorded hand did: read() gives the pose of the trace at the tick's own time, to the bit
/// where the trace has a row there, between two rows (ticks that the recording missed) on the straight way;
/// held after the last. It keeps virtual and real time alike, a tick a read. Nothing is exerted: the hand is
/// a recording. It says that it could exert `max_force_n` and `max_torque_nm` on all axes, so that what goes
/// out is computed, limited and recorded as it would be on a device. Errors (kBadValue): as read_trace.
Result<std::unique_ptr<HapticDevice>> make_replay(const std::string& trace_file, double max_force_n,
                                                  double max_torque_nm);

}  // namespace palpate::replay
