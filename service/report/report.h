#pragma once
#include <string>

#include "model/scene/scene.h"
#include "service/loop/session.h"
#include "service/report/report_series.h"

namespace palpate {

/// Facts about a run that the page shows beside the session's own summary.
struct ReportFacts {
  std::string pace;  ///< "realtime" or "asap"
  double load_s = 0, prepare_s = 0;
};

/// The run as one self-contained page: the chapter's figures 10, 12 and 13, summary and settings, Chart.js
/// inside.
std::string report_page(const SessionSummary& summary, const LoadedScene& scene, const ReportFacts& facts,
                        const ReportSeries& series);

}  // namespace palpate
