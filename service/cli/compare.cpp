#include "service/cli/compare.h"

#include <fmt/format.h>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <algorithm>
#include <array>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "service/cli/output_folder.h"
#include "service/cli/text_output.h"
#include "service/report/compare_page.h"
#include "service/report/run_difference.h"

namespace palpate {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kCompareFooter =
    R"(Ticks are matched by their time. Prints where and by how much place, turn, response and sent forces differ, and the figures of summary.json that differ, provenance first:
version, commit, machine, engine, command, hashes of scene and meshes, plan. Two runs in virtual time of one scene, device and profile should have the same trace on every engine.
With --out DIR also compare.json and compare.html, where the forces lie over each other. Exit code 0, whether they differ or not.

Example:
  palpate compare before after --out difference)";

Json json_of(const CompareOptions& options, const RunDifference& difference) {
  Json quantities = Json::array(), facts = Json::array();
  for (const TickDifference& q : difference.quantities) {
    const auto of_common = [&](double value) { return difference.common > 0 ? Json(value) : Json(nullptr); };
    Json one{{"quantity", q.name},
             {"unit", q.unit},
             {"largest", of_common(q.largest)},
             {"largest_at_s", of_common(q.largest_at_s)},
             {"rms", of_common(q.rms)},
             {"first_at_s", nullptr}};
    if (q.first_at_s) one["first_at_s"] = *q.first_at_s;
    quantities.push_back(std::move(one));
  }
  for (const FactDifference& fact : difference.facts) {
    Json one{{"figure", fact.name}, {"first", fact.first}, {"second", fact.second}};
    if (fact.ratio) one["second_over_first"] = *fact.ratio;
    facts.push_back(std::move(one));
  }
  return {{"first", options.first},
          {"second", options.second},
          {"same_trace", difference.same_trace()},
          {"ticks",
           {{"common", difference.common},
            {"only_first", difference.only_first},
            {"only_second", difference.only_second},
            {"contact_differs", difference.contact_differs}}},
          {"stopped", {{"first", difference.first_stopped}, {"second", difference.second_stopped}}},
          {"quantities", quantities},
          {"differences", facts}};
}

void print(const RunDifference& difference) {
  fmt::print(
      "{}: {} ticks in both, {} in the first alone, {} in the second alone; in {} only one is in contact\n",
      difference.same_trace() ? "the same trace" : "the traces differ", difference.common,
      difference.only_first, difference.only_second, difference.contact_differs);
  if (const std::string stopped = stopped_text(difference); !stopped.empty()) fmt::print("{}\n", stopped);
  for (const TickDifference& q : difference.quantities)
    fmt::print("  {:<18} {}\n", q.name, difference_text(difference, q));
  if (difference.facts.empty()) {
    fmt::print("no figure differs\n");
    return;
  }
  std::size_t name = 0, first = 0;
  for (const FactDifference& fact : difference.facts)
    name = std::max(name, fact.name.size()),
    first = std::max(first, std::min<std::size_t>(40, fact.first.size()));
  for (const FactDifference& fact : difference.facts)
    fmt::print("  {:<{}}  {:<{}}  {}{}\n", fact.name, name, fact.first.empty() ? "–" : fact.first, first,
               fact.second.empty() ? "–" : fact.second,
               fact.ratio ? fmt::format("  × {:.4g}", *fact.ratio) : "");
}

constexpr std::array kCompareFiles{"compare.json", "compare.html"};

Result<void> compare_command(const CompareOptions& options) {
  if (!options.out.empty())
    if (auto done = check_output_folder(options.out, kCompareFiles, "a comparison's", options.overwrite);
        !done)
      return done;
  const auto first = read_run(options.first);
  if (!first) return first.error();
  const auto second = read_run(options.second);
  if (!second) return second.error();
  const RunDifference difference = difference_of(*first, *second);
  const Json json = json_of(options, difference);
  const auto dump = [&](int indent) {
    return json.dump(indent, ' ', false, Json::error_handler_t::replace) + "\n";
  };
  if (!options.out.empty()) {
    const std::filesystem::path folder = options.out;
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    if (error) return bad_value(options.out + ": the directory can't be made (" + error.message() + ")");
    if (auto done = write_text(folder / "compare.json", dump(1)); !done) return done;
    if (auto done = write_text(folder / "compare.html", compare_page(*first, *second, difference)); !done)
      return done;
  }
  if (options.json)
    fmt::print("{}", dump(-1));
  else
    print(difference);
  return {};
}

}  // namespace

void add_compare_command(CLI::App& app, CompareOptions& options, Result<void>& outcome) {
  CLI::App* compare =
      app.add_subcommand("compare", "tell in what two runs differ: forces tick by tick, figures, provenance");
  compare->add_option("first", options.first, "folder that a run left")->required()->type_name("RUN");
  compare->add_option("second", options.second, "another")->required()->type_name("RUN");
  compare->add_flag("--json", options.json, "one JSON object");
  compare->add_option("--out", options.out, "directory for compare.json and compare.html")->type_name("DIR");
  compare->add_flag("--overwrite", options.overwrite,
                    "replace the files of a comparison that are in --out already");
  compare->footer(kCompareFooter);
  compare->callback([&] { outcome = compare_command(options); });
}

}  // namespace palpate
