#pragma once
#include <string>

#include "model/scene/scene.h"
#include "service/loop/session.h"
#include "service/report/provenance.h"
#include "service/report/report_series.h"

namespace palpate {

/// Facts about a run that the page shows beside the session's own summary.
struct ReportFacts {
  std::string pace;  ///< "realtime" or "asap"
  double load_s = 0, prepare_s = 0;
  Provenance provenance;
};

/// Which of the chapter's experiments a scene is, as its own generator made it: "contacts" (4.1),
/// "disassembly" (4.2), or empty.
std::string chapter_experiment(const Scene& scene);

/// Where the tool's centre of mass is; of the chapter's disassembly stage 3, which its figure 13 shows.
ReportFocus report_focus(const LoadedScene& scene);

/// The run as one self-contained page: forces, depth, work, steps, times, summary, settings and provenance;
/// of the chapter's scenes its figures 10, 12 and 13 as printed.
std::string report_page(const SessionSummary& summary, const LoadedScene& scene, const ReportFacts& facts,
                        const ReportSeries& series);

}  // namespace palpate
