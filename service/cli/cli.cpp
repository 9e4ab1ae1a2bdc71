#include "service/cli/cli.h"

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <CLI/Validators.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <exception>
#include <map>
#include <new>

#include "model/one_line.h"
#include "service/bench/bench.h"
#include "service/cli/console.h"
#include "service/cli/serve.h"
#include "service/cli/tune.h"

namespace palpate {
namespace {

constexpr const char* kAbout =
    "palpate finds where a tool touches a large mock-up of triangles, works out the force and torque that a hand should\n"
    "feel, and keeps a 1 kHz haptic device fed with them.";

constexpr const char* kFooter = R"(Units are SI: metres, newtons, newton metres, seconds. A pose is `x y z qx qy qz qw`, world from tool, with a unit quaternion.
The result goes to standard output, progress and messages to standard error.

Exit codes: 0 done; 2 wrong usage; 3 a bad value in a file or an argument; 4 no usable device; 1 anything else.

A first quarter of an hour:
  palpate devices                                                  what can compute, what can be felt
  palpate generate contacts --out try                              a mock-up of 25,000 triangles, a clamp and its path
  palpate info try/*.stl                                           what was read: parts, size, closed or open
  palpate query try/scene.json --pose "0 0 0 0 0 0 1"              contact at one pose, as JSON
  palpate run try/scene.json --pace asap --out first               the simulated hand; then open first/report.html

`palpate COMMAND --help` tells more.)";

constexpr const char* kRunFooter = R"(DIR then holds trace.csv (a row a tick), frames.jsonl (an answered pose a line), summary.json and report.html
(one page with the plots, opens anywhere). The summary is printed too.
SIGINT (Ctrl-C) or SIGTERM ends the run with zero force and complete files.

With --pace realtime the loop keeps to the clock at 1 kHz and a result is as old as it happens to be. With --pace asap
time is virtual: as fast as the machine goes, a result always control.virtual_delay_ticks old, trace.csv the same bytes every time.
The first line of the summary says whether this machine kept up, or would have.

Examples:
  palpate run scenes/disassembly.json --pace asap --out a
  palpate run scenes/contacts.json --backend cpu --duration 2)";

constexpr const char* kQueryFooter = R"(Prints one JSON object a pose: pose, contact, pairs, cst bst cmt bmt imt est (triangle ids), areas (id, zones, static, mobile, normal,
depth m, point m, force N, torque N·m, flags), force, torque (about the tool's centre of mass), flags, truncated, time_us.
With --names also parts: the paths of the mock-up's and of the tool's parts that touch, as palpate info has them.
A file of poses is CSV with the header x,y,z,qx,qy,qz,qw. A pose far away is free of contact; only one that is not finite or
not a unit rotation is an error (exit code 3).

--export-geometry writes what was judged, on the integer lattice, for other software to check: lattice.json, static.i32,
tool_<pose>.i32, voxels.json, voxels.u8, and what it came to: pairs_<pose>.u32 (static and mobile id of each intersecting pair).

Examples:
  palpate query scene.json --pose "0.1 0 0.25 0 0 0 1"
  palpate query scene.json --poses poses.csv --backend cpu > cpu.jsonl)";

/// A closed list of words; the help shows them as the option's type already.
CLI::Validator one_of(const std::vector<std::string>& words) { return CLI::IsMember(words).description(""); }

CLI::Option* add_backend(CLI::App& app, SceneOptions& options) {
  return app.add_option("--backend", options.backend, "the engine that answers: gpu, everything in shaders; cpu, native code on this processor; ref, the reference; auto: gpu on a GPU, else cpu, "
                                                                 "with a sentence on standard error (auto)")
      ->check(one_of({"auto", "gpu", "cpu", "ref"}))
      ->type_name("auto|gpu|cpu|ref");
}

/// CLI::Range would let nan pass.
std::function<void(const double&)> number_within(const char* name, double least, double most, double& out) {
  return [=, &out](const double& value) {
    if (!(value >= least && value <= most)) throw CLI::ValidationError(name, fmt::format("{} is not from {} to {}", value, least, most));
    out = value;
  };
}

void add_import_limits(CLI::App& app, ImportLimits& limits) {
  app.add_option_function<std::uint64_t>("--import-memory", [&limits](const std::uint64_t& mib) { limits.memory_bytes = mib << 20; },
                                         "most memory for reading a mesh file; default 2048 MiB and 20 times the file's size")
      ->check(CLI::Range(std::uint64_t{1}, std::uint64_t{1} << 24).description(""))
      ->type_name("MIB");
  app.add_option_function<double>("--import-seconds", number_within("--import-seconds", 1, 1e6, limits.seconds), "most processor time for reading a mesh file; default 20 s and 1 s a MiB, 60 s and 10 s a MiB for STEP, IGES, BREP")
      ->type_name("S");
}

void add_units(CLI::App& app, std::optional<double>& unit_m, const char* help) {
  static const std::map<std::string, double> kUnits{{"m", 1}, {"mm", 1e-3}, {"cm", 1e-2}, {"in", 0.0254}};
  app.add_option_function<std::string>("--units", [&unit_m](const std::string& word) { unit_m = kUnits.at(word); }, help)->check(one_of({"m", "mm", "cm", "in"}))->type_name("m|mm|cm|in");
}

void add_tessellation(CLI::App& app, Tessellation& tessellation) {
  app.add_option_function<double>("--tessellation", number_within("--tessellation", 1e-9, 100, tessellation.deflection_m),
                                  "the farthest that triangles lie from the surfaces of a STEP, IGES or BREP file; default 1/384 of its longest side")
      ->type_name("M");
  app.add_option_function<double>("--tessellation-angle", number_within("--tessellation-angle", 1, 90, tessellation.angle_deg), "most between neighbouring triangles of one surface; default 15")
      ->type_name("DEG");
}

void add_scene(CLI::App& app, SceneOptions& options) {
  app.add_option("scene", options.scene, "scene file (JSON)")->required()->type_name("SCENE");
  add_import_limits(app, options.import);
  add_units(app, options.unit_m, "unit of mesh files for which neither they nor the scene state one; without it metres");
}

/// `--profile` and `--plan`, which read words and leave enumerators.
void add_method(CLI::App& app, SceneOptions& options) {
  app.add_option_function<std::string>(
         "--profile",
         [&options](const std::string& word) { options.profile = word == "paper" ? Profile::kPaper : Profile::kRefined; },
         "paper: the chapter to the letter; refined: its faults mended; in place of the scene's")
      ->check(one_of({"paper", "refined"}))
      ->type_name("paper|refined");
  app.add_option_function<std::string>(
         "--plan", [&options](const std::string& word) { options.full_plan = word == "full"; },
         "auto: leave out the stages that the scene does not need; full: keep all; the answer is the same")
      ->check(one_of({"auto", "full"}))
      ->type_name("auto|full");
}

std::size_t edit_distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({replaced, row[j] + 1, row[j - 1] + 1});
    }
  }
  return row[b.size()];
}

/// One sentence for a first word that is no command.
std::string unknown_command(const std::string& word, const std::vector<std::string>& commands) {
  const auto nearest = std::min_element(commands.begin(), commands.end(), [&](const auto& a, const auto& b) {
    return edit_distance(word, a) < edit_distance(word, b);
  });
  std::string list;
  for (const std::string& command : commands) list += (list.empty() ? "" : ", ") + command;
  const std::string guess = edit_distance(word, *nearest) <= 2 ? fmt::format("; did you mean '{}'?", *nearest) : "";
  return fmt::format("'{}' is no command of this version (there are {}){}", word, list, guess);
}

int fail(const Error& error) {
  std::fprintf(stderr, "palpate: %s\n", one_line(error.sentence).c_str());
  return static_cast<int>(error.code);
}

/// CLI11's exceptions as one sentence: a value that was refused is 3, any other mistake 2.
int fail_parse(const CLI::ParseError& error, const CLI::App& app) {
  const bool value = error.get_name() == "ConversionError" || error.get_name() == "ValidationError";
  std::string sentence = error.what();
  std::replace(sentence.begin(), sentence.end(), '\n', ' ');
  const auto used = app.get_subcommands();
  const std::string command = used.empty() ? std::string("palpate") : "palpate " + used.front()->get_name();
  return fail({value ? ErrorCode::kBadValue : ErrorCode::kUsage, fmt::format("{} (see {} --help)", sentence, command)});
}

int parse_and_run(int argc, const char* const* argv, const Parts& parts) {
  CLI::App app(kAbout, "palpate");
  app.footer(kFooter);
  app.set_version_flag("--version", "palpate " PALPATE_VERSION, "tell the version");
  app.set_help_flag("-h,--help", "tell how to use it");
  app.get_formatter()->column_width(38);

  Result<void> outcome;

  RunOptions run;
  CLI::App* run_app = app.add_subcommand("run", "run the 1 kHz loop with a device and leave trace, frames, summary and report");
  add_scene(*run_app, run.common);
  add_backend(*run_app, run.common);
  run_app->add_option_function<std::string>("--pace", [&](const std::string& word) { run.asap = word == "asap"; },
                                            "realtime: by the clock (default); asap: virtual time, reproducible")
      ->check(one_of({"realtime", "asap"}))
      ->type_name("realtime|asap");
  add_method(*run_app, run.common);
  run_app->add_option("--device", run.device, "haptic device by name, in place of the scene's (palpate devices lists them); replay:FILE: a recorded trace.csv")->type_name("NAME");
  run_app->add_option("--firmware", run.firmware, "firmware file for a device that needs one")->type_name("FILE");
  run_app->add_option("--duration", run.duration_s, "seconds; without it to the end of the path")
      ->type_name("S");
  run_app->add_option("--switch", run.switches, "SECONDS:WORD, again and again: then go over to profile paper or refined, or plan full or auto, without a missed tick")
      ->type_name("S:WORD");
  run_app->add_option("--out", run.out, "directory for the files; default a fresh palpate-run-…")->type_name("DIR");
  run_app->footer(kRunFooter);
  run_app->callback([&] { outcome = run_command(run, parts); });

  QueryOptions query;
  CLI::App* query_app = app.add_subcommand("query", "answer poses: contact sets, areas, force and torque, as JSON lines");
  add_scene(*query_app, query.common);
  auto* pose = query_app->add_option("--pose", query.pose, "one pose, world from tool: metres and a unit quaternion")
                   ->type_name("\"x y z qx qy qz qw\"");
  auto* poses = query_app->add_option("--poses", query.poses, "CSV file of poses")->type_name("FILE.csv");
  pose->excludes(poses);
  add_backend(*query_app, query.common);
  add_method(*query_app, query.common);
  query_app->add_option("--batch", query.batch, "answer N poses together, on all cores; time_us is then a pose's share")
      ->check(CLI::Range(std::uint64_t{1}, std::uint64_t{1000000}).description(""))
      ->type_name("N");
  query_app->add_flag("--names", query.names, "parts: which named parts touch");
  query_app->add_option("--export-geometry", query.export_directory, "write the judged integers there")->type_name("DIR");
  query_app->footer(kQueryFooter);
  query_app->callback([&] { outcome = query_command(query, parts); });

  SceneOptions plan;
  bool plan_json = false;
  CLI::App* plan_app = app.add_subcommand("plan", "tell which stages a run of the scene needs, and why");
  add_scene(*plan_app, plan);
  plan_app->add_flag("--json", plan_json, "{\"stages\":[{\"stage\",\"kept\",\"reason\",\"memory_bytes\"}]}");
  plan_app->footer("Leaving a stage out never changes an answer; `--plan full` of run and query keeps them all, to compare.");
  plan_app->callback([&] { outcome = plan_command(plan, plan_json, parts); });

  InfoOptions info;
  CLI::App* info_app = app.add_subcommand("info", "tell what is in mesh files and what import made of them; of a scene, how its tool starts");
  info_app->add_option("files", info.files, "STL, OBJ, PLY, OFF, glTF/GLB, DAE, 3MF, STEP, IGES, BREP, …; or a scene, .json")->required()->type_name("MESH|SCENE");
  info_app->add_flag("--tree", info.tree, "parts as the hierarchy that the file has");
  info_app->add_flag("--json", info.json, "one JSON object");
  add_units(*info_app, info.unit_m, "unit of the files, which then are told in metres; not for STEP, IGES and 3MF, which state theirs");
  add_import_limits(*info_app, info.import);
  add_tessellation(*info_app, info.tessellation);
  info_app->footer("A part's path, its last name where that is unique, its other name, or its number, \"#3\", is what `part` and `without` of a scene file name.\n"
                   "Sizes are in metres where the file states its unit (STEP, IGES, 3MF), its format has one (COLLADA, glTF) or --units says it, else in the file's own.");
  info_app->callback([&] { outcome = info_command(info, parts); });

  GenerateOptions generate;
  CLI::App* generate_app = app.add_subcommand("generate", "make one of the chapter's scenes: contacts or disassembly");
  generate_app->add_option("name", generate.name, "contacts (section 4.1) or disassembly (section 4.2)")->required()->type_name("NAME");
  generate_app->add_option("--triangles", generate.triangles, "of the mock-up, 1,000 to 10,000,000; default the chapter's 25,000 or 100,000")
      ->type_name("N");
  generate_app->add_option("--tool-triangles", generate.tool_triangles, "of the tool; default the chapter's 1,500 or 2,000")->type_name("N");
  generate_app->add_option("--out", generate.out, "directory for meshes, path and scene.json")->required()->type_name("DIR");
  generate_app->footer("Writes the meshes as files, so that any of them can be exchanged for a part of yours.\n\nExamples:\n"
                       "  palpate generate disassembly --out try\n"
                       "  palpate generate contacts --triangles 1000000 --out big");
  generate_app->callback([&] { outcome = generate_command(generate); });

  CLI::App* devices_app = app.add_subcommand("devices", "list Vulkan and haptic devices, with the reason for each that can't be used");
  devices_app->footer("Of several usable Vulkan devices the best is taken; the back end's name is in the summary of a run.");
  devices_app->callback([&] { outcome = devices_command(parts); });

  ServeOptions serve;
  add_serve_command(app, serve, parts, outcome);

  TuneOptions tune;
  add_tune_command(app, tune, parts, outcome);

  BenchOptions bench;
  add_bench_command(app, bench, parts, outcome);

  std::vector<std::string> commands;
  for (const CLI::App* command : app.get_subcommands({})) commands.push_back(command->get_name());
  if (argc < 2) {
    std::fputs(app.help().c_str(), stderr);
    return static_cast<int>(ErrorCode::kUsage);
  }
  const std::string first = argv[1];
  if (!first.starts_with('-') && std::find(commands.begin(), commands.end(), first) == commands.end())
    return fail({ErrorCode::kUsage, unknown_command(first, commands)});

  try {
    app.parse(argc, argv);
  } catch (const CLI::CallForHelp&) {
    const auto used = app.get_subcommands();
    std::fputs((used.empty() ? app.help() : used.front()->help("palpate")).c_str(), stdout);
    return 0;
  } catch (const CLI::CallForVersion& version) {
    std::printf("%s\n", version.what());
    return 0;
  } catch (const CLI::ParseError& error) {
    return fail_parse(error, app);
  }
  if (app.get_subcommands().empty()) return fail({ErrorCode::kUsage, "a command is missing (see palpate --help)"});
  return outcome ? 0 : fail(outcome.error());
}

}  // namespace

int command_line(int argc, const char* const* argv, const Parts& parts) noexcept {
  // What libraries throw ends here as one sentence.
  try {
    const int code = parse_and_run(argc, argv, parts);
    if (std::fflush(stdout) != 0 && code == 0) return fail({ErrorCode::kInternal, "standard output can't be written"});
    return code;
  } catch (const std::bad_alloc&) {
    std::fputs("palpate: there is not enough memory for this scene\n", stderr);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "palpate: an unforeseen error: %s\n", error.what());
  } catch (...) {
    std::fputs("palpate: an unforeseen error of unknown kind\n", stderr);
  }
  return static_cast<int>(ErrorCode::kInternal);
}

}  // namespace palpate
