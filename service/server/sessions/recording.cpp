#include "service/server/sessions/recording.h"

#include <fstream>

#include "service/report/run_summary.h"

namespace palpate {
namespace {

Result<void> write_text(const std::filesystem::path& path, const std::string& text) {
  std::ofstream out(path, std::ios::binary | std::ios::trunc);
  out << text;
  out.flush();
  if (!out) return bad_value(path.filename().string() + ": the file can't be written");
  return {};
}

}  // namespace

Result<std::unique_ptr<Recording>> Recording::create(const std::filesystem::path& folder,
                                                     const ReportFocus& focus) {
  auto recorder = Recorder::create(folder.string());
  if (!recorder) return recorder.error();
  auto recording = std::make_unique<Recording>(focus);
  recording->folder_ = folder;
  recording->recorder_ = std::move(*recorder);
  return recording;
}

Result<void> Recording::on_tick(const TickRecord& tick) {
  if (auto done = recorder_->on_tick(tick); !done) return done;
  return series_.on_tick(tick);
}

Result<void> Recording::on_frame(const FrameRecord& frame) {
  if (auto done = recorder_->on_frame(frame); !done) return done;
  return series_.on_frame(frame);
}

Result<void> Recording::finish(const SessionSummary* summary, const LoadedScene& scene,
                               const ReportFacts& facts) {
  if (auto closed = recorder_->finish(); !closed) return closed;
  if (!summary) return {};
  if (auto done = write_text(folder_ / "summary.json", summary_json(*summary, &facts.provenance)); !done)
    return done;
  return write_text(folder_ / "report.html", report_page(*summary, scene, facts, series_));
}

}  // namespace palpate
