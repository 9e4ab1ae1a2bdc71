#pragma once
#include <string>
#include <vector>

#include "model/lattice/pose.h"
#include "model/result.h"

namespace palpate::replay {

/// What a replay needs of one row of a recorded trace.csv.
struct TraceRow {
  double time_s = 0;
  Pose pose;      ///< world from tool
  int stage = 0;  ///< 0 where the trace has no such column
};

/// Reads a trace.csv as `palpate run` leaves it, from any device: the header begins with
/// time_s,x_m,y_m,z_m,qx,qy,qz,qw; further columns may follow, of which `stage` alone is used. At least one
/// row, times ascending from 0 or later. Errors (kBadValue) name file, line, value and what is allowed:
/// another header, a row with more or fewer values than the header (the last one of a recording cut short
/// too), a number that is none, a time that does not ascend, a rotation that isn't unit.
Result<std::vector<TraceRow>> read_trace(const std::string& file);

}  // namespace palpate::replay
