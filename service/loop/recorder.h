#pragma once
#include <memory>
#include <string>

#include "service/loop/run_record.h"

namespace palpate {

/// Leaves trace.csv and frames.jsonl (query lines, `pose` counts the frames) in a directory. Numbers are
/// printed as the shortest text that reads back to the same double, so equal runs give equal bytes. Files are
/// whole once finish() has succeeded. Used by one thread; allocates and writes, so it stands behind the
/// queues of a session, never in its loops.
class Recorder : public RunObserver {
 public:
  /// Makes the directory if it is missing and opens both files, replacing older ones.
  /// Error (kBadValue) names the path and the system's reason.
  static Result<std::unique_ptr<Recorder>> create(const std::string& directory);

  ~Recorder() override;
  /// A row of trace.csv.
  Result<void> on_tick(const TickRecord& tick) override;
  /// A line of frames.jsonl.
  Result<void> on_frame(const FrameRecord& frame) override;

  /// Flushes and closes; the last chance to hear that the disk is full. Call it before the files are used.
  Result<void> finish();

 private:
  Recorder();
  struct Files;
  std::unique_ptr<Files> files_;
};

}  // namespace palpate
