#include "service/cli/cli.h"

#include <fmt/format.h>
#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <CLI/Validators.hpp>

#include <algorithm>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <map>
#include <new>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "generated/commit.h"
#include "model/files/one_line.h"
#include "service/bench/bench.h"
#include "service/cli/compare.h"
#include "service/cli/console.h"
#include "service/cli/manual.h"
#include "service/cli/number_range.h"
#include "service/cli/output_folder.h"
#include "service/cli/path.h"
#include "service/cli/serve.h"
#include "service/cli/text_output.h"
#include "service/cli/tune.h"

namespace palpate {
namespace {

constexpr const char* kAbout =
    "palpate finds where a tool touches a large mock-up of triangles, works out the force and torque that a "
    "hand should\n"
    "feel, and keeps a 1 kHz haptic device fed with them.";

constexpr const char* kFooter =
    R"(Units are SI: metres, newtons, newton metres, seconds. A pose is `x y z qx qy qz qw`, world from tool, with a unit quaternion.
The result goes to standard output, progress and messages to standard error.

Exit codes: 0 done; 2 wrong usage; 3 a bad value in a file or an argument; 4 no usable device; 5 a path is not clear; 1 anything else.

A first quarter of an hour, as README.md has it:
  palpate generate disassembly --triangles 20000 --out engine      stands for a mesh of yours: mock-up, tool, scene
  palpate info engine/mockup.stl                                   what was read: parts, size, closed or open
  palpate query engine/scene.json --pose "0 0 0 0 0 0 1"           contact, force and torque at one pose
  palpate query engine/scene.json --pose "0.1 0 0 0 0 0 1" --clearance   how far apart, where, between which parts
  palpate plan engine/scene.json                                   what this scene needs, and why
  palpate run engine/scene.json --pace asap --out run              the whole task; then open run/report.html

`palpate help COMMAND` tells more; `palpate devices` what can compute here and what can be felt.)";

constexpr const char* kRunFooter =
    R"(DIR then holds trace.csv (a row a tick), frames.jsonl (an answered pose a line), summary.json and report.html
(one page with the plots, opens anywhere). The summary is printed too.
SIGINT (Ctrl-C) or SIGTERM ends the run with zero force and complete files.

With --pace realtime the loop keeps to the clock at 1 kHz and a result is as old as it happens to be. With --pace asap
time is virtual: as fast as the machine goes, a result control.virtual_delay_ticks old when it comes, trace.csv the same bytes every time.
The first line of the summary says whether this machine kept up, or would have.

Examples:
  palpate run scenes/disassembly.json --pace asap --out a
  palpate run scenes/contacts.json --backend cpu --duration 2)";

constexpr const char* kQueryFooter =
    R"(At a terminal it prints what touches, how deep and with which force. Elsewhere, with --json, --any, --clearance or --within, it prints one JSON object a pose:
number (from 0), pose, contact, pairs, cst bst cmt bmt imt est (triangle ids), areas (id, zones, static, mobile, normal, depth m,
point m, force N, torque N·m, flags), force, torque (about the tool's centre of mass), flags, truncated, time_us.
force and torque are what a hand at rest there feels, through its spring. An area's are for looking at: of the pose itself, from the mock-up's samples alone, so they add up to something else.
With --names also parts: the paths of the mock-up's and of the tool's parts that touch, as palpate info has them.
A file of poses is CSV with the header x,y,z,qx,qy,qz,qw, or a scene's path, or a run's trace. A pose far away is free of contact; only one that is not finite or
not a unit rotation is an error (exit code 3).

--export-geometry writes what was judged, on the integer lattice, for other software to check: lattice.json, static.i32,
tool_<pose>.i32, voxels.json, voxels.u8, and what it came to: pairs_<pose>.u32 (static and mobile id of each intersecting pair).

Examples:
  palpate query scene.json --pose "0.1 0 0.25 0 0 0 1"
  palpate query scene.json --poses poses.csv --backend cpu > cpu.jsonl)";

/// A closed list of words; the help shows them as the option's type already.
CLI::Validator one_of(const std::vector<std::string>& words) { return CLI::IsMember(words).description(""); }

CLI::Option* add_backend(CLI::App& app, SceneOptions& options) {
  return app
      .add_option(
          "--backend", options.backend,
          "the engine that answers: gpu, everything in shaders; cpu, native code on this processor; "
          "ref, the reference; auto: where there is a GPU, the quicker one of gpu and cpu at a few poses "
          "near the start, else cpu, with a sentence on standard error; an engine that can't take the scene "
          "(cpu knows no profile paper) is replaced by one that can, likewise (auto)")
      ->check(one_of({"auto", "gpu", "cpu", "ref"}))
      ->type_name("auto|gpu|cpu|ref");
}

void add_import_limits(CLI::App& app, ImportLimits& limits) {
  app.add_option_function<std::uint64_t>(
         "--import-memory", [&limits](const std::uint64_t& mib) { limits.memory_bytes = mib << 20; },
         "most memory for reading a mesh file; default 2048 MiB and 20 times the file's size, 100 times "
         "for STEP, IGES, BREP")
      ->check(CLI::Range(std::uint64_t{1}, std::uint64_t{1} << 24).description(""))
      ->type_name("MIB");
  app.add_option_function<double>("--import-seconds",
                                  number_within("--import-seconds", 1, 1e6, limits.seconds),
                                  "most processor time for reading a mesh file; default 20 s and 1 s a MiB, "
                                  "60 s and 10 s a MiB for STEP, IGES, BREP")
      ->type_name("S");
}

void add_units(CLI::App& app, std::optional<double>& unit_m, const char* help) {
  static const std::map<std::string, double> kUnits{{"m", 1}, {"mm", 1e-3}, {"cm", 1e-2}, {"in", 0.0254}};
  app.add_option_function<std::string>(
         "--units", [&unit_m](const std::string& word) { unit_m = kUnits.at(word); }, help)
      ->check(one_of({"m", "mm", "cm", "in"}))
      ->type_name("m|mm|cm|in");
}

void add_tessellation(CLI::App& app, Tessellation& tessellation) {
  app.add_option_function<double>("--tessellation",
                                  number_within("--tessellation", 1e-9, 100, tessellation.deflection_m),
                                  "the farthest that triangles lie from the surfaces of a STEP, IGES or BREP "
                                  "file; default 1/384 of its longest side")
      ->type_name("M");
  app.add_option_function<double>("--tessellation-angle",
                                  number_within("--tessellation-angle", 1, 90, tessellation.angle_deg),
                                  "most between neighbouring triangles of one surface; default 15")
      ->type_name("DEG");
}

void add_scene(CLI::App& app, SceneOptions& options) {
  app.add_option("scene", options.scene, "scene file (JSON)")->required()->type_name("SCENE");
  add_import_limits(app, options.import);
  add_units(app, options.unit_m,
            "unit of mesh files for which neither they nor the scene state one; without it metres");
}

/// `--profile` and `--plan`, which read words and leave enumerators.
void add_method(CLI::App& app, SceneOptions& options) {
  app.add_option_function<std::string>(
         "--profile",
         [&options](const std::string& word) {
           options.profile = word == "paper" ? Profile::kPaper : Profile::kRefined;
         },
         "paper: the chapter to the letter; refined: its faults mended; in place of the scene's")
      ->check(one_of({"paper", "refined"}))
      ->type_name("paper|refined");
  app.add_option_function<std::string>(
         "--plan", [&options](const std::string& word) { options.full_plan = word == "full"; },
         "auto: leave out the stages that the scene does not need; full: keep all; the answer is the same")
      ->check(one_of({"auto", "full"}))
      ->type_name("auto|full");
}

/// One sentence for a first word that is no command.
std::string unknown_command(const std::string& word, const std::vector<std::string>& commands) {
  std::string list;
  for (const std::string& command : commands) list += (list.empty() ? "" : ", ") + command;
  const std::string nearest = nearest_word(word, commands);
  return fmt::format("'{}' is no command of this version (there are {}){}", word, list,
                     nearest.empty() ? "" : fmt::format("; did you mean '{}'?", nearest));
}

int fail(const Error& error) {
  std::fprintf(stderr, "palpate: %s\n", one_line(error.sentence).c_str());
  return static_cast<int>(error.code);
}

/// CLI11's exceptions as one sentence: a value that was refused is 3, any other mistake 2.
int fail_parse(const CLI::ParseError& error, const CLI::App& app) {
  const CLI::App* command = &app;
  std::string name = "palpate";
  for (auto used = command->get_subcommands(); !used.empty(); used = command->get_subcommands()) {
    command = used.front();
    name += " " + command->get_name();
  }
  const bool value = error.get_name() == "ConversionError" || error.get_name() == "ValidationError";
  std::string sentence = error.get_exit_code() == static_cast<int>(CLI::ExitCodes::ExtrasError)
                             ? unexpected_words(*command, name, app.remaining(true))
                             : error.what();
  std::replace(sentence.begin(), sentence.end(), '\n', ' ');
  return fail(
      {value ? ErrorCode::kBadValue : ErrorCode::kUsage, fmt::format("{} (see {} --help)", sentence, name)});
}

/// All on one line, for bug reports.
std::string version_text() {
  return "palpate " PALPATE_VERSION ", commit " PALPATE_COMMIT ", engines gpu, cpu, ref";
}

/// `--quiet` for every command.
void add_quiet(CLI::App& app) {
  for (CLI::App* command : app.get_subcommands({})) {
    command->add_flag_callback(
        "-q,--quiet", [] { Console::be_quiet(); },
        "no progress and no messages but errors, and what the person at the device has to do");
    add_quiet(*command);
  }
}

/// Pages for `man`, a file a command.
Result<void> write_manual(const CLI::App& app, const std::string& folder) {
  if (const std::string wrong = cannot_write_to(folder); !wrong.empty()) return bad_value("--out " + wrong);
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  std::vector<std::string> commands{""};
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
    commands.push_back(command->get_name());
  for (const std::string& command : commands) {
    const std::filesystem::path file =
        std::filesystem::path(folder) / ((command.empty() ? "palpate" : "palpate-" + command) + ".1");
    std::ofstream out(file, std::ios::binary | std::ios::trunc);
    out << manual_page(app, command, PALPATE_VERSION);
    out.flush();
    if (!out) return bad_value(fmt::format("{}: the file can't be written", file.string()));
  }
  return {};
}

/// `palpate help COMMAND …` is `palpate COMMAND … --help`.
std::vector<const char*> without_help(int argc, const char* const* argv) {
  std::vector<const char*> words(argv, argv + argc);
  if (argc < 2 || std::string_view(argv[1]) != "help") return words;
  words.erase(words.begin() + 1);
  words.push_back("--help");
  return words;
}

struct PlanOptions {
  SceneOptions scene;
  bool json = false;
};
struct ManOptions {
  std::string page;    ///< of this command; empty: the program's
  std::string folder;  ///< for the pages of all commands; empty: none
};

void add_run_command(CLI::App& app, RunOptions& run, const Parts& parts, Result<void>& outcome) {
  CLI::App* run_app = app.add_subcommand(
      "run", "run the 1 kHz loop with a device and leave trace, frames, summary and report");
  add_scene(*run_app, run.common);
  add_backend(*run_app, run.common);
  run_app
      ->add_option_function<std::string>(
          "--pace", [&](const std::string& word) { run.asap = word == "asap"; },
          "realtime: by the clock (default); asap: virtual time, reproducible")
      ->check(one_of({"realtime", "asap"}))
      ->type_name("realtime|asap");
  add_method(*run_app, run.common);
  run_app
      ->add_option("--device", run.device,
                   "haptic device by name, in place of the scene's (palpate devices lists them); "
                   "replay:FILE: a recorded trace.csv")
      ->type_name("NAME");
  run_app->add_option("--firmware", run.firmware, "firmware file for a device that needs one")
      ->type_name("FILE");
  run_app->add_option("--duration", run.duration_s, "seconds; without it to the end of the path")
      ->type_name("S");
  run_app
      ->add_option("--switch", run.switches,
                   "SECONDS:WORD, again and again: then go over to profile paper or refined, or plan full or "
                   "auto, without a missed tick")
      ->type_name("S:WORD");
  run_app->add_option("--out", run.out, "directory for the files; default a fresh palpate-run-…")
      ->type_name("DIR");
  run_app->add_flag("--overwrite", run.overwrite, "replace the files of a run that is in --out already");
  run_app->footer(kRunFooter);
  run_app->callback([&] { outcome = run_command(run, parts); });
}

void add_query_command(CLI::App& app, QueryOptions& query, const Parts& parts, Result<void>& outcome) {
  CLI::App* query_app = app.add_subcommand(
      "query", "answer poses: contact sets, areas, force and torque, for people or as JSON lines");
  add_scene(*query_app, query.common);
  auto* pose =
      query_app->add_option("--pose", query.pose, "one pose, world from tool: metres and a unit quaternion")
          ->type_name("\"x y z qx qy qz qw\"");
  auto* poses = query_app->add_option("--poses", query.poses, "CSV file of poses")->type_name("FILE.csv");
  pose->excludes(poses);
  add_backend(*query_app, query.common);
  add_method(*query_app, query.common);
  auto* batch =
      query_app
          ->add_option(
              "--batch", query.batch,
              "answer N poses together, on all cores, or as many as it takes in a submission of a device;"
              " time_us is then a pose's share")
          ->check(CLI::Range(std::uint64_t{1}, std::uint64_t{1000000}).description(""))
          ->type_name("N");
  auto* names = query_app->add_flag("--names", query.names, "parts: which named parts touch");
  query_app->add_flag("--json", query.json,
                      "one JSON object a pose at a terminal, too; elsewhere that is so anyway");
  auto* geometry =
      query_app->add_option("--export-geometry", query.export_directory, "write the judged integers there")
          ->type_name("DIR");
  query_app->add_flag("--overwrite", query.overwrite, "replace an export that is there already")
      ->needs(geometry);
  auto* any = query_app->add_flag("--any", query.any,
                                  "touch or not alone, containment included: number, engine and touches");
  auto* clearance =
      query_app->add_flag("--clearance", query.clearance,
                          "the smallest distance alone, exact to the lattice step below it: "
                          "clearance m (null: beyond the lattice; 0 is free by less than a step "
                          "where touches is false), static and mobile triangle, their points "
                          "and parts");
  auto* within =
      query_app
          ->add_option_function<double>(
              "--within",
              [&query](const double& value) {
                if (!(value >= 0 && value <= 100))
                  throw CLI::ValidationError("--within", fmt::format("{} is not from 0 to 100", value));
                query.within_m = value;
              },
              "near-miss check: --clearance of the poses that are no further than M metres, and no others")
          ->type_name("M");
  query_app
      ->add_option_function<double>("--tolerance", number_within("--tolerance", 0, 100, query.tolerance_m),
                                    "with --any or --clearance: a contact no deeper than M metres does not "
                                    "count; rounded down to steps of the lattice")
      ->type_name("M");
  any->excludes(clearance)->excludes(within);
  for (CLI::Option* verdict : {any, clearance, within})  // whose lines have none of it
    for (CLI::Option* of_frames : {batch, names, geometry}) verdict->excludes(of_frames);
  query_app->footer(kQueryFooter);
  query_app->callback([&] { outcome = query_command(query, parts); });
}

void add_plan_command(CLI::App& app, PlanOptions& plan, const Parts& parts, Result<void>& outcome) {
  CLI::App* plan_app = app.add_subcommand("plan", "tell which stages a run of the scene needs, and why");
  add_scene(*plan_app, plan.scene);
  plan_app->add_flag("--json", plan.json, "{\"stages\":[{\"stage\",\"kept\",\"reason\",\"memory_bytes\"}]}");
  plan_app->footer(
      "Leaving a stage out never changes an answer; `--plan full` of run and query keeps them all, to "
      "compare.");
  plan_app->callback([&] { outcome = plan_command(plan.scene, plan.json, parts); });
}

void add_info_command(CLI::App& app, InfoOptions& info, const Parts& parts, Result<void>& outcome) {
  CLI::App* info_app = app.add_subcommand(
      "info", "tell what is in mesh files and what import made of them; of a scene, how its tool starts");
  info_app
      ->add_option("files", info.files,
                   "STL, OBJ, PLY, OFF, glTF/GLB, DAE, 3MF, STEP, IGES, BREP, …; or a scene, .json")
      ->required()
      ->type_name("MESH|SCENE");
  info_app->add_flag("--tree", info.tree, "parts as the hierarchy that the file has");
  info_app->add_flag("--json", info.json, "one JSON object");
  add_units(
      *info_app, info.unit_m,
      "unit of the files, which then are told in metres; not for STEP, IGES and 3MF, which state theirs");
  add_import_limits(*info_app, info.import);
  add_tessellation(*info_app, info.tessellation);
  info_app->footer(
      "A part's path, its last name where that is unique, its other name, or its number, \"#3\", is what "
      "`part` and `without` of a scene file name.\n"
      "Sizes are in metres where the file states its unit (STEP, IGES, 3MF), its format has one (COLLADA, "
      "glTF) or --units says it, else in the file's own.");
  info_app->callback([&] { outcome = info_command(info, parts); });
}

void add_generate_command(CLI::App& app, GenerateOptions& generate, Result<void>& outcome) {
  CLI::App* generate_app =
      app.add_subcommand("generate", "make one of the chapter's scenes: contacts or disassembly");
  generate_app->add_option("name", generate.name, "the scene of section 4.1 or of section 4.2")
      ->required()
      ->type_name("contacts|disassembly");
  generate_app
      ->add_option("--triangles", generate.triangles,
                   "of the mock-up, 1,000 to 10,000,000; default the chapter's 25,000 or 100,000")
      ->check(CLI::Range(std::uint64_t{1'000}, std::uint64_t{10'000'000}).description(""))
      ->type_name("N");
  generate_app
      ->add_option("--tool-triangles", generate.tool_triangles,
                   "of the tool, likewise; default the chapter's 1,500 or 2,000")
      ->check(CLI::Range(std::uint64_t{1'000}, std::uint64_t{10'000'000}).description(""))
      ->type_name("N");
  generate_app->add_option("--out", generate.out, "directory for meshes, path and scene.json")
      ->required()
      ->type_name("DIR");
  generate_app->add_flag("--overwrite", generate.overwrite,
                         "replace the files of a scene that are in --out already");
  generate_app->footer(
      "Writes the meshes as files, so that any of them can be exchanged for a part of yours.\n\nExamples:\n"
      "  palpate generate disassembly --out try\n"
      "  palpate generate contacts --triangles 1000000 --out big");
  generate_app->callback([&] { outcome = generate_command(generate); });
}

void add_devices_command(CLI::App& app, const Parts& parts, Result<void>& outcome) {
  CLI::App* devices_app = app.add_subcommand(
      "devices", "list Vulkan and haptic devices, with the reason for each that can't be used");
  devices_app->footer(
      "Of several usable Vulkan devices the best is taken; the back end's name is in the summary of a run.");
  devices_app->callback([&] { outcome = devices_command(parts); });
}

void add_completions_command(CLI::App& app, std::string& shell, Result<void>& outcome) {
  CLI::App* completions_app = app.add_subcommand("completions", "print the completion script of a shell");
  completions_app->add_option("shell", shell, "which one")
      ->required()
      ->check(one_of({"bash", "zsh", "fish"}))
      ->type_name("bash|zsh|fish");
  completions_app->footer(
      "Examples:\n  source <(palpate completions bash)\n  palpate completions fish > "
      "~/.config/fish/completions/palpate.fish");
  completions_app->callback([&] { outcome = print_text(completion_script(app, shell)); });
}

void add_man_command(CLI::App& app, ManOptions& options, Result<void>& outcome) {
  CLI::App* man_app = app.add_subcommand("man", "print a manual page, or write them all");
  auto* page_option =
      man_app->add_option("command", options.page, "whose; without it the program's")->type_name("COMMAND");
  man_app
      ->add_option("--out", options.folder,
                   "folder for the pages of all commands, palpate.1, palpate-run.1, …")
      ->type_name("DIR")
      ->excludes(page_option);
  man_app->footer("Example:\n  palpate man run | man -l -");
  man_app->callback([&] {
    if (!options.folder.empty()) {
      outcome = write_manual(app, options.folder);
      return;
    }
    const std::string text = manual_page(app, options.page, PALPATE_VERSION);
    outcome = text.empty()
                  ? Result<void>(Error{
                        ErrorCode::kUsage,
                        fmt::format("'{}' is no command of palpate (see palpate --help)", options.page)})
                  : print_text(text);
  });
}

/// Reads the words and runs the command's callback. An exit code where that is all there is to do.
std::optional<int> parse(CLI::App& app, int argc, const char* const* argv) {
  std::vector<std::string> commands;
  for (const CLI::App* command : app.get_subcommands({})) commands.push_back(command->get_name());
  if (argc < 2) {
    std::fputs(app.help().c_str(), stderr);
    return static_cast<int>(ErrorCode::kUsage);
  }
  const std::vector<const char*> words = without_help(argc, argv);
  const std::string first = words[1];
  if (!first.starts_with('-') && std::find(commands.begin(), commands.end(), first) == commands.end())
    return fail({ErrorCode::kUsage, unknown_command(first, commands)});

  try {
    app.parse(static_cast<int>(words.size()), words.data());
  } catch (const CLI::CallForHelp&) {
    std::string name = "palpate";
    const CLI::App* command = &app;
    for (auto used = command->get_subcommands(); !used.empty(); used = command->get_subcommands()) {
      if (command != &app) name += " " + command->get_name();
      command = used.front();
    }
    std::fputs((command == &app ? app.help() : command->help(name)).c_str(), stdout);
    return 0;
  } catch (const CLI::CallForVersion& version) {
    std::printf("%s\n", version.what());
    return 0;
  } catch (const CLI::ParseError& error) {
    return fail_parse(error, app);
  }
  if (app.get_subcommands().empty())
    return fail({ErrorCode::kUsage, "a command is missing (see palpate --help)"});
  return std::nullopt;
}

int parse_and_run(int argc, const char* const* argv, const Parts& parts) {
  CLI::App app(kAbout, "palpate");
  app.footer(std::string(kFooter) + "\n\n" + kEnvironmentText);
  app.set_version_flag("-V,--version", version_text(), "tell the version, the commit and the engines");
  app.set_help_flag("-h,--help", "tell how to use it");
  app.require_subcommand(0, 1);  // a scene may be called like a command
  app.get_formatter()->column_width(38);

  Result<void> outcome;
  RunOptions run;
  QueryOptions query;
  PathOptions path;
  CompareOptions compare;
  PlanOptions plan;
  InfoOptions info;
  GenerateOptions generate;
  ServeOptions serve;
  TuneOptions tune;
  BenchOptions bench;
  std::string shell;
  ManOptions manual;
  add_run_command(app, run, parts, outcome);
  add_query_command(app, query, parts, outcome);
  add_path_command(app, path, parts, outcome);
  add_compare_command(app, compare, outcome);
  add_plan_command(app, plan, parts, outcome);
  add_info_command(app, info, parts, outcome);
  add_generate_command(app, generate, outcome);
  add_devices_command(app, parts, outcome);
  add_serve_command(app, serve, parts, outcome);
  add_tune_command(app, tune, parts, outcome);
  add_bench_command(app, bench, parts, outcome);
  add_completions_command(app, shell, outcome);
  add_man_command(app, manual, outcome);
  add_quiet(app);

  if (const std::optional<int> code = parse(app, argc, argv)) return *code;
  return outcome ? 0 : fail(outcome.error());
}

}  // namespace

int command_line(int argc, const char* const* argv, const Parts& parts) noexcept {
  // What libraries throw ends here as one sentence.
  try {
    const int code = parse_and_run(argc, argv, parts);
    if (std::fflush(stdout) != 0 && code == 0)
      return fail({ErrorCode::kInternal, "standard output can't be written"});
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
