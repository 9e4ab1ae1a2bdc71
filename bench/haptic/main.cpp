// haptic_yardstick OUT [--methods a,b] [--cases TEXT] [--poses N] [--clock wall|cpu] [--part
// NAME=FIXED.ply,TOOL.ply,POSES.csv]… Each method meets each case in a process of its own, so that memory is
// its own and a crash is a row.
#include <fmt/format.h>
#include <sched.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <fstream>
#include <stdexcept>

#include "bench/haptic/csv.h"
#include "bench/haptic/measure.h"
#include "bench/haptic/parts.h"

namespace yardstick {
namespace {

constexpr unsigned kMostSeconds = 600;  ///< a method may take for a case

struct Options {
  std::string out, methods, cases;
  Amount amount;
  bool cpu_clock = false;
  std::vector<std::string> parts;
};

Options options_of(int argc, char** argv) {
  Options out;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    const auto value = [&]() -> std::string {
      if (++i == argc) throw std::invalid_argument(word + " wants a value");
      return argv[i];
    };
    if (word == "--methods") {
      out.methods = value();
    } else if (word == "--cases") {
      out.cases = value();
    } else if (word == "--part") {
      out.parts.push_back(value());
    } else if (word == "--clock") {
      const std::string clock = value();
      if (clock != "wall" && clock != "cpu")
        throw std::invalid_argument("--clock " + clock + ": must be wall or cpu");
      out.cpu_clock = clock == "cpu";
    } else if (word == "--poses") {
      const std::string text = value();
      std::size_t n = 0;
      const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), n);
      if (error != std::errc() || end != text.data() + text.size() || n < 20 || n > 100000)
        throw std::invalid_argument("--poses " + text + ": must be from 20 to 100000");
      out.amount = {n, 2 * n, n / 2};
    } else if (out.out.empty() && word[0] != '-') {
      out.out = word;
    } else {
      throw std::invalid_argument("'" + word + "' is not known");
    }
  }
  if (out.out.empty()) throw std::invalid_argument("a folder for the results is missing");
  return out;
}

std::vector<Case> cases_of(const Options& options) {
  std::vector<Case> out;
  for (auto make : {closed_forms, fits, stiff_cases})
    for (Case& subject : make(options.amount)) out.push_back(std::move(subject));
  for (const std::string& files : options.parts) out.push_back(part(files, options.amount));
  std::erase_if(out, [&](const Case& c) { return c.name.find(options.cases) == std::string::npos; });
  if (out.empty()) throw std::invalid_argument("no case is named like '" + options.cases + "'");
  return out;
}

std::vector<AdapterMaker> methods_of(const Options& options) {
  std::vector<AdapterMaker> out;
  for (const AdapterMaker& maker : adapters())
    if (options.methods.empty() ||
        ("," + options.methods + ",").find("," + maker.key + ",") != std::string::npos)
      out.push_back(maker);
  if (out.empty()) throw std::invalid_argument("--methods " + options.methods + ": none of them is known");
  return out;
}

void append_to(const std::string& file, const std::string& line) {
  std::ofstream(file, std::ios::app) << line << std::flush;
}

/// "ball in a plane" → "ball_in_a_plane".
std::string file_name(std::string name) {
  for (char& c : name)
    if (std::isalnum(static_cast<unsigned char>(c)) == 0) c = '_';
  return name;
}

/// That this process may use.
int processors() {
  cpu_set_t set;
  CPU_ZERO(&set);
  return sched_getaffinity(0, sizeof set, &set) == 0 ? CPU_COUNT(&set) : 1;
}

/// In the child. 0: the row is written; 3: a sentence why not.
int one(const Options& options, const Case& subject, const AdapterMaker& maker) {
  alarm(kMostSeconds);
  const auto adapter = maker.make();
  try {
    const Measured measured = measure(*adapter, subject, options.amount.rest, options.cpu_clock);
    write_samples(fmt::format("{}/raw/{}.{}.csv", options.out, file_name(subject.name), maker.key), subject,
                  measured);
    append_to(options.out + "/figures.csv",
              figures_row(subject, maker.key, measured, figures_of(subject, measured)));
    return 0;
  } catch (const std::exception& error) {
    std::string sentence = error.what();
    std::replace(sentence.begin(), sentence.end(), '"', '\'');
    append_to(options.out + "/failures.csv",
              fmt::format("\"{}\",{},\"{}\"\n", subject.name, maker.key, sentence));
    return 3;
  }
}

int run(const Options& options) {
  const std::vector<Case> cases = cases_of(options);
  const std::vector<AdapterMaker> methods = methods_of(options);
  std::filesystem::create_directories(options.out + "/raw");
  std::ofstream(options.out + "/figures.csv") << figures_head();
  std::ofstream(options.out + "/failures.csv") << "case,method,sentence\n";
  std::ofstream subjects(options.out + "/cases.csv");
  subjects << "case,group,fixed_triangles,tool_triangles,gyration_m,truth\n";
  for (const Case& c : cases)
    subjects << fmt::format("\"{}\",{},{},{},{:.6g},\"{}\"\n", c.name, c.group, c.fixed.triangles.size(),
                            c.tool.triangles.size(), c.gyration, c.truth_from);
  subjects.close();
  std::ofstream(options.out + "/facts.csv") << fmt::format(
      "clock,cores,poses\n{},{},{}\n", options.cpu_clock ? "cpu" : "wall", processors(), options.amount.path);
  std::ofstream known(options.out + "/methods.csv");
  known << "method,name,version\n";
  for (const AdapterMaker& maker : methods) {
    const auto adapter = maker.make();
    known << fmt::format("{},\"{}\",\"{}\"\n", maker.key, adapter->name(), adapter->version());
  }
  known.close();
  for (const Case& subject : cases)
    for (const AdapterMaker& maker : methods) {
      fmt::print("{}: {}\n", subject.name, maker.key);
      std::fflush(stdout);
      const pid_t child = fork();
      if (child < 0) throw std::runtime_error("no process for a method");
      if (child == 0) _exit(one(options, subject, maker));
      int status = 0;
      waitpid(child, &status, 0);
      if (WIFSIGNALED(status))
        append_to(
            options.out + "/failures.csv",
            fmt::format("\"{}\",{},\"{}\"\n", subject.name, maker.key,
                        WTERMSIG(status) == SIGALRM ? fmt::format("took longer than {} s", kMostSeconds)
                                                    : fmt::format("ended by signal {}", WTERMSIG(status))));
    }
  return 0;
}

}  // namespace
}  // namespace yardstick

int main(int argc, char** argv) {
  try {
    return yardstick::run(yardstick::options_of(argc, argv));
  } catch (const std::invalid_argument& error) {
    fmt::print(stderr, "haptic_yardstick: {}\n", error.what());
    return 2;
  } catch (const std::exception& error) {
    fmt::print(stderr, "haptic_yardstick: {}\n", error.what());
    return 3;
  }
}
