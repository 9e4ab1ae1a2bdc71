#include "service/report/run_summary.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string_view>

#include "service/cli/numbers.h"

namespace palpate {

std::string summary_json(const SessionSummary& summary, const Provenance* provenance) {
  using Json = nlohmann::ordered_json;
  const auto percentiles = [](const Percentiles& p) {
    return Json{{"p50", p.p50}, {"p99", p.p99}, {"max", p.max}};
  };
  const Percentiles& late = summary.lateness_us;
  const auto histogram = [](const std::vector<HistogramBin>& bins) {
    Json out = Json::array();
    for (const HistogramBin& bin : bins) out.push_back({bin.low, bin.high, bin.count});
    return out;
  };
  Json json = Json::object();
  if (summary.realtime) {
    const RealtimeOutlook& real = *summary.realtime;
    json["real_time"] = {{"kept_up", real.kept_up},
                         {"result_age_ticks", percentiles(real.result_age_ticks)},
                         {"watchdog_ticks", real.watchdog_ticks},
                         {"sentence", real.sentence}};
  }
  json.update(
      {{"static_triangles", summary.static_triangles},
       {"tool_triangles", summary.tool_triangles},
       {"backend", summary.backend},
       {"device", summary.device},
       {"profile", summary.profile},
       {"law", summary.law},
       {"ticks", summary.ticks},
       {"missed_ticks", summary.missed_ticks},
       {"lateness_us", {{"p50", late.p50}, {"p99", late.p99}, {"p999", late.p999}, {"max", late.max}}},
       {"result_age_ticks", percentiles(summary.result_age_ticks)},
       {"frame_us", percentiles(summary.frame_us)},
       {"stages_reached", summary.stages_reached},
       {"areas_max", summary.areas_max},
       {"force_max_N", summary.force_max_N},
       {"torque_max_Nm", summary.torque_max_Nm}});
  json["lateness_histogram_us"] = histogram(summary.lateness_bins_us);
  json["result_age_histogram_ticks"] = histogram(summary.result_age_bins_ticks);
  if (summary.ignored_patches_first > 0)
    json["ignored_patches"] = {{"first", summary.ignored_patches_first},
                               {"end", summary.ignored_patches_end}};
  json["stopped"] = summary.stopped;
  for (const SessionSummary::Changed& change : summary.profile_changes)
    json["profile_changes"].push_back(
        {{"tick", change.tick}, {"profile", change.profile}, {"law", change.law}});
  json["coarse_frames"] = summary.coarse_frames;
  if (summary.coarse_frames > 0) json["coarsest_share"] = summary.coarsest_share;
  json["no_direction_frames"] = summary.no_direction_frames;
  if (summary.no_direction_frames > 0) {
    const Vec3& p = summary.no_direction_pose.position;
    const Quat& q = summary.no_direction_pose.rotation;
    json["no_direction_first"] = {{"tick", summary.no_direction_tick},
                                  {"pose", {p.x, p.y, p.z, q.x, q.y, q.z, q.w}}};
  }
  if (!summary.static_parts.empty())
    json["parts"] = {{"static", summary.static_parts}, {"tool", summary.tool_parts}};
  if (provenance != nullptr) {
    Json inputs = Json::array();
    for (const auto& [name, hash] : provenance->inputs) inputs.push_back({{"name", name}, {"sha256", hash}});
    json["provenance"] = {{"version", provenance->version},
                          {"commit", provenance->commit},
                          {"machine", provenance->machine},
                          {"engine", provenance->engine},
                          {"command", provenance->command},
                          {"time", provenance->time_utc},
                          {"inputs", inputs},
                          {"plan", {{"kept", provenance->kept}, {"left_out", provenance->left_out}}}};
  }
  if (!summary.notes.empty()) json["notes"] = summary.notes;
  if (summary.failure) json["failure"] = summary.failure->sentence;
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string scene_name(const std::string& file) {
  const std::filesystem::path path = std::filesystem::absolute(file).lexically_normal();
  const std::string stem = path.stem().string();
  const std::string folder = path.parent_path().filename().string();
  return stem == "scene" && !folder.empty() ? folder : stem;
}

std::string stage_text(int stage, const std::vector<std::string>& stage_names) {
  const bool named = stage >= 1 && static_cast<std::size_t>(stage) <= stage_names.size();
  return named ? fmt::format("{} {}", stage, stage_names[static_cast<std::size_t>(stage) - 1])
               : fmt::format("{}", stage);
}

std::vector<std::pair<std::string, std::string>> summary_lines(const SessionSummary& summary,
                                                               const std::vector<std::string>& stage_names) {
  std::vector<std::pair<std::string, std::string>> lines;
  const auto line = [&](const char* name, std::string value) { lines.emplace_back(name, std::move(value)); };
  if (summary.realtime) line("real time", summary.realtime->sentence);
  line("mock-up", count_text(summary.static_triangles) + " triangles");
  line("tool", count_text(summary.tool_triangles) + " triangles");
  line("back end", fmt::format("{}, {}", summary.backend, summary.device));
  line("haptic device", summary.haptic_device);
  std::string method = fmt::format("profile {}, law {}", summary.profile, summary.law);
  for (const SessionSummary::Changed& change : summary.profile_changes)
    method += fmt::format("; from tick {} {}, {}", change.tick, change.profile, change.law);
  line("method", std::move(method));
  line("ticks", fmt::format("{} of 1 ms, {} missed{}", count_text(summary.ticks),
                            count_text(summary.missed_ticks), summary.stopped ? "; stopped" : ""));
  if (summary.lateness_us.max > 0)
    line("lateness", fmt::format("{:.0f} µs median, {:.0f} µs p99, {:.0f} µs at most",
                                 summary.lateness_us.p50, summary.lateness_us.p99, summary.lateness_us.max));
  line("result age",
       fmt::format("{:.0f} ticks median, {:.0f} p99, {:.0f} at most", summary.result_age_ticks.p50,
                   summary.result_age_ticks.p99, summary.result_age_ticks.max));
  line("frames",
       fmt::format("{}{}: {:.3g} ms median, {:.3g} ms p99, {:.3g} ms at most", count_text(summary.frames),
                   summary.dropped_frames > 0
                       ? fmt::format(", {} of them not recorded", count_text(summary.dropped_frames))
                       : "",
                   summary.frame_us.p50 / 1000, summary.frame_us.p99 / 1000, summary.frame_us.max / 1000));
  std::string stages;
  for (const int stage : summary.stages_reached)
    stages += (stages.empty() ? "" : stage_names.empty() ? ", " : "; ") + stage_text(stage, stage_names);
  if (!stages.empty()) line("stages", stages);
  constexpr std::size_t kToldParts = 5;  // chosen
  std::string touched;
  for (std::size_t i = 0; i < std::min(kToldParts, summary.static_parts.size()); ++i)
    touched += (touched.empty() ? "" : ", ") + summary.static_parts[i];
  if (summary.static_parts.size() > kToldParts)
    touched += fmt::format(" and {} more parts", summary.static_parts.size() - kToldParts);
  if (!touched.empty()) line("touched", touched);
  line("areas", fmt::format("{} at once at most", summary.areas_max));
  line("force", fmt::format("{:.3g} N at most", summary.force_max_N));
  line("torque", fmt::format("{:.3g} N·m at most", summary.torque_max_Nm));
  return lines;
}

std::string summary_text(const SessionSummary& summary, const std::vector<std::string>& stage_names) {
  std::string text;
  for (const auto& [name, value] : summary_lines(summary, stage_names)) {
    // The stages, one below the other.
    std::string lines = value;
    if (std::string_view(name) == "stages")
      for (std::size_t at = 0; (at = lines.find("; ", at)) != std::string::npos;)
        lines.replace(at, 2, "\n" + std::string(15, ' '));
    text += fmt::format("{:<14} {}\n", name, lines);
  }
  return text;
}

}  // namespace palpate
