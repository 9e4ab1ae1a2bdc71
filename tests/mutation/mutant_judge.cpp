// Judges mutants, one a line of standard input, one line of answer each.
//   mutant_judge cpu: in: NUMBER                    the switch of a mutant of the reference (mutant_switch.h)
//                         "host" NUMBER             of the host's exact code (model/)
//   mutant_judge native: in: NUMBER                 likewise of the native engine
//                            "planners" NUMBER      asked distances and the planner's questions, too
//   mutant_judge gpu ROOT: in: FILE, BEGIN, END, TEXT, MODULES
//                                                    bytes of a shader source become TEXT; modules with it
//                          in: "intact"             whether the unchanged program still answers as at first
// With --killers behind these only the killer cases are asked, with --probes no case of shaders but the
// probes alone; names of cases after --without are not asked, nor is any probe then.
//   out: OUTCOME, SECONDS of processor time, CASE, what differed.
// All tab-separated; first line "ready" when it is.
// Outcomes: survived, differs, crashed, hangs, no-program (it doesn't compile), no-change (it compiles to the
// same), not-asked (no case runs the module, or the sources are not those that this program was built of). A
// mutant costs little: scenes, their answers and all pipelines but the mutant's are there already. The
// reference's and the native engine's mutants run in children of this process; the device's run in it, for
// Vulkan does not survive a fork, and one that crashes or hangs ends the program.
#include <sys/resource.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <functional>
#include <iostream>
#include <iterator>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "compute/native/native_backend.h"
#include "cpu_ref/ref_backend.h"
#include "tests/mutation/limits.h"
#include "tests/mutation/module_probes.h"
#include "tests/mutation/mutable_device.h"
#include "tests/mutation/mutant_switch.h"
#include "tests/mutation/oracle.h"
#include "tests/mutation/probes.h"
#include "tests/mutation/shader_compiler.h"
#include "tests/mutation/shader_probes.h"

namespace palpate::mutation {
namespace {

double cpu_seconds(int who) {
  rusage used{};
  getrusage(who, &used);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return seconds(used.ru_utime) + seconds(used.ru_stime);
}

void answer(const char* outcome, double seconds, const std::string& where, std::string what) {
  for (char& c : what)
    if (c == '\t' || c == '\n') c = ' ';
  std::printf("%s\t%.2f\t%s\t%s\n", outcome, seconds, where.c_str(), what.c_str());
  std::fflush(stdout);
}

// ---- the reference and the native engine, in children

constexpr std::size_t kProbe = SIZE_MAX;  ///< no case but a probe

/// What a child reports through its pipe.
struct Report {
  std::size_t at = 0;
  char difference[200] = "";
};

/// What the reference's parts said when nothing was changed.
class ProbeAnswers {
 public:
  ProbeAnswers(const Oracle& oracle, bool ask) : oracle_(oracle) {
    if (!ask) return;
    for (const Probe& probe : probes()) answers_.push_back(probe.second());
    for (const Probe& probe : host_probes()) host_.push_back(probe.second());
    for (std::size_t c = 0; c < oracle.size(); ++c)
      ways_out_.push_back(probe_ways_out(oracle.geometry(c).mockup, oracle.geometry(c).mockup_grid));
  }
  /// The probe that says something else now; empty: none.
  std::string first_difference(bool host) const {
    for (std::size_t i = 0; host && i < host_.size(); ++i)
      if (host_probes()[i].second() != host_[i]) return host_probes()[i].first;
    if (host) return {};
    for (std::size_t i = 0; i < answers_.size(); ++i)
      if (probes()[i].second() != answers_[i]) return probes()[i].first;
    for (std::size_t c = 0; c < ways_out_.size(); ++c)
      if (probe_ways_out(oracle_.geometry(c).mockup, oracle_.geometry(c).mockup_grid) != ways_out_[c])
        return "ways_out of " + oracle_.name(c);
    return {};
  }

 private:
  const Oracle& oracle_;
  std::vector<std::uint64_t> answers_, host_, ways_out_;
};

/// What a mutant is asked: what differs, and of which case.
using Ask = std::function<std::string(std::size_t& of)>;

[[noreturn]] void child(const Ask& ask, int mutant, int pipe_end, rlim_t seconds) {
  const rlimit time{seconds, seconds + 1}, no_core{0, 0}, memory{rlim_t{4} << 30, rlim_t{4} << 30};
  setrlimit(RLIMIT_CPU, &time);
  setrlimit(RLIMIT_CORE, &no_core);
  setrlimit(RLIMIT_AS, &memory);
  if (std::freopen("/dev/null", "w", stderr) == nullptr) std::_Exit(3);
  active = mutant;
  Report report;
  const std::string difference = ask(report.at);
  std::strncpy(report.difference, difference.c_str(), sizeof report.difference - 1);
  if (write(pipe_end, &report, sizeof report) != sizeof report) std::_Exit(3);
  std::_Exit(difference.empty() ? 0 : 1);
}

void judge_in_child(Oracle& oracle, const Ask& ask, int mutant, double limit) {
  int ends[2];
  if (pipe(ends) != 0) throw std::runtime_error("no pipe");
  const double before = cpu_seconds(RUSAGE_CHILDREN);
  const pid_t pid = fork();
  if (pid == 0) child(ask, mutant, ends[1], static_cast<rlim_t>(limit));
  close(ends[1]);
  Report report;
  const bool reported = read(ends[0], &report, sizeof report) == sizeof report;
  close(ends[0]);
  int status = 0;
  waitpid(pid, &status, 0);
  const double seconds = cpu_seconds(RUSAGE_CHILDREN) - before;
  if (WIFSIGNALED(status)) {
    const int signal = WTERMSIG(status);
    answer(signal == SIGXCPU || signal == SIGKILL ? "hangs" : "crashed", seconds, "", strsignal(signal));
  } else if (WEXITSTATUS(status) == kNoProgram) {
    answer("no-program", seconds, "", "");
  } else if (WEXITSTATUS(status) == 0) {
    answer("survived", seconds, "", "");
  } else if (reported) {
    if (report.at == kProbe) return answer("differs", seconds, "probe", report.difference);
    oracle.ask_first(report.at);
    answer("differs", seconds, oracle.name(report.at), report.difference);
  } else {
    answer("crashed", seconds, "", "exit status " + std::to_string(WEXITSTATUS(status)));
  }
}

// ---- the device's shaders, in this process

/// SIGPROF ends the program when a mutant uses more processor time than this; 0: no limit.
void limit_time(double seconds) {
  itimerval timer{};
  timer.it_value.tv_sec = static_cast<time_t>(seconds);
  setitimer(ITIMER_PROF, &timer, nullptr);
}

class ShaderJudge {
 public:
  ShaderJudge(Oracle& oracle, MutableDevice& device, std::string root, bool ask_probes, bool ask_cases)
      : oracle_(oracle),
        device_(device),
        probes_(device.device()),
        modules_(device.device()),
        limits_(oracle, device, root),
        root_(std::move(root)),
        ask_probes_(ask_probes),
        ask_cases_(ask_cases) {}

  void judge(const std::string& line) {
    std::istringstream fields(line);
    TextChange change;
    std::string begin, end, names;
    std::getline(fields, change.file, '\t');
    std::getline(fields, begin, '\t');
    std::getline(fields, end, '\t');
    std::getline(fields, change.text, '\t');
    std::getline(fields, names);
    change.begin = std::stoul(begin);
    change.end = std::stoul(end);

    const double before = cpu_seconds(RUSAGE_SELF);
    const auto spent = [&] { return cpu_seconds(RUSAGE_SELF) - before; };
    // A mutant of a file that many modules include is tried in a few of them first: caught there, it need not
    // be compiled for all.
    constexpr int kFirst = 3;
    std::istringstream list(names);
    std::size_t at = 0;
    int changed = 0;
    std::string difference;
    bool probed = false;
    bool unasked = false;                // swapped in since the oracle was asked last
    std::vector<std::string> of_frames;  // changed modules that frames run
    bool scans = false;
    const auto ask = [&] {
      difference = oracle_.first_difference_now(at);
      if (difference.empty() && !of_frames.empty()) {
        difference = oracle_.first_overflow_difference(at, [&](const char* name_of, std::uint32_t items) {
          device_.first_capacity(*name_of != 0 ? std::map<std::string, std::uint32_t>{{name_of, items}}
                                               : std::map<std::string, std::uint32_t>{});
        });
      }
      if (difference.empty() && scans) {
        device_.without_samples(true);
        difference = oracle_.first_difference_now(at);
        device_.without_samples(false);
        if (!difference.empty()) difference += " (samples not listed)";
      }
      unasked = false;
    };
    for (std::string name; difference.empty() && list >> name;) {
      const std::string& original = this->original(name);
      const auto mutant = compile_shader(root_, name, &change);
      if (!mutant) {
        device_.restore();
        return answer("no-program", spent(), "", name);
      }
      if (*mutant == original) continue;
      if (name.starts_with("tests/")) {
        limit_time(kProbeSeconds);
        difference = ask_probes_ && probes_.has(name) ? probes_.difference(name, original, *mutant) : "";
        if (!difference.empty()) {
          ++changed;
          probed = true;
          difference = name.substr(name.rfind('/') + 1) + ": " + difference;
        }
        continue;
      }
      if (ask_probes_ && modules_.has(name)) {
        limit_time(kProbeSeconds);
        difference = modules_.difference(name, original, *mutant);
        if (!difference.empty()) {
          ++changed;
          probed = true;
          difference = name.substr(name.rfind('/') + 1) + " alone: " + difference;
          continue;
        }
      }
      if (!ask_cases_) {
        ++changed;
        continue;
      }
      const bool of_frame = name.starts_with("shaders/frame/") || name.starts_with("shaders/response/");
      if (of_frame) of_frames.push_back(name);
      scans = scans || name == "shaders/frame/sample_scan.comp";
      if (auto r = device_.swap(original, *mutant, !of_frame); !r) difference = r.error().sentence;
      unasked = true;
      if (++changed == kFirst && difference.empty()) ask();
    }
    if (unasked && difference.empty()) ask();
    const std::size_t swapped = device_.swapped();
    if (difference.empty() && swapped > 0 && !of_frames.empty())
      difference = limits_.first_difference(change, of_frames, at);
    device_.restore();
    limit_time(0);
    if (changed == 0) return answer("no-change", spent(), "", "");
    if (difference.empty()) return answer(swapped > 0 ? "survived" : "not-asked", spent(), "", "");
    if (probed) return answer("differs", spent(), "probe", difference);
    oracle_.ask_first(at);
    answer("differs", spent(), oracle_.name(at), difference);
  }

 private:
  const std::string& original(const std::string& name) {
    std::string& code = originals_[name];
    if (code.empty()) code = compile_shader(root_, name, nullptr).value();
    return code;
  }

  Oracle& oracle_;
  MutableDevice& device_;
  ShaderProbes probes_;
  ModuleProbes modules_;
  static constexpr double kProbeSeconds = 20;  // a probe takes a tenth of one

  Limits limits_;
  std::string root_;
  bool ask_probes_, ask_cases_;
  std::map<std::string, std::string> originals_;
};

void ready(const Oracle& oracle) {
  std::printf("ready\t%zu cases\n", oracle.size());
  std::fflush(stdout);
}

using Words = std::vector<std::string>;

void judge_shaders(const std::string& root, bool killers, bool probes_alone, bool as_gpu,
                   const Words& without) {
  MutableDevice device(as_gpu);
  compile_with_texels(device.device().texels());
  int put_aside = 0;
  Oracle oracle(device, killers, without, [&](bool begins) {
    if (!begins) {
      active = put_aside;
      if (auto r = device.put_back(); !r) throw std::runtime_error(r.error().sentence);
      return;
    }
    limit_time(0);  // what the unchanged program takes is nobody's fault
    put_aside = std::exchange(active, 0);
    device.set_aside();
  });
  // A case's first answer has compiled pipelines too, so this is much more than five times what it takes.
  oracle.before_case = [](double seconds) { limit_time(3 + 5 * seconds); };
  ShaderJudge judge(oracle, device, root, without.empty(), !probes_alone);
  ready(oracle);
  for (std::string line; std::getline(std::cin, line);) {
    if (line != "intact") {
      judge.judge(line);
      continue;
    }
    std::size_t at = 0;
    const std::string difference = oracle.first_difference_again(at);
    limit_time(0);
    answer(difference.empty() ? "intact" : "corrupt", 0, oracle.name(at), difference);
  }
}

void judge_reference(bool killers, const Words& without) {
  const auto backend = make_ref_backend();
  Oracle oracle(*backend, killers, without, [](bool) {});
  const double begin = cpu_seconds(RUSAGE_SELF);
  oracle.answer_all();
  const ProbeAnswers probed(oracle, without.empty());
  const double limit = 2 + 5 * (cpu_seconds(RUSAGE_SELF) - begin);
  std::size_t at = 0;
  if (const std::string difference = oracle.first_difference_now(at); !difference.empty())
    throw std::runtime_error("the unchanged program differs from itself: " + oracle.name(at) + ", " +
                             difference);
  ready(oracle);
  for (std::string line; std::getline(std::cin, line);) {
    const bool host = line.starts_with("host ");
    const Ask ask = [&](std::size_t& of) {
      std::string difference = host ? oracle.first_host_difference(of) : oracle.first_difference_now(of);
      if (!difference.empty()) return difference;
      of = kProbe;
      return probed.first_difference(host);
    };
    judge_in_child(oracle, ask, std::stoi(host ? line.substr(5) : line), limit);
  }
}

/// Of this process.
std::ptrdiff_t threads() {
  const std::filesystem::directory_iterator tasks("/proc/self/task");
  return std::distance(begin(tasks), end(tasks));
}

void judge_native(bool killers, const Words& without) {
  const auto backend = make_native_backend();
  Oracle oracle(*backend, killers, without, [](bool) {});
  oracle.refined_alone();
  oracle.answer_all();
  double limits[2] = {0, 0};  // without the planner's questions, and with them
  for (const bool planners : {false, true}) {
    const double begin = cpu_seconds(RUSAGE_SELF);
    oracle.ask_planners(planners);
    std::size_t at = 0;
    if (const std::string difference = oracle.first_difference_now(at); !difference.empty())
      throw std::runtime_error("the unchanged program differs from itself: " + oracle.name(at) + ", " +
                               difference);
    limits[planners ? 1 : 0] = 2 + 5 * (cpu_seconds(RUSAGE_SELF) - begin);
  }
  oracle.begin_anew();
  if (threads() != 1) throw std::runtime_error("a thread is left, and no fork takes it along");
  ready(oracle);
  const Ask ask = [&](std::size_t& of) { return oracle.first_difference_now(of); };
  constexpr std::string_view kPlanners = "planners ";
  for (std::string line; std::getline(std::cin, line);) {
    const bool planners = line.starts_with(kPlanners);
    oracle.ask_planners(planners);
    judge_in_child(oracle, ask, std::stoi(planners ? line.substr(kPlanners.size()) : line),
                   limits[planners ? 1 : 0]);
  }
}

}  // namespace
}  // namespace palpate::mutation

int main(int count, char** arguments) {
  const std::vector<std::string> words(arguments + 1, arguments + count);
  const auto has = [&](const char* word) {
    return std::find(words.begin(), words.end(), word) != words.end();
  };
  const bool killers = has("--killers"), probes_alone = has("--probes"), as_gpu = has("--as-gpu");
  const auto left_out = std::find(words.begin(), words.end(), "--without");
  const std::vector<std::string> without(left_out == words.end() ? left_out : left_out + 1, words.end());
  try {
    if (words.size() >= 2 && words[0] == "gpu")
      palpate::mutation::judge_shaders(words[1], killers, probes_alone, as_gpu, without);
    else if (!words.empty() && words[0] == "native")
      palpate::mutation::judge_native(killers, without);
    else
      palpate::mutation::judge_reference(killers, without);
    return 0;
  } catch (const std::exception& failure) {
    std::fprintf(stderr, "mutant_judge: %s\n", failure.what());
    return 2;
  }
}
