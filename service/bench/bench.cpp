#include "service/bench/bench.h"

#include <fmt/format.h>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <CLI/Validators.hpp>

#include "service/cli/console.h"
#include "service/cli/number_range.h"
#include "service/cli/output_folder.h"

namespace palpate {
namespace {

constexpr const char* kFooter =
    R"(Times are wall time in microseconds unless a column says otherwise, or --clock. Whatever is compared is measured in turns in one process, for other
work on the machine moves absolute figures; trust ratios of one run. Every file names machine, driver and commit.

Examples:
  palpate generate disassembly --triangles 1000000 --out big
  palpate bench latency big/scene.json --out figures
  palpate bench peers big/scene.json --out figures        (needs a build with -DPALPATE_BENCH_PEERS=ON, see scripts/bench))";

CLI::Validator one_of(const std::vector<std::string>& words) { return CLI::IsMember(words).description(""); }

const std::vector<std::string> kEngines = {"auto", "gpu", "cpu", "ref"};

constexpr const char* kResultFiles[] = {"results.csv", "results.json", "report.html"};

void add_out(CLI::App& app, BenchOptions& options) {
  app.add_option("--out", options.out, "directory for results.csv, results.json, report.html")
      ->required()
      ->type_name("DIR");
  app.add_flag("--overwrite", options.overwrite, "replace the results of a bench that are in --out already");
}

void add_common(CLI::App& app, BenchOptions& options, bool scenes_required = true) {
  app.add_option("scenes", options.scenes, "scene files (JSON)")
      ->required(scenes_required)
      ->type_name("SCENE");
  add_out(app, options);
  app.add_option_function<std::string>(
         "--profile",
         [&options](const std::string& word) {
           options.profile = word == "paper" ? Profile::kPaper : Profile::kRefined;
         },
         "in place of the scenes'")
      ->check(one_of({"paper", "refined"}))
      ->type_name("paper|refined");
}

void add_clock(CLI::App& app, BenchOptions& options, const char* help) {
  app.add_option_function<std::string>(
         "--clock", [&options](const std::string& word) { options.cpu_clock = word == "cpu"; }, help)
      ->check(one_of({"wall", "cpu"}))
      ->type_name("wall|cpu");
}

void add_rounds(CLI::App& app, BenchOptions& options, const char* help) {
  app.add_option("--rounds", options.rounds, help)
      ->check(CLI::Range(std::uint64_t{1}, std::uint64_t{10000}).description(""))
      ->type_name("N");
}

/// One engine, or several, which a bench goes through as `when` says.
void add_backends(CLI::App& app, BenchOptions& options, const char* when) {
  app.add_option("--backend", options.backends,
                 fmt::format("the engine, or several {}, as for run (auto)", when))
      ->check(one_of(kEngines))
      ->expected(1, 3)
      ->type_name("auto|gpu|cpu|ref");
}

void add_one_backend(CLI::App& app, BenchOptions& options) {
  app.add_option("--backend", options.backends, "the engine, as for run (auto)")
      ->check(one_of(kEngines))
      ->expected(1)
      ->type_name("auto|gpu|cpu|ref");
}

void add_poses(CLI::App& app, BenchOptions& options) {
  app.add_option("--poses", options.poses,
                 "poses, as for query; `run`: those of a run in virtual time; without it the path's, deeper "
                 "than a hand gets")
      ->type_name("FILE|run");
  app.add_option("--frames", options.frames, "poses taken from them, evenly (400)")
      ->check(CLI::Range(std::uint64_t{1}, std::uint64_t{1000000}).description(""))
      ->type_name("N");
  add_clock(app, options,
            "wall, or cpu: time that this process itself ran, for machines that do other work, too (wall)");
  add_rounds(app, options, "times that all poses are gone through (3)");
}

/// Adds the benches to `bench`, a function each.
class Benches {
 public:
  Benches(CLI::App& bench, BenchOptions& options, const Parts& parts, Result<void>& outcome)
      : bench_(bench), options_(options), parts_(parts), outcome_(outcome) {}

  void add_all() {
    add_latency();
    add_throughput();
    add_scale();
    add_prepare();
    add_error();
    add_peers();
    add_questions();
    add_stability();
    add_plan();
    add_numerics();
    add_force();
    add_jitter();
  }

 private:
  /// --out is looked at before anything is measured, which takes minutes.
  void measure_now(Result<void> (*run)(const BenchOptions&, const Parts&)) {
    outcome_ = check_output_folder(options_.out, kResultFiles, "a bench's", options_.overwrite);
    if (outcome_) outcome_ = run(options_, parts_);
    if (!outcome_ && interrupted())
      outcome_ = Error{outcome_.error().code,
                       fmt::format("{}; nothing of it is in '{}'", outcome_.error().sentence, options_.out)};
  }
  void measure(CLI::App& command, Result<void> (*run)(const BenchOptions&, const Parts&)) {
    command.callback([*this, run]() mutable { measure_now(run); });
  }

  void add_latency() {
    CLI::App* latency = bench_.add_subcommand("latency",
                                              "a frame's time by stage: p50, p95, p99, p99.9 (of 1,000 "
                                              "frames and more), max; contact and free apart");
    add_common(*latency, options_);
    add_poses(*latency, options_);
    add_backends(*latency, options_, "in turns");
    latency->footer(
        "Frames are `contact`, `free` (the tool is near, nothing meets) or `apart` (the search finds nothing "
        "near). Stages are the\n"
        "device's own times, told by frames of their own, which take longer; `submit` is what waiting cost "
        "beyond them, `device` all\n"
        "of it, `host` all else from pose in to "
        "wrench out. The frames are a loop's\n"
        "that nobody watches: without lists of triangles, and `refined` without areas.\n"
        "Of several engines the report says on how many frames the first is slower than each other one. A "
        "frame that looks so is asked\n"
        "up to 20 times more, and the least times count.\n"
        "Rows of `total` have what a frame asks of a device, the median of each: submissions, dispatches, "
        "barriers, bytes that the frame writes for it and\n"
        "reads of it, and host_us, the host's time beside submitting and waiting.");
    measure(*latency, bench_latency);
  }

  void add_throughput() {
    CLI::App* throughput = bench_.add_subcommand(
        "throughput", "poses a second against the size of a batch, beside poses asked singly");
    add_common(*throughput, options_);
    add_poses(*throughput, options_);
    add_backends(*throughput, options_, "one after the other");
    throughput
        ->add_option("--largest", options_.largest_batch, "poses of the largest batch, 1 to 65,536 (1,024)")
        ->check(CLI::Range(std::uint64_t{1}, std::uint64_t{65'536}).description(""))
        ->type_name("N");
    throughput->footer(
        "Batches of 1, 4, 16 and so on to --largest poses, in turns with the same poses asked singly. "
        "`touch` is yes or no, `forces` are those\n"
        "of frames that nobody watches, without lists; `frames` have triangles and areas; `answers` a lone "
        "query's balance\n"
        "of spring and field besides, which it finds by asking for more poses. Always the wall's clock: a "
        "batch takes all cores. share_of_single: time\n"
        "of a pose in the batch over that of one asked singly, by as many threads as its engine gives a "
        "frame (cpu: two). Then what a batch asks of a device.");
    measure(*throughput, bench_throughput);
  }

  void add_scale() {
    CLI::App* scale = bench_.add_subcommand("scale",
                                            "a frame's time against the number of triangles: around the same "
                                            "contact, finer, of the tool; or of scenes of your own, refined");
    add_common(*scale, options_, false);
    add_poses(*scale, options_);
    add_backends(*scale, options_, "one after the other");
    scale
        ->add_option("--most", options_.most_triangles,
                     "triangles of the largest mock-up, 100,000 to 10,000,000 (1,000,000)")
        ->check(CLI::Range(std::uint64_t{100'000}, std::uint64_t{10'000'000}).description(""))
        ->type_name("N");
    scale->footer(
        "Without scenes three series are made; with scenes, and --poses, each is measured as it is, with its "
        "edges in two, and in four. Files stay below\n"
        "DIR/scenes. peak_bytes is the most memory that the process had while it read, prepared and "
        "measured.");
    measure(*scale, bench_scale);
  }

  void add_prepare() {
    CLI::App* prepare = bench_.add_subcommand(
        "prepare",
        "a scene's first start by stage, its start from the cache, and other libraries' trees beside them");
    add_common(*prepare, options_);
    add_one_backend(*prepare, options_);
    add_clock(*prepare, options_, "wall, or cpu: time that this process itself ran (wall)");
    prepare->footer(
        "The first start finds nothing in the cache and keeps what took a quarter of a second or more; the "
        "second finds that. Shaders that the driver has compiled before are not compiled again.\n"
        "Trees are built by a build with -DPALPATE_BENCH_PEERS=ON alone.");
    measure(*prepare, bench_prepare);
  }

  void add_error() {
    CLI::App* error = bench_.add_subcommand("error",
                                            "error of the response against time, for every knob: four closed "
                                            "forms, fits and plates, and scenes against a converged run");
    add_common(*error, options_, false);
    add_poses(*error, options_);
    error
        ->add_option(
            "--backend", options_.backends,
            "the engine, or several; without it cpu, and beside it gpu (else ref), which answers paper, too")
        ->check(one_of(kEngines))
        ->expected(1, 3)
        ->type_name("auto|gpu|cpu|ref");
    error->add_flag("--scenes-only", options_.scenes_only,
                    "without the closed forms and the cases of bench force");
    error->add_flag("--quick", options_.quick,
                    "two closed forms, eight poses, six spacings: to see that it works");
    error->footer(
        "Errors in results.csv are absolute: d and cp in m, n_c in degrees, F in N, T in N·m; p50 and p99 "
        "over the poses in contact; truth_p50 is the truth's median. Times are whole frames.\n"
        "Each method is judged against its own truth: a closed form, else itself with samples a 16th of a "
        "voxel apart (refined), or with the mock-up cut finer than in\n"
        "the sweep (paper). Without --poses a scene is measured at the poses of a hand in virtual time and "
        "at its path's, deeper than a hand gets, so it needs a path; SCENE=POSES.csv\n"
        "gives a scene poses of its own. Poses and rounds are 12 and 1 unless said otherwise. The report "
        "begins with what the figures say in sentences.");
    error->callback([*this, error]() mutable {
      if (error->count("--frames") == 0) options_.frames = 12;
      if (error->count("--rounds") == 0) options_.rounds = 1;
      measure_now(bench_error);
    });
  }

  void add_peers() {
    CLI::App* peers = bench_.add_subcommand(
        "peers", "other collision libraries on the same triangles and poses, in turns with palpate");
    add_common(*peers, options_);
    add_poses(*peers, options_);
    add_backends(*peers, options_, "in turns");
    peers
        ->add_option("--peers", options_.peers,
                     "beginnings of names (fcl, embree, bullet, cgal); without it all")
        ->type_name("NAME");
    peers->footer(
        "palpate's time is a whole frame: sets, areas, wrench. The others' is the pairs alone. Before "
        "anything is timed, each library's pairs\n"
        "are held against the exact ones: `missing` and `extra` count pairs over all poses. Ratios are those "
        "of the engine that is named first.");
    measure(*peers, bench_peers);
  }

  void add_questions() {
    CLI::App* questions = bench_.add_subcommand(
        "questions", "touch or not, distance and first contact: a pose's time, beside other libraries'");
    add_common(*questions, options_);
    add_poses(*questions, options_);
    questions
        ->add_option_function<double>(
            "--reach", number_within("--reach", 0, 1000, options_.reach),
            "poses are moved and turned at random, by up to so many radii of the tool and radians, "
            "mostly by far less; 0: as they are (0.5)")
        ->type_name("X");
    add_one_backend(*questions, options_);
    questions->footer(
        "Other libraries are there in a build with -DPALPATE_BENCH_PEERS=ON. Each is asked at the same "
        "poses, in turns. `poses_different`\n"
        "counts where it disagrees with palpate, a distance by more than two lattice steps; a tool wholly "
        "inside is left out, for they see\n"
        "surfaces alone. `first contact` goes from each pose to the next; `frame` is a whole frame, for "
        "comparison.");
    measure(*questions, bench_questions);
  }

  void add_stability() {
    CLI::App* stability = bench_.add_subcommand(
        "stability",
        "highest stable stiffness of each force law beside theory; steps and energy of the force");
    stability
        ->add_option("scenes", options_.scenes,
                     "scene files (JSON) whose sessions are looked at for jumps, too")
        ->type_name("SCENE");
    add_out(*stability, options_);
    stability->footer(
        "In virtual time: the shipped law closed over springs, over a bouncing wall, over tools in six "
        "degrees of\n"
        "freedom, and over the real collision query. critical_k is found by\n"
        "bisection to half a percent between 10 and 20,000 N/m. The report has maps, jumps of force and "
        "torque, and energy given out.");
    measure(*stability, bench_stability);
  }

  void add_plan() {
    CLI::App* plan = bench_.add_subcommand(
        "plan",
        "scenes that lack something: the whole plan beside their own, the same bits, time and memory");
    add_out(*plan, options_);
    add_one_backend(*plan, options_);
    add_rounds(*plan, options_, "times that all poses are gone through, the two plans in turns (3)");
    add_clock(*plan, options_, "wall, or cpu: time that this process itself ran (wall)");
    plan->footer(
        "A row a scene, plan and stage; `total` is the whole frame, its median over the poses in contact, "
        "and all memory. A stage that a plan leaves\n"
        "out has no row. Before anything is written, both plans' answers are held against each other bit by "
        "bit. The report begins with what each thing left out gives, and where.");
    measure(*plan, bench_plan);
  }

  void add_numerics() {
    CLI::App* numerics = bench_.add_subcommand("numerics",
                                               "stiff and extreme cases beside the same method in plain "
                                               "single and double precision: where each breaks");
    add_out(*numerics, options_);
    add_one_backend(*numerics, options_);
    numerics->footer(
        "Swept: K, scale, offset from the origin, aspect of triangles and of patches, number of patches, "
        "depth, sample spacing, play, interference, stiffness of the\n"
        "contact beside the spring's, gaps, age of results, ticks of the law. The error is of the force, "
        "relative; for\n"
        "gaps the share of wrong answers. The outcome is held, lost, no contact, or refused with the reason; "
        "`breaks` in results.json sums up.");
    measure(*numerics, bench_numerics);
  }

  void add_force() {
    CLI::App* force = bench_.add_subcommand("force",
                                            "the force on fits, plates, thin and open parts against symmetry "
                                            "and closed forms, or along poses before a scene");
    add_common(*force, options_, false);
    add_poses(*force, options_);
    add_one_backend(*force, options_);
    force->footer(
        "A row a path: the largest force, the largest step between neighbours in K times the tool's way, "
        "work lost round loops, how far ∂F is from symmetric, what is lost\n"
        "while going deeper, turns by more than 90° between neighbours, poses without a direction, and in "
        "words what breaks a limit. A scene's path is divided evenly into --frames poses.\n"
        "Poses are asked each by itself; hand_step and hand_reversals are a scene's largest step and turns "
        "for a "
        "hand that goes along, each balance looked for from the one before, with the scene's `start` as in a "
        "run.");
    measure(*force, bench_force);
  }

  void add_jitter() {
    CLI::App* jitter = bench_.add_subcommand(
        "jitter", "how late the 1 kHz loop's ticks come under full load; cyclictest beside it");
    add_common(*jitter, options_);
    jitter
        ->add_option_function<double>("--seconds", number_within("--seconds", 0.1, 86400, options_.seconds),
                                      "how long (60)")
        ->type_name("S");
    add_one_backend(*jitter, options_);
    jitter->footer(
        "The session of the (first) scene runs in real time along its path, to and fro, its back end asked "
        "as fast as it\n"
        "answers. cyclictest (Debian: rt-tests) runs meanwhile with the same period,\n"
        "priority and processor, where it is installed. What was not allowed is said. A tick that comes a "
        "whole period late is missed.");
    measure(*jitter, bench_jitter);
  }

  CLI::App& bench_;
  BenchOptions& options_;
  const Parts& parts_;
  Result<void>& outcome_;
};

}  // namespace

void add_bench_command(CLI::App& app, BenchOptions& options, const Parts& parts, Result<void>& outcome) {
  CLI::App* bench =
      app.add_subcommand("bench",
                         "measure: a frame, batches, growth, preparation, other libraries, questions, plans, "
                         "the force's error and stability, the loop's punctuality");
  bench->require_subcommand(0, 1);  // so that a word that is none is named; asked for where there is no word
  bench->callback([bench] {
    if (bench->get_subcommands().empty()) throw CLI::RequiredError("A bench");
  });
  bench->footer(kFooter);
  Benches(*bench, options, parts, outcome).add_all();
}

}  // namespace palpate
