#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "model/lattice/lattice.h"
#include "model/lattice/pose.h"
#include "model/result.h"

namespace palpate {

/// A row of a run's trace.csv, as far as runs are compared by it.
struct RecordedTick {
  std::int64_t tick = 0;  ///< time_s in ticks
  double time_s = 0;
  Pose pose;              ///< world from tool
  Wrench sent, response;  ///< N, N·m about the tool's centre of mass
  bool contact = false;
};

/// A folder that `palpate run` or a service's session left.
struct RecordedRun {
  std::string folder;
  std::string summary;              ///< summary.json, an object
  bool stopped = false;             ///< before its end
  std::vector<RecordedTick> ticks;  ///< ascending
};

/// Reads summary.json and trace.csv. Errors, kBadValue: a file that is missing or no run's, with file and
/// line.
Result<RecordedRun> read_run(const std::string& folder);

/// What is told of two runs tick by tick. A quantity's largest difference, its root mean square, and when it
/// first differs at all.
struct TickDifference {
  const char* name;  ///< "sent force", …
  const char* unit;
  double largest = 0, largest_at_s = 0, rms = 0;
  double first_peak = 0, second_peak = 0;  ///< largest size in each run; 0 of poses, which have none
  std::optional<double> first_at_s;        ///< empty: the same bits
};

/// A figure of summary.json in which two runs differ, as text; empty where a run has none.
struct FactDifference {
  std::string name, first, second;
  std::optional<double> ratio;  ///< second over first, of numbers
  bool provenance = false;
};

struct RunDifference {
  std::uint64_t common = 0, only_first = 0, only_second = 0;  ///< ticks
  std::uint64_t contact_differs = 0;                          ///< ticks in which only one is in contact
  std::array<TickDifference, 6>
      quantities;  ///< of the common ticks: place, turn, response's and sent force and torque
  std::vector<FactDifference> facts;                   ///< provenance first
  bool first_stopped = false, second_stopped = false;  ///< before its end
  bool same_trace() const;                             ///< the same ticks with the same numbers
};

/// Which of the two runs were stopped before their end, in a sentence; empty: neither.
std::string stopped_text(const RunDifference& difference);

RunDifference difference_of(const RecordedRun& first, const RecordedRun& second);

}  // namespace palpate
