#include "tests/mutation/limits.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <utility>

namespace palpate::mutation {
namespace {

using Limit = Limits::Limit;

const std::vector<Limit>& limits() {
  static const std::vector<Limit> all = {
      {"",
       "kMaxGroupsX",
       3,
       {"groups_for("},
       {"ball_on_block", "ball_on_block_paper", "needle_of_pieces", "folds_in_a_row", "open_ball",
        "box_swallowed_held", "swallowed_at_ties", "bead_in_the_middle_held"}},
      {"shaders/frame/voxel_touch.comp", "kLoopBudget", 0, {}, {"ball_on_block", "ball_on_block_paper"}},
      {"shaders/response/points_sum.comp", "kLoopBudget", 0, {}, {"ball_on_block_paper", "two_sheets_paper"}},
      {"shaders/response/points_sum.comp", "kLoopBudget", 3, {}, {"ball_on_block_paper", "two_sheets_paper"}},
      {"shaders/frame/sample_scan.comp", "", 0, {}, {"sheet_tool", "ball_on_block"}, "samples", true},
      {"shaders/frame/sample_scan.comp",
       "",
       0,
       {},
       {"ball_on_block"},
       "samples near the tool's surface",
       true},
      {"shaders/frame/sample_scan.comp",
       "",
       0,
       {},
       {"between_the_samples"},
       "samples near the tool's surface",
       true},
      {"shaders/field/field_members.comp", "kLoopBudget", 0, {}, {"ball_on_block", "ball_over_bead"}},
      {"shaders/field/field_members.comp", "", 0, {}, {"needle"}, "extra samples"},
      {"shaders/field/field_points.comp", "", 0, {}, {"ball_on_block"}, "samples of the tool"},
      {"shaders/lib/ignored.glsl", "", 0, {}, {"two_sheets_ignoring"}, "ignored patches"},
      {"shaders/frame/sample_walk.comp", "", 0, {}, {"ball_on_block", "open_ball"}, "samples"}};
  return all;
}

constexpr std::uint32_t kFullTable = 64, kMost = 30000;
constexpr double kNoHurry = 600;  // seconds: what the unchanged modules take is nobody's fault

}  // namespace

const std::string& Limits::original(const std::string& name) {
  std::string& code = originals_[name];
  if (code.empty()) code = compile_shader(root_, name, nullptr).value();
  return code;
}

std::vector<Limits::Module> Limits::with(const Limit& limit, std::uint32_t value,
                                         const std::vector<std::string>& names) {
  std::vector<Module> out;
  if (*limit.constant == 0) return out;
  const SmallConstant constant{limit.constant, value};
  for (const std::string& name : names) {
    std::string& code = small_[constant.name + " " + std::to_string(value) + " " + name];
    if (code.empty()) code = compile_shader(root_, name, nullptr, &constant).value();
    if (code != original(name)) out.push_back({name, original(name), code});
  }
  return out;
}

std::vector<std::string> Limits::having(const std::vector<const char*>& words) {
  if (texts_.empty()) {
    for (const char* folder : {"shaders/frame", "shaders/response", "shaders/field"})
      for (const auto& entry : std::filesystem::directory_iterator(root_ + "/" + folder)) {
        std::ifstream file(entry.path());
        texts_[std::string(folder) + "/" + entry.path().filename().string()] = {
            std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
      }
  }
  std::vector<std::string> out;
  for (const auto& [name, text] : texts_)
    if (std::any_of(words.begin(), words.end(),
                    [&, &of = text](const char* word) { return of.find(word) != std::string::npos; }))
      out.push_back(name);
  return out;
}

std::string Limits::swap(const std::vector<Module>& modules) {
  device_.restore();
  for (const Module& m : modules)
    if (auto r = device_.swap(m.before, m.after, false); !r) return r.error().sentence;
  return {};
}

Limits::Told Limits::tell(const Limit& limit, std::uint32_t value, std::size_t of) {
  if (*limit.list != 0) device_.first_capacity({{limit.list, *limit.constant == 0 ? value : kFullTable}});
  device_.without_samples(limit.unlisted);
  Told all;
  if (std::string failure = oracle_.tell(of, all); !failure.empty()) all.push_back(failure);
  device_.without_samples(false);
  device_.first_capacity({});
  return all;
}

std::vector<Limits::Told> Limits::known(const Limit& limit, std::uint32_t value,
                                        const std::vector<Module>& modules,
                                        const std::vector<std::size_t>& of) {
  std::string key = std::string(limit.constant) + "|" + limit.list + (limit.unlisted ? "|unlisted " : "| ") +
                    std::to_string(value);
  for (const Module& m : modules) key += " " + m.name;
  std::vector<Told> out;
  bool swapped = false;
  for (const std::size_t c : of) {
    auto [at, fresh] = known_.try_emplace(key + " " + oracle_.name(c));
    if (fresh) {
      if (const std::string failure = std::exchange(swapped, true) ? "" : swap(modules); !failure.empty())
        throw std::runtime_error(failure);
      at->second = tell(limit, value, c);
    }
    out.push_back(at->second);
  }
  return out;
}

std::uint32_t Limits::smallest(const Limit& limit, const std::vector<std::string>& names, std::size_t of) {
  const auto enough = [&](std::uint32_t value) {
    const Told told = known(limit, value, with(limit, value, names), {of})[0];
    return std::all_of(told.begin(), told.end(), [](const std::string& t) { return t.empty(); });
  };
  std::uint32_t low = 1, high = 1;  // the smallest is within [low, high]
  while (high < kMost && !enough(high)) low = high + 1, high *= 2;
  while (low < high) {
    const std::uint32_t middle = low + (high - low) / 2;
    if (enough(middle))
      high = middle;
    else
      low = middle + 1;
  }
  return high;
}

std::string Limits::ask(const Limit& limit, std::uint32_t value, const TextChange& change,
                        const std::vector<std::string>& modules, const std::vector<std::size_t>& of,
                        std::size_t& at) {
  std::vector<Module> all = with(limit, value, limit.words.empty() ? modules : having(limit.words));
  if (all.empty() && *limit.constant != 0) return {};
  const std::vector<Told> expected = known(limit, value, all, of);
  const SmallConstant constant{limit.constant, value};
  for (const std::string& m : modules) {
    auto found = std::find_if(all.begin(), all.end(), [&](const Module& c) { return c.name == m; });
    if (found == all.end()) found = all.insert(all.end(), Module{m, original(m), {}});
    found->after = compile_shader(root_, m, &change, *limit.constant != 0 ? &constant : nullptr).value();
  }
  std::string difference = swap(all);
  for (std::size_t i = 0; i < of.size() && difference.empty(); ++i) {
    at = of[i];
    oracle_.before_case(oracle_.seconds(at));
    if (tell(limit, value, at) != expected[i])
      difference = std::string("what is told with ") + (*limit.constant != 0 ? limit.constant : limit.list) +
                   " of " + std::to_string(value);
  }
  device_.restore();
  oracle_.before_case(kNoHurry);
  return difference;
}

std::string Limits::first_difference(const TextChange& change, const std::vector<std::string>& modules,
                                     std::size_t& of) {
  oracle_.before_case(kNoHurry);
  for (const Limit& limit : limits()) {
    // A change in shaders/lib is in too many modules at once; probes ask those that number workgroups.
    if (*limit.file != 0 ? change.file != limit.file : change.file.starts_with("shaders/lib/")) continue;
    std::vector<std::size_t> cases;
    for (const char* name : limit.cases)
      if (const auto found = oracle_.find(name)) cases.push_back(*found);
    if (limit.value != 0) {
      if (std::string difference = ask(limit, limit.value, change, modules, cases, of); !difference.empty())
        return difference;
      continue;
    }
    for (const std::size_t c : cases) {
      const std::uint32_t enough = smallest(limit, modules, c);
      for (const std::uint32_t value : {enough, enough - 1})
        if (value != 0)
          if (std::string difference = ask(limit, value, change, modules, {c}, of); !difference.empty())
            return difference;
    }
  }
  device_.restore();
  return {};
}

}  // namespace palpate::mutation
