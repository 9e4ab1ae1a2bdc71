#include "service/report/run_difference.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <string_view>

namespace palpate {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::array<const char*, 21> kColumns = {"time_s",
                                                  "x_m",
                                                  "y_m",
                                                  "z_m",
                                                  "qx",
                                                  "qy",
                                                  "qz",
                                                  "qw",
                                                  "force_x_N",
                                                  "force_y_N",
                                                  "force_z_N",
                                                  "torque_x_Nm",
                                                  "torque_y_Nm",
                                                  "torque_z_Nm",
                                                  "response_force_x_N",
                                                  "response_force_y_N",
                                                  "response_force_z_N",
                                                  "response_torque_x_Nm",
                                                  "response_torque_y_Nm",
                                                  "response_torque_z_Nm",
                                                  "contact"};

std::vector<std::string_view> cells_of(std::string_view line) {
  std::vector<std::string_view> out;
  for (std::size_t begin = 0;;) {
    const std::size_t comma = line.find(',', begin);
    out.push_back(line.substr(begin, comma == std::string_view::npos ? comma : comma - begin));
    if (comma == std::string_view::npos) return out;
    begin = comma + 1;
  }
}

Result<std::vector<RecordedTick>> read_trace(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  std::string line;
  if (!in || !std::getline(in, line)) return bad_value(file + ": the file can't be read");
  std::array<std::size_t, kColumns.size()> places{};
  const auto header = cells_of(line);
  for (std::size_t i = 0; i < kColumns.size(); ++i) {
    const auto found = std::find(header.begin(), header.end(), kColumns[i]);
    if (found == header.end())
      return bad_value(
          fmt::format("{}: the column '{}' is missing, so it is no run's trace", file, kColumns[i]));
    places[i] = static_cast<std::size_t>(found - header.begin());
  }
  const std::size_t width = header.size();
  std::vector<RecordedTick> out;
  for (std::size_t number = 2; std::getline(in, line); ++number) {
    const auto cells = cells_of(line);
    if (cells.size() != width)
      return bad_value(
          fmt::format("{}, line {}: {} values instead of {}", file, number, cells.size(), width));
    std::array<double, kColumns.size()> v{};
    for (std::size_t i = 0; i < v.size(); ++i) {
      const std::string_view cell = cells[places[i]];
      const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), v[i]);
      if (error != std::errc() || end != cell.data() + cell.size())
        return bad_value(fmt::format("{}, line {}: '{}' is no number", file, number, cell));
    }
    if (!(std::fabs(v[0]) < 1e9))
      return bad_value(fmt::format("{}, line {}: {} is no time", file, number, v[0]));
    RecordedTick tick;
    tick.time_s = v[0];
    tick.tick = std::llround(v[0] * 1000);
    if (!out.empty() && tick.tick <= out.back().tick)
      return bad_value(fmt::format("{}, line {}: the time does not grow", file, number));
    tick.pose = {Vec3(v[1], v[2], v[3]), Quat(v[7], v[4], v[5], v[6])};
    tick.sent = {Vec3(v[8], v[9], v[10]), Vec3(v[11], v[12], v[13])};
    tick.response = {Vec3(v[14], v[15], v[16]), Vec3(v[17], v[18], v[19])};
    tick.contact = v[20] != 0;
    out.push_back(tick);
  }
  return out;
}

/// Of two unit quaternions, rad.
double angle_between(const Quat& a, const Quat& b) {
  const Quat turn = a * glm::conjugate(b);
  return 2 * std::atan2(glm::length(Vec3(turn.x, turn.y, turn.z)), std::fabs(turn.w));
}

std::string text_of(const Json& value) {
  if (value.is_null()) return "";
  if (value.is_string()) return value.get<std::string>();
  if (value.is_number_float()) return fmt::format("{:.6g}", value.get<double>());
  return value.dump(-1, ' ', false, Json::error_handler_t::replace);
}

/// Names as people say them: "/frame_us/p50" is "frame us p50".
std::string words_of(std::string pointer) {
  pointer.erase(0, 1);
  std::replace_if(
      pointer.begin(), pointer.end(), [](char c) { return c == '/' || c == '_'; }, ' ');
  return pointer;
}

/// Figures by name; a list of words is one figure, and a run's inputs go by their file names, whose folders
/// may differ.
void flatten(const Json& value, const std::string& pointer, std::vector<std::pair<std::string, Json>>& out) {
  if (pointer.ends_with("_histogram_us") || pointer.ends_with("_histogram_ticks") ||
      pointer == "/provenance/time" || pointer == "/notes")
    return;
  if (pointer == "/provenance/inputs") {
    std::size_t number = 0;
    for (const Json& input : value) {
      const std::string name = input.is_object() ? text_of(input.value("name", Json())) : "";
      const std::string place = number == 0 ? "scene" : fmt::format("input {}", number);
      out.emplace_back(pointer + "/" + place,
                       std::filesystem::path(name).filename().string() + " " +
                           (input.is_object() ? text_of(input.value("sha256", Json())) : ""));
      ++number;
    }
    return;
  }
  if (value.is_object()) {
    for (const auto& [key, below] : value.items()) flatten(below, pointer + "/" + key, out);
  } else if (value.is_array()) {
    std::string all;
    for (const Json& one : value) all += (all.empty() ? "" : ", ") + text_of(one);
    out.emplace_back(pointer, all);
  } else {
    out.emplace_back(pointer, value);
  }
}

std::vector<FactDifference> fact_differences(const RecordedRun& first, const RecordedRun& second) {
  std::vector<std::pair<std::string, Json>> a, b;
  flatten(Json::parse(first.summary), "", a);
  flatten(Json::parse(second.summary), "", b);
  const auto find = [](const auto& list, const std::string& name) {
    const auto found =
        std::find_if(list.begin(), list.end(), [&](const auto& one) { return one.first == name; });
    return found == list.end() ? Json() : found->second;
  };
  std::vector<FactDifference> out;
  std::set<std::string> seen;
  for (const auto* list : {&a, &b})
    for (const auto& [name, ignored] : *list) {
      if (!seen.insert(name).second) continue;
      const Json left = find(a, name), right = find(b, name);
      if (left == right) continue;
      FactDifference fact{words_of(name), text_of(left), text_of(right), {}, name.starts_with("/provenance")};
      if (left.is_number() && right.is_number() && left.get<double>() != 0)
        fact.ratio = right.get<double>() / left.get<double>();
      out.push_back(std::move(fact));
    }
  std::stable_partition(out.begin(), out.end(), [](const FactDifference& fact) { return fact.provenance; });
  return out;
}

}  // namespace

Result<RecordedRun> read_run(const std::string& folder) {
  const std::filesystem::path root = folder;
  RecordedRun out;
  out.folder = folder;
  const std::string file = (root / "summary.json").string();
  std::ifstream in(file, std::ios::binary);
  std::ostringstream text;
  if (in) text << in.rdbuf();
  if (!in) return bad_value(file + ": the file can't be read, so the folder is no run's");
  out.summary = text.str();
  const Json summary = Json::parse(out.summary, nullptr, false);
  if (!summary.is_object()) return bad_value(file + ": is no run's summary");
  if (const auto stopped = summary.find("stopped"); stopped != summary.end() && stopped->is_boolean())
    out.stopped = stopped->get<bool>();
  auto ticks = read_trace((root / "trace.csv").string());
  if (!ticks) return ticks.error();
  out.ticks = std::move(*ticks);
  return out;
}

bool RunDifference::same_trace() const {
  return only_first == 0 && only_second == 0 && contact_differs == 0 &&
         std::all_of(quantities.begin(), quantities.end(), [](const auto& q) { return !q.first_at_s; });
}

std::string stopped_text(const RunDifference& difference) {
  if (difference.first_stopped && difference.second_stopped) return "both runs were stopped before their end";
  if (difference.first_stopped) return "the first run was stopped before its end";
  if (difference.second_stopped) return "the second run was stopped before its end";
  return {};
}

RunDifference difference_of(const RecordedRun& first, const RecordedRun& second) {
  RunDifference out;
  out.first_stopped = first.stopped;
  out.second_stopped = second.stopped;
  out.quantities = {{{"place of the tool", "m", 0, 0, 0, 0, 0, {}},
                     {"turn of the tool", "rad", 0, 0, 0, 0, 0, {}},
                     {"response's force", "N", 0, 0, 0, 0, 0, {}},
                     {"response's torque", "N·m", 0, 0, 0, 0, 0, {}},
                     {"sent force", "N", 0, 0, 0, 0, 0, {}},
                     {"sent torque", "N·m", 0, 0, 0, 0, 0, {}}}};
  const auto tell = [](TickDifference& q, double time_s, double difference, bool differs) {
    if (differs && !q.first_at_s) q.first_at_s = time_s;
    if (!std::isfinite(difference)) difference = differs ? HUGE_VAL : 0;
    if (difference > q.largest) q.largest = difference, q.largest_at_s = time_s;
    q.rms += difference * difference;
  };
  std::size_t i = 0, j = 0;
  while (i < first.ticks.size() && j < second.ticks.size()) {
    const RecordedTick &a = first.ticks[i], &b = second.ticks[j];
    if (a.tick != b.tick) {
      ++(a.tick < b.tick ? out.only_first : out.only_second);
      ++(a.tick < b.tick ? i : j);
      continue;
    }
    ++i, ++j, ++out.common;
    out.contact_differs += a.contact != b.contact;
    auto& q = out.quantities;
    tell(q[0], a.time_s, glm::length(a.pose.position - b.pose.position), a.pose.position != b.pose.position);
    const bool turned = a.pose.rotation != b.pose.rotation;
    tell(q[1], a.time_s, turned ? angle_between(a.pose.rotation, b.pose.rotation) : 0, turned);
    const std::array<std::pair<const Vec3*, const Vec3*>, 4> vectors = {
        {{&a.response.force, &b.response.force},
         {&a.response.torque, &b.response.torque},
         {&a.sent.force, &b.sent.force},
         {&a.sent.torque, &b.sent.torque}}};
    for (std::size_t k = 0; k < vectors.size(); ++k) {
      const auto& [one, other] = vectors[k];
      tell(q[2 + k], a.time_s, glm::length(*one - *other), *one != *other);
      q[2 + k].first_peak = std::max(q[2 + k].first_peak, glm::length(*one));
      q[2 + k].second_peak = std::max(q[2 + k].second_peak, glm::length(*other));
    }
  }
  out.only_first += first.ticks.size() - i;
  out.only_second += second.ticks.size() - j;
  for (TickDifference& q : out.quantities)
    q.rms = out.common > 0 ? std::sqrt(q.rms / static_cast<double>(out.common)) : 0;
  out.facts = fact_differences(first, second);
  return out;
}

}  // namespace palpate
