// One program for tests, timing and listing: the same poses asked of an engine, or of all three.
#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <CLI/Validators.hpp>
#include <algorithm>
#include <cstdio>
#include <iostream>
#include <map>

#include "compute/gpu/gpu_backend.h"
#include "compute/native/native_backend.h"
#include "cpu_ref/ref_backend.h"
#include "tests/equivalence/case_run.h"
#include "tests/equivalence/hashes_file.h"

namespace palpate::equivalence {
namespace {

constexpr int kAllEqual = 0, kSomeDiffer = 1, kBadUsage = 2, kSomeNotSupported = 3;

struct Options {
  std::vector<std::string> names, families;
  bool list = false, killer = false, stop = false, times = false, validation = false, twice = false,
       batch = false, floats = false, guards = false, own_memory = false;
  std::string backend = "all", device, check, write, reason;
  std::uint64_t seed = 1;
  std::optional<std::uint64_t> poses, pose;
  std::uint64_t campaign = 0;

  bool default_poses() const { return seed == 1 && !poses && !pose && campaign == 0; }
};

std::vector<Case> chosen(const Options& options) {
  std::vector<Case> cases = all_cases();
  if (options.backend == "cpu")
    std::erase_if(cases, [](const Case& c) { return c.profile != Profile::kRefined; });  // all that it knows
  const auto among = [](const std::vector<std::string>& list, const std::string& word) {
    return list.empty() || std::find(list.begin(), list.end(), word) != list.end();
  };
  std::erase_if(cases, [&](const Case& c) {
    return !among(options.names, c.name) || !among(options.families, c.family) ||
           (options.killer && !c.killer);
  });
  return cases;
}

void list(const std::vector<Case>& cases) {
  for (const Case& c : cases)
    std::printf("%-28s %-9s %3d poses%s%s%s%s\n    %s\n", c.name.c_str(), c.family.c_str(), c.poses,
                c.profile == Profile::kPaper ? ", paper" : "", c.ignoring ? ", ignoring" : "",
                c.killer ? ", killer" : "", c.degenerate ? ", degenerate" : "", c.about.c_str());
}

using Engines = std::vector<std::unique_ptr<CollisionBackend>>;

Result<Engines> make_engines(const Options& options) {
  Engines backends;
  const auto wanted = [&](const char* name) { return options.backend == "all" || options.backend == name; };
  if (wanted("gpu")) {
    GpuOptions gpu;
    gpu.device = options.device;
    gpu.validation = options.validation;
    gpu.guard_buffers = options.guards;
    gpu.own_memory = options.own_memory;
    auto made = make_gpu_backend(gpu);
    if (!made) return made.error();
    backends.push_back(std::move(*made));
  }
  if (wanted("cpu")) backends.push_back(make_native_backend());
  if (wanted("ref")) backends.push_back(make_ref_backend());
  return backends;
}

/// Those that a case can be asked: the native engine knows `refined` alone.
Backends answering(const Engines& engines, const Case& c) {
  Backends out;
  for (const auto& engine : engines)
    if (engine->name() != "cpu" || c.profile == Profile::kRefined) out.push_back(engine.get());
  return out;
}

void print_times(CaseRun& run) {
  std::printf("    median us:");
  for (auto& [stage, us] : run.stage_us) {
    const auto middle = us.begin() + static_cast<std::ptrdiff_t>(us.size() / 2);
    std::nth_element(us.begin(), middle, us.end());
    std::printf("  %s %.0f", stage.c_str(), *middle);
  }
  std::printf("\n");
}

/// Everything that came of all cases together.
struct Totals {
  std::uint64_t cases = 0, equal = 0, differ = 0, not_supported = 0, poses = 0, degenerate_poses = 0,
                contacts = 0, with_pairs = 0, known = 0;
  FloatOpinion floats;
  double seconds = 0;
  std::uint32_t flags = 0;
  std::map<std::string, std::uint64_t> met;

  void add(const Case& c, const CaseRun& run) {
    ++cases;
    ++(run.outcome == Outcome::kEqual ? equal : run.outcome == Outcome::kDiffers ? differ : not_supported);
    poses += run.poses;
    degenerate_poses += c.degenerate ? run.poses : 0;
    contacts += run.contacts;
    with_pairs += run.with_pairs;
    known += run.known;
    floats.pairs += run.floats.pairs;
    floats.ambiguous += run.floats.ambiguous;
    floats.wrong += run.floats.wrong;
    floats.ambiguous_poses += run.floats.ambiguous_poses;
    floats.wrong_poses += run.floats.wrong_poses;
    seconds += run.seconds;
    flags |= run.flags;
    for (const auto& [what, times] : run.met) met[what] += times;
  }
};

using Count = unsigned long long;

void print(const Case& c, CaseRun& run, const Options& options, std::uint64_t seed) {
  const char* outcome = run.outcome == Outcome::kEqual     ? "equal"
                        : run.outcome == Outcome::kDiffers ? "DIFFERS"
                                                           : "NOT SUPPORTED";
  std::printf("%-28s %-13s seed %llu: %llu poses, %llu touch, %llu with pairs, %llu areas, %.2f s\n",
              c.name.c_str(), outcome, Count{seed}, Count{run.poses}, Count{run.contacts},
              Count{run.with_pairs}, Count{run.areas}, run.seconds);
  for (const std::string& finding : run.findings) std::printf("    %s\n", finding.c_str());
  if (options.times) print_times(run);
}

/// How to see a finding again.
void print_repeat(const Case& c, const CaseRun& run, const Options& options, std::uint64_t seed) {
  const std::string text = run.findings.empty() ? "" : run.findings.front();
  const auto at = text.find("pose ");
  const std::string pose =
      at == std::string::npos ? "" : " --pose " + std::to_string(std::stoull(text.substr(at + 5)));
  const std::string flags =
      std::string(options.guards ? " --guards" : "") + (options.own_memory ? " --own-memory" : "") +
      (options.validation ? " --validation" : "") +
      (options.twice || options.campaign > 0 ? " --twice" : "") + (options.batch ? " --batch" : "") +
      (options.backend == "cpu" || options.backend == "ref" ? " --backend " + options.backend : "");
  std::printf("    repeat: equivalence --case %s --seed %llu%s%s\n", c.name.c_str(), Count{seed},
              pose.c_str(), flags.c_str());
}

void print(const Totals& t, const Options& options) {
  std::printf(
      "%llu runs: %llu equal, %llu differ, %llu not supported; %llu poses (%llu degenerate), %llu touch, "
      "%llu with pairs, "
      "%llu with an answer known beforehand; %.1f s\n",
      Count{t.cases}, Count{t.equal}, Count{t.differ}, Count{t.not_supported}, Count{t.poses},
      Count{t.degenerate_poses}, Count{t.contacts}, Count{t.with_pairs}, Count{t.known}, t.seconds);
  if (options.floats)
    std::printf(
        "single precision: %llu pairs of boxes met; %llu ambiguous, in %llu poses; %llu judged wrongly, in "
        "%llu poses\n",
        Count{t.floats.pairs}, Count{t.floats.ambiguous}, Count{t.floats.ambiguous_poses},
        Count{t.floats.wrong}, Count{t.floats.wrong_poses});
}

/// Poses that came to each rule, and the rules that no pose came to.
void print_rules(const Totals& t) {
  std::printf("poses with:");
  for (const auto& [what, times] : t.met) std::printf(" %s %llu", what.c_str(), Count{times});
  std::printf("\nflags met:");
  for (const bool met : {true, false}) {
    if (!met) std::printf("\nflags not met:");
    for (std::size_t i = 0; i < flag_names.size(); ++i)
      if (((t.flags >> i & 1u) != 0) == met)
        std::printf(" %.*s", static_cast<int>(flag_names[i].size()), flag_names[i].data());
  }
  std::printf("\n");
}

int exit_code(const Totals& totals) {
  return totals.differ > 0 ? kSomeDiffer : totals.not_supported > 0 ? kSomeNotSupported : kAllEqual;
}

/// Runs the cases once each, and checks or writes hashes.
int run_cases(const std::vector<Case>& cases, const Engines& engines, const Options& options) {
  HashesFile file;
  if (const std::string& name = options.check.empty() ? options.write : options.check; !name.empty()) {
    auto read = read_hashes(name);
    if (read) file = std::move(*read);
    if (!read && options.write.empty()) {
      std::cerr << read.error().sentence << "\n";
      return kBadUsage;
    }
  }
  RunSettings settings;
  settings.seed = options.seed;
  settings.twice = options.twice;
  settings.batch = options.batch;
  settings.floats = options.floats;
  settings.poses = options.pose ? std::optional<std::uint64_t>(1) : options.poses;
  settings.first = options.pose.value_or(0);
  if (options.stop) settings.most_differences = 1;
  Totals totals;
  for (const Case& c : cases) {
    const Backends backends = answering(engines, c);
    CaseRun run = run_case(c, backends, settings);
    const StoredHashes hashes = stored(run.hashes, static_cast<int>(run.poses));
    if (!options.check.empty() && run.outcome == Outcome::kEqual) {
      const auto known = file.cases.find(c.name);
      const std::string parts = known == file.cases.end() ? "" : differing_parts(known->second, hashes);
      if (known == file.cases.end() || known->second.poses != hashes.poses)
        run.findings.push_back(options.check + " does not have this case with " +
                               std::to_string(hashes.poses) + " poses");
      else if (!parts.empty())
        run.findings.push_back(backends[0]->name() + ": other hashes than in " + options.check + ": " +
                               parts);
      if (!run.findings.empty()) run.outcome = Outcome::kDiffers;
    }
    file.cases[c.name] = hashes;
    print(c, run, options, options.seed);
    if (run.outcome != Outcome::kEqual) print_repeat(c, run, options, options.seed);
    totals.add(c, run);
    if (options.stop && run.outcome != Outcome::kEqual) break;
  }
  print(totals, options);
  print_rules(totals);
  if (!options.write.empty() && exit_code(totals) == kAllEqual) {
    file.reason = options.reason;
    if (options.names.empty() && options.families.empty() && !options.killer &&
        options.backend != "cpu")  // cases that are no more go
      std::erase_if(file.cases, [&](const auto& entry) {
        return std::none_of(cases.begin(), cases.end(), [&](const Case& c) { return c.name == entry.first; });
      });
    if (const auto written = write_hashes(options.write, file); !written) {
      std::cerr << written.error().sentence << "\n";
      return kBadUsage;
    }
  }
  return exit_code(totals);
}

/// Many poses, shared among the cases by their cost; a new scene, where it depends on the seed, every so many
/// poses.
int run_campaign(const std::vector<Case>& cases, const Engines& engines, const Options& options) {
  double shares = 0;
  for (const Case& c : cases) shares += c.share;
  Totals totals;
  for (const Case& c : cases) {
    Totals of_case;
    const auto wanted =
        static_cast<std::uint64_t>(static_cast<double>(options.campaign) * c.share / shares) + 1;
    for (std::uint64_t done = 0, seed = options.seed; done < wanted; done += c.scene_poses, ++seed) {
      RunSettings settings;
      settings.seed = seed;
      settings.poses = std::min(c.scene_poses, wanted - done);
      settings.twice = true;
      settings.floats = options.floats;
      CaseRun run = run_case(c, answering(engines, c), settings);
      if (run.outcome != Outcome::kEqual) {
        print(c, run, options, seed);
        print_repeat(c, run, options, seed);
      }
      of_case.add(c, run);
      totals.add(c, run);
    }
    std::printf("%s: ", c.name.c_str());
    print(of_case, options);
    std::fflush(stdout);
  }
  print(totals, options);
  print_rules(totals);
  return exit_code(totals);
}

int run(int argc, char** argv) {
  Options o;
  CLI::App app(
      "Compares the engines bit by bit, and each of them with stored hashes and with what is known "
      "beforehand.",
      "equivalence");
  app.add_option("--case", o.names, "these cases alone");
  app.add_option("--family", o.families,
                 "these families alone: solids, chapter, touch, topology, rules, fits");
  app.add_flag("--killer", o.killer, "the few cases that together reach every rule, in seconds");
  app.add_flag("--list", o.list, "list the chosen cases and stop");
  app.add_option("--backend", o.backend, "who answers: gpu, cpu, ref, or all, compared")
      ->check(CLI::IsMember({"gpu", "cpu", "ref", "all"}));
  app.add_option("--device", o.device, "part of the Vulkan device's name");
  app.add_option("--seed", o.seed, "seed of scenes and poses")->capture_default_str();
  app.add_option("--poses", o.poses, "poses a case");
  app.add_option("--pose", o.pose, "this pose alone (and in a chain, those that it follows)");
  app.add_option("--check", o.check, "a file of hashes that the first back end's answers must have");
  auto* reason = app.add_option("--reason", o.reason, "why the hashes change");
  app.add_option("--write", o.write, "write the hashes to this file, if all is equal")->needs(reason);
  app.add_flag("--stop", o.stop, "stop at the first difference");
  app.add_flag("--twice", o.twice, "ask the first back end everything twice");
  app.add_flag("--batch", o.batch, "ask the first back end a case's poses together, too");
  app.add_flag("--floats", o.floats, "count what single precision would have judged otherwise");
  app.add_flag("--times", o.times, "print the median time of every stage");
  app.add_flag("--validation", o.validation, "with Vulkan's validation layer and its synchronisation checks");
  app.add_flag("--own-memory", o.own_memory,
               "the host's own processor, or an integrated GPU, is taken for a GPU with memory of its own");
  app.add_flag("--guards", o.guards,
               "with guard bytes round every buffer of the device, checked after every scene and pose");
  app.add_option("--campaign", o.campaign,
                 "this many poses over all cases, with changing seeds, everything asked twice");
  CLI11_PARSE(app, argc, argv);

  const std::vector<Case> cases = chosen(o);
  if (cases.empty()) {
    std::cerr << "no case has that name, family or mark; --list names them all\n";
    return kBadUsage;
  }
  if (o.list) {
    list(cases);
    return kAllEqual;
  }
  if ((!o.check.empty() || !o.write.empty()) && !o.default_poses()) {
    std::cerr << "hashes are those of seed 1 and each case's own number of poses: --check and --write go "
                 "without --seed, --poses, --pose and --campaign\n";
    return kBadUsage;
  }
  auto engines = make_engines(o);
  if (!engines) {
    std::cerr << "not supported: " << engines.error().sentence << "\n";
    return kSomeNotSupported;
  }
  for (const auto& backend : *engines)
    std::printf("%s: %s\n", backend->name().c_str(), backend->device().c_str());
  return o.campaign > 0 ? run_campaign(cases, *engines, o) : run_cases(cases, *engines, o);
}

}  // namespace
}  // namespace palpate::equivalence

int main(int argc, char** argv) { return palpate::equivalence::run(argc, argv); }
