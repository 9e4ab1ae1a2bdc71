#include "service/cli/path.h"

#include <fmt/format.h>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <CLI/Validators.hpp>

#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>

#include "service/cli/console.h"
#include "service/cli/numbers.h"
#include "service/cli/output_folder.h"
#include "service/cli/pose_input.h"
#include "service/cli/scene_host.h"
#include "service/cli/text_output.h"
#include "service/queries/path_check.h"
#include "service/report/path_page.h"

namespace palpate {
namespace {

constexpr const char* kPathFiles[] = {"path.csv", "path.json", "path.html"};

using Json = nlohmann::ordered_json;

constexpr const char* kPathFooter =
    R"(Between two poses that follow each other the tool moves on a screw: about one axis, the short way, and along it. Prints one JSON object: clear, first_contact
(pose, with its fraction on the way to the next; parts), least clearance (at the poses of a clear path, to the lattice step below; 0 where one touches within the tolerance or is free by less than a step; else 0, at the first contact), worst depth at the poses (null: none touches), travel_m (of the tool's centre, straight from pose to pose),
the parts that touch at a pose or at a first contact between two, by name, and what was examined; with --tolerance also how many poses have a contact that does not count, and at how many of them no depth is known, for neither body has a sample in the other (sheets, surfaces that coincide). A first contact is never late, and early by no more than early_m and a lattice step. With --out DIR also path.csv, a row a pose, path.json, and path.html with pictures of the closest moments.
Exit codes: 0 the path is clear, 5 it is not, others as ever. A path of which nothing was examined is an error, never clear.

Examples:
  palpate path scene.json pull.csv --out report
  palpate path scene.json pull.csv --tolerance 50e-6)";

Json json_of(const LoadedScene& scene, const PathReport& report, const std::string& engine, bool moments) {
  const double step = scene.geometry.lattice.step_m;
  const auto pose_json = [](const Pose& p) {
    return Json{p.position.x, p.position.y, p.position.z, p.rotation.x,
                p.rotation.y, p.rotation.z, p.rotation.w};
  };
  const auto point = [&](const Int3& p) {
    const Vec3 at = scene.geometry.lattice.origin_m + step * Vec3(p);
    return Json{at.x, at.y, at.z};
  };
  Json out;
  out["clear"] = report.clear();
  out["first_contact"] = nullptr;
  const double first = !report.first_screw || *report.first_screw == 0
                           ? 0.0
                           : static_cast<double>(*report.first_screw) - 1 + report.first_time;
  if (report.first_screw)
    out["first_contact"] = {{"pose", first},
                            {"at", pose_json(*report.first_pose)},
                            {"tool_part", report.first_tool},
                            {"static_part", report.first_static}};
  if (report.first_screw && report.moments[*report.first_screw].undecided)
    out["first_contact"]["undecided"] = true;
  out["least_clearance_m"] = out["closest_pose"] = nullptr;
  if (!report.clear()) {  // wherever poses lie, no room is left where the tool touches
    out["least_clearance_m"] = 0.0;
    out["closest_pose"] = first;
  } else if (report.deepest) {  // a contact that is tolerated
    out["least_clearance_m"] = 0.0;
    out["closest_pose"] = *report.deepest;
  } else if (report.closest) {
    out["least_clearance_m"] = report.moments[*report.closest].clearance.steps * step;
    out["closest_pose"] = *report.closest;
  }
  out["worst_depth_m"] = report.deepest ? Json(*report.moments[*report.deepest].depth_m) : Json(nullptr);
  out["deepest_pose"] = report.deepest ? Json(*report.deepest) : Json(nullptr);
  out["touching"] = {{"static", report.static_parts}, {"tool", report.tool_parts}};
  if (report.rule.tolerance > 0)
    out["tolerated"] = {{"poses", report.tolerated}, {"without_depth", report.without_depth}};
  out["tolerance_m"] = report.rule.tolerance * step;
  out["early_m"] = report.rule.early * step;
  out["examined"] = {{"poses", report.moments.size()},
                     {"screws", report.screws},
                     {"evaluations", report.evaluations},
                     {"travel_m", report.moments.back().travel_m}};
  out["engine"] = engine;
  if (!moments) return out;
  Json& list = out["poses"] = Json::array();
  for (const PathMoment& m : report.moments) {
    Json one{{"at", pose_json(m.pose)}, {"travel_m", m.travel_m}, {"touches", m.touches}};
    one["clearance_m"] =
        m.clearance.kind == Clearance::Kind::kFurther ? Json(nullptr) : Json(m.clearance.steps * step);
    if (m.clearance.kind == Clearance::Kind::kApart)
      one["nearest"] = {{"static", m.clearance.static_id},
                        {"mobile", m.clearance.mobile_id},
                        {"on_static", point(m.clearance.on_static)},
                        {"on_mobile", point(m.clearance.on_mobile)}};
    one["depth_m"] = m.depth_m ? Json(*m.depth_m) : Json(nullptr);
    one["static_part"] = m.static_part;
    one["tool_part"] = m.tool_part;
    one["first_contact"] = m.first_contact ? Json(*m.first_contact) : Json(nullptr);
    if (m.undecided) one["undecided"] = true;
    list.push_back(std::move(one));
  }
  return out;
}

/// A field of a CSV file.
std::string field(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string out = "\"";
  for (const char c : text) out += c == '"' ? std::string("\"\"") : std::string(1, c);
  return out + "\"";
}

std::string csv_of(const LoadedScene& scene, const PathReport& report) {
  const double step = scene.geometry.lattice.step_m;
  std::string out =
      "pose,x,y,z,qx,qy,qz,qw,travel_m,touches,clearance_m,depth_m,first_contact,static_id,mobile_id,tool_"
      "part,static_part\n";
  for (std::size_t i = 0; i < report.moments.size(); ++i) {
    const PathMoment& m = report.moments[i];
    const Pose& p = m.pose;
    const bool apart = m.clearance.kind == Clearance::Kind::kApart;
    out += fmt::format(
        "{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{}\n", i, p.position.x, p.position.y, p.position.z,
        p.rotation.x, p.rotation.y, p.rotation.z, p.rotation.w, m.travel_m, m.touches ? 1 : 0,
        m.clearance.kind == Clearance::Kind::kFurther ? "" : fmt::format("{}", m.clearance.steps * step),
        m.depth_m ? fmt::format("{}", *m.depth_m) : "",
        m.first_contact ? fmt::format("{}", *m.first_contact) : "",
        apart ? fmt::format("{}", m.clearance.static_id) : "",
        apart ? fmt::format("{}", m.clearance.mobile_id) : "", field(m.tool_part), field(m.static_part));
  }
  return out;
}

Result<void> path_command(const PathOptions& options, const Parts& parts) {
  if (!options.out.empty())
    if (auto done = check_output_folder(options.out, kPathFiles, "a path's", options.overwrite); !done)
      return done;
  auto poses = read_poses_of_scene(options.path, options.common.scene);
  if (!poses) return poses.error();
  if (poses->empty())
    return bad_value(options.path + ": the file has no pose, so there is nothing to examine");
  catch_interrupts();
  Console console;
  auto prepared = prepare_for_verdicts(options.common, options.tolerance_m, parts, console);
  if (!prepared) return prepared.error();
  const LoadedScene& scene = (*prepared)->loaded;
  CollisionBackend& backend = *(*prepared)->backend;
  console.step("examining the path");
  const auto report =
      check_path(scene, backend, *poses, TouchRule::of(scene.geometry, options.tolerance_m), options.within_m,
                 [&](const char* what, double done) { return console.progress(what, done); });
  console.finish();
  if (!report) return report.error();
  for (const std::string& note : backend.take_notes()) console.note(note);
  if (report->without_depth > 0)
    console.note(fmt::format(
        "at {} of {} poses triangles meet and no sample of either body lies in the other: there is "
        "no depth to hold against the tolerance, and the contact does not count (sheets, or "
        "surfaces that coincide)",
        report->without_depth, report->moments.size()));
  const std::string engine =
      backend.name() + " on " + backend.device() +
      (backend.measured_by() == backend.name() ? "" : ", distances by " + backend.measured_by());
  // Before the files, which may fail: what was examined is told.
  const std::string line =
      json_of(scene, *report, engine, false).dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
  if (auto printed = print_text(line); !printed) return printed;
  if (!options.out.empty()) {
    const std::filesystem::path folder(options.out);
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    if (error) return bad_value(options.out + ": the directory can't be made (" + error.message() + ")");
    const auto dump = [](const Json& json, int indent) {
      return json.dump(indent, ' ', false, Json::error_handler_t::replace) + "\n";
    };
    if (auto done = write_text(folder / "path.json", dump(json_of(scene, *report, engine, true), 1)); !done)
      return done;
    if (auto done = write_text(folder / "path.csv", csv_of(scene, *report)); !done) return done;
    if (auto done = write_text(folder / "path.html",
                               path_page(scene, *report, options.path, scene.scene.file, engine));
        !done)
      return done;
  }
  if (report->clear()) return {};
  if (report->moments[*report->first_screw].undecided)
    return Error{
        ErrorCode::kNotClear,
        fmt::format("{}: whether the tool touches between pose {} and pose {} is not decided: it is "
                    "clear up to {:.6f} of the way, and goes on so near that more was not examined",
                    options.path, *report->first_screw - 1, *report->first_screw, report->first_time)};
  return Error{
      ErrorCode::kNotClear,
      *report->first_screw == 0
          ? options.path + ": the tool touches where the path starts"
          : fmt::format("{}: the tool touches between pose {} and pose {}, first at {:.6f} of the way",
                        options.path, *report->first_screw - 1, *report->first_screw, report->first_time)};
}

}  // namespace

void add_path_command(CLI::App& app, PathOptions& options, const Parts& parts, Result<void>& outcome) {
  CLI::App* path = app.add_subcommand(
      "path",
      "tell whether a path is clear: first contact, clearance along it, worst depth, the parts that touch");
  path->add_option("scene", options.common.scene, "scene file (JSON)")->required()->type_name("SCENE");
  path->add_option("path", options.path,
                   "CSV file of poses, header x,y,z,qx,qy,qz,qw: world from tool; or a scene's own path, or "
                   "a run's trace")
      ->required()
      ->type_name("PATH.csv");
  path->add_option("--backend", options.common.backend, "the engine that answers, as for query (auto)")
      ->check(CLI::IsMember({"auto", "gpu", "cpu", "ref"}).description(""))
      ->type_name("auto|gpu|cpu|ref");
  const auto metres = [path](const char* name, auto set, const char* help) {
    path->add_option_function<double>(
            name,
            [=](const double& value) {
              if (!(value >= 0 && value <= 100))
                throw CLI::ValidationError(name, fmt::format("{} is not from 0 to 100", value));
              set(value);
            },
            help)
        ->type_name("M");
  };
  metres(
      "--tolerance", [&options](double value) { options.tolerance_m = value; },
      "a contact no deeper than this does not count, m; rounded down to steps of the lattice");
  metres(
      "--within", [&options](double value) { options.within_m = value; },
      "measure no clearance further than this, m");
  path->add_option("--out", options.out, "directory for path.csv, path.json and path.html")->type_name("DIR");
  path->add_flag("--overwrite", options.overwrite, "replace the files of a path that are in --out already");
  path->footer(kPathFooter);
  path->callback([&] { outcome = path_command(options, parts); });
}

}  // namespace palpate
