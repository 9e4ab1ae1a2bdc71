#pragma once
#include <filesystem>
#include <memory>

#include "model/scene/scene.h"
#include "service/loop/recorder.h"
#include "service/report/report.h"
#include "service/report/report_series.h"

namespace palpate {

/// The folder that a session leaves: the files of `palpate run`. One thread.
class Recording final : public RunObserver {
 public:
  explicit Recording(const ReportFocus& focus) : series_(focus) {}

  /// Opens the files in `folder`, which exists.
  static Result<std::unique_ptr<Recording>> create(const std::filesystem::path& folder,
                                                   const ReportFocus& focus);

  Result<void> on_tick(const TickRecord& tick) override;
  Result<void> on_frame(const FrameRecord& frame) override;

  /// Completes the files. Without a summary (the session could not run) there is none, and no report.
  Result<void> finish(const SessionSummary* summary, const LoadedScene& scene, const ReportFacts& facts);

 private:
  std::filesystem::path folder_;
  std::unique_ptr<Recorder> recorder_;
  ReportSeries series_;
};

}  // namespace palpate
