#include "service/report/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "service/cli/numbers.h"
#include "service/loop/virtual_coupling.h"
#include "service/report/report_assets.h"
#include "service/report/run_summary.h"
#include "service/report/scene_picture.h"

namespace palpate {
namespace {

using Json = nlohmann::ordered_json;

std::string dump(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace); }

/// The rows of summary_text, which both the terminal and the page show.
Json summary_rows(const SessionSummary& summary, const std::vector<std::string>& stage_names) {
  Json rows = Json::array();
  for (const auto& [name, value] : summary_lines(summary, stage_names)) rows.push_back({name, value});
  return rows;
}

/// As written by hand: 2000, not 2e+03.
std::string three_digits(double value) {
  if (!(std::fabs(value) >= 1000)) return fmt::format("{:.3g}", value);
  const double unit = std::pow(10, std::floor(std::log10(value)) - 2);
  return fmt::format("{:.0f}", std::round(value / unit) * unit);
}
std::string millimetres(double metres) { return fmt::format("{:.4g} mm", metres * 1000); }

Json settings_rows(const LoadedScene& loaded, const ReportFacts& facts) {
  const Scene& scene = loaded.scene;
  const SceneGeometry& geometry = loaded.geometry;
  const double step = geometry.lattice.step_m;
  Json rows = Json::array();
  const auto row = [&](const char* name, const std::string& value) { rows.push_back({name, value}); };
  row("scene", scene.file);
  row("pace", facts.pace == "asap"
                  ? fmt::format("asap: virtual time, results {} ticks old", scene.control.virtual_delay_ticks)
                  : "realtime");
  row("profile", scene.response.profile == Profile::kPaper ? "paper" : "refined");
  row("stiffness K", fmt::format("{:g} N/m", scene.response.stiffness_n_per_m));
  row("smooth angle", fmt::format("{:g}°", scene.response.smooth_angle_deg));
  row("lattice step", fmt::format("{:.4g} nm", step * 1e9));
  row("voxel", fmt::format("{}{}", millimetres(step * geometry.mockup_grid.size),
                           scene.response.voxel_size_m ? "" : " (auto)"));
  row("sample spacing", fmt::format("{}{}", millimetres(step * geometry.sample_spacing),
                                    scene.response.sample_spacing_m ? "" : " (auto)"));
  row("control law", scene.control.law == ForceLaw::kPrinted ? "printed" : "corrected");
  row("transitions n", scene.control.transitions ? fmt::format("{}", *scene.control.transitions) : "auto");
  const Couplings couplings = couplings_of(scene, geometry.tool_gyration_m);
  const CouplingSettings& coupling =
      scene.response.profile == Profile::kPaper ? couplings.areas : couplings.field;
  if (coupling.on() && scene.control.law == ForceLaw::kCorrected)
    row("virtual coupling", fmt::format("{} N/m, {} N·m/rad", three_digits(coupling.stiffness_n_per_m),
                                        three_digits(coupling.stiffness_nm_per_rad)));
  row("fade-in", fmt::format("{:g} ms", scene.control.fade_in_ms));
  row("watchdog", fmt::format("{:g} ms", scene.control.watchdog_ms));
  row("device limits", fmt::format("{:g} N, {:g} N·m", scene.device.max_force_n, scene.device.max_torque_nm));
  row("load, prepare", fmt::format("{:.2f} s, {:.2f} s", facts.load_s, facts.prepare_s));
  return rows;
}

Json provenance_rows(const Provenance& provenance) {
  const auto listed = [](const std::vector<std::string>& words) {
    std::string out;
    for (const std::string& word : words) out += (out.empty() ? "" : ", ") + word;
    return out.empty() ? "none" : out;
  };
  Json rows = Json::array();
  const auto row = [&](const std::string& name, const std::string& value) { rows.push_back({name, value}); };
  row("palpate", provenance.version + ", commit " + provenance.commit);
  row("command", provenance.command);
  row("engine", provenance.engine);
  row("machine", provenance.machine);
  row("written", provenance.time_utc);
  row("stages kept", listed(provenance.kept));
  row("stages left out", listed(provenance.left_out));
  for (const auto& [name, hash] : provenance.inputs)
    row(name, hash.size() == 64 ? "SHA-256 " + hash : hash.empty() ? "can't be read any more" : hash);
  return rows;
}

/// The scene at each numbered stage; of a run without stages at its strongest contact.
Json pictures(const LoadedScene& loaded, const ReportSeries& series) {
  const std::map<std::int32_t, StageFigures> stages = series.stages();
  const bool numbered = stages.upper_bound(0) != stages.end();
  std::vector<Pose> poses;
  Json out = Json::array();
  for (const auto& [stage, figures] : stages) {
    if (numbered && stage <= 0) continue;
    poses.push_back(figures.pose);
    out.push_back({{"stage", stage},
                   {"name", stage > 0 ? stage_text(stage, loaded.scene.stage_names) : "strongest contact"},
                   {"at", figures.at_s},
                   {"force", figures.force_max_n}});
  }
  const std::vector<Image> images = scene_pictures(loaded.geometry, poses);
  for (std::size_t i = 0; i < images.size(); ++i) out[i]["image"] = png_address(images[i]);
  return out;
}

/// In a script element `</` would end it early; in a JSON string the slash may be escaped.
std::string script_safe(std::string json) {
  for (std::size_t at = 0; (at = json.find("</", at)) != std::string::npos; at += 3)
    json.insert(at + 1, "\\");
  return json;
}

}  // namespace

std::string chapter_experiment(const Scene& scene) {
  std::string name = scene.tool.source.generate;
  name.resize(std::min(name.find('/'), name.size()));
  for (const StaticBody& body : scene.statics)
    if (body.source.generate.substr(0, body.source.generate.find('/')) != name) return "";
  return name;
}

ReportFocus report_focus(const LoadedScene& scene) {
  ReportFocus focus{scene.geometry.tool_gc_m, {}};
  if (chapter_experiment(scene.scene) == "disassembly") focus.stage = 3;
  return focus;
}

std::string report_page(const SessionSummary& summary, const LoadedScene& loaded, const ReportFacts& facts,
                        const ReportSeries& series) {
  const std::string subtitle = fmt::format(
      "{:.1f} s in {} with the {} device; contact found by the engine {} on {}",
      static_cast<double>(summary.ticks) * 1e-3, facts.pace == "asap" ? "virtual time" : "real time",
      summary.haptic_device, summary.backend, summary.device);
  std::string data = "{\"name\":" + dump(scene_name(loaded.scene.file));
  data += ",\"subtitle\":" + dump(subtitle);
  data += ",\"notes\":" + dump(summary.notes);
  data += ",\"chapter\":" + dump(chapter_experiment(loaded.scene));
  data += ",\"summary\":" + summary_json(summary);
  data += ",\"provenance\":" + dump(provenance_rows(facts.provenance));
  data += ",\"summary_rows\":" + dump(summary_rows(summary, loaded.scene.stage_names));
  data += ",\"settings\":" + dump(settings_rows(loaded, facts));
  data += ",\"pictures\":" + dump(pictures(loaded, series));
  data += "," + series.json(loaded.scene.stage_names) + "}";

  // The template's places, in one pass, so that nothing inserted is searched again.
  const std::vector<std::pair<std::string_view, std::string>> places = {
      {"@CSS@", std::string(assets::report_css)},
      {"@PLOT_JS@", std::string(assets::plot_js)},
      {"@DATA@", script_safe(std::move(data))},
      {"@SCRIPT@", std::string(assets::report_js)}};
  std::string_view rest = assets::report_html;
  std::string page;
  for (const auto& [name, text] : places) {
    const std::size_t at = rest.find(name);
    page.append(rest.substr(0, at)).append(text);
    rest.remove_prefix(at + name.size());
  }
  return page.append(rest);
}

}  // namespace palpate
