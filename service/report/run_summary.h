#pragma once
#include <string>
#include <utility>
#include <vector>

#include "service/loop/session.h"
#include "service/report/provenance.h"

namespace palpate {

/// summary.json: the contract's fields in its order; then `provenance`, where it is given; then `notes`,
/// sentences on what went on, and `failure`, why the run ended before its time, where there are any.
std::string summary_json(const SessionSummary& summary, const Provenance* provenance = nullptr);

/// The same for a person, as pairs of name and value. `stage_names`: stage i is stage_names[i − 1].
std::vector<std::pair<std::string, std::string>> summary_lines(const SessionSummary& summary,
                                                               const std::vector<std::string>& stage_names);

/// summary_lines in columns.
std::string summary_text(const SessionSummary& summary, const std::vector<std::string>& stage_names);

/// What a run of this scene file is called: its name, or its folder's where it is just `scene.json`.
std::string scene_name(const std::string& file);

/// "3 inside the obstacle", or "3" where it has no name.
std::string stage_text(int stage, const std::vector<std::string>& stage_names);

}  // namespace palpate
