#include "service/bench/output.h"

#include <fmt/format.h>
#include <sys/utsname.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "generated/commit.h"
#include "service/bench/chart_svg.h"
#include "service/cli/scene_host.h"
#include "service/report/report_assets.h"

namespace palpate {
namespace {

using Json = nlohmann::ordered_json;

/// The value behind `name` in a file of lines "name : value"; empty: none.
std::string line_of(const char* file, const std::string& name) {
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    if (!line.starts_with(name)) continue;
    const std::size_t colon = line.find(':');
    const std::size_t begin = colon == std::string::npos ? colon : line.find_first_not_of(" \t", colon + 1);
    if (begin != std::string::npos) return line.substr(begin);
  }
  return "";
}

std::string machine_text() {
  utsname system{};
  const bool known = uname(&system) == 0;
  const std::string cpu = line_of("/proc/cpuinfo", "model name");
  const double gib = std::strtod(line_of("/proc/meminfo", "MemTotal").c_str(), nullptr) / 1048576;
  return fmt::format("{}, {} threads, {:.0f} GiB, {} {}", cpu.empty() ? "unknown CPU" : cpu,
                     std::thread::hardware_concurrency(), gib, known ? system.sysname : "",
                     known ? system.release : "");
}

std::string utc_now() {
  const std::time_t now = std::time(nullptr);
  std::tm utc{};
  gmtime_r(&now, &utc);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &utc);
  return text;
}

/// Four figures are more than any repetition keeps.
std::string plain(const BenchCell& cell) {
  if (const auto* text = std::get_if<std::string>(&cell)) return *text;
  if (const auto* count = std::get_if<std::uint64_t>(&cell)) return std::to_string(*count);
  return fmt::format("{:.4g}", std::get<double>(cell));
}

/// As plain, but hardly an exponent, for people.
std::string readable(const BenchCell& cell) {
  const auto* value = std::get_if<double>(&cell);
  if (value == nullptr) return plain(cell);
  return *value >= 1000 && *value < 1e9 ? fmt::format("{:.0f}", *value) : fmt::format("{:.4g}", *value);
}

std::string csv_text(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string out = "\"";
  for (const char c : text) out += c == '"' ? std::string("\"\"") : std::string(1, c);
  return out + "\"";
}

std::string csv(const BenchTable& table, const std::vector<std::string>& facts) {
  std::string out;
  for (const std::string& column : table.columns) out += column + ",";
  out += "machine,device,commit\n";
  for (const auto& row : table.rows) {
    for (const BenchCell& cell : row) out += csv_text(plain(cell)) + ",";
    for (std::size_t i = 0; i < facts.size(); ++i) out += (i > 0 ? "," : "") + csv_text(facts[i]);
    out += "\n";
  }
  return out;
}

Json json_cell(const BenchCell& cell) {
  if (const auto* text = std::get_if<std::string>(&cell)) return text->empty() ? Json(nullptr) : Json(*text);
  if (const auto* count = std::get_if<std::uint64_t>(&cell)) return *count;
  return std::strtod(plain(cell).c_str(), nullptr);
}

Json json_rows(const BenchTable& table) {
  Json rows = Json::array();
  for (const auto& cells : table.rows) {
    Json row;
    for (std::size_t i = 0; i < cells.size(); ++i) row[table.columns[i]] = json_cell(cells[i]);
    rows.push_back(row);
  }
  return rows;
}

Json json_charts(const std::vector<BenchChart>& charts) {
  Json out = Json::array();
  for (const BenchChart& chart : charts) {
    Json series = Json::array();
    for (const auto& s : chart.series)
      series.push_back({{"label", s.label}, {"x", s.x}, {"y", s.y}, {"expected", s.expected}});
    out.push_back({{"title", chart.title},
                   {"unit", chart.unit},
                   {"labels", chart.labels},
                   {"series", series},
                   {"stacked", chart.stacked},
                   {"log_x", chart.log_x},
                   {"log_y", chart.log_y},
                   {"x_title", chart.x_title},
                   {"picture", chart.map ? chart_svg(chart) : ""}});
  }
  return out;
}

void print(const BenchTable& table) {
  std::vector<std::size_t> widths;
  for (std::size_t i = 0; i < table.columns.size(); ++i) {
    widths.push_back(table.columns[i].size());
    for (const auto& row : table.rows) widths[i] = std::max(widths[i], readable(row[i]).size());
  }
  for (std::size_t i = 0; i < widths.size(); ++i)
    fmt::print("{:<{}}{}", table.columns[i], widths[i], i + 1 < widths.size() ? "  " : "\n");
  for (const auto& row : table.rows)
    for (std::size_t i = 0; i < widths.size(); ++i) {
      const bool text = std::holds_alternative<std::string>(row[i]);
      fmt::print("{}{}",
                 text ? fmt::format("{:<{}}", readable(row[i]), widths[i])
                      : fmt::format("{:>{}}", readable(row[i]), widths[i]),
                 i + 1 < widths.size() ? "  " : "\n");
    }
}

Result<void> write_text(const std::filesystem::path& path, const std::string& text) {
  std::ofstream out(path, std::ios::binary | std::ios::trunc);
  out << text;
  out.flush();
  if (!out) return bad_value(path.string() + ": the file can't be written");
  return {};
}

/// The page with its places filled; nothing inserted is searched again.
std::string page(const Json& data) {
  std::string text = data.dump();
  for (std::size_t at = 0; (at = text.find("</", at)) != std::string::npos; at += 3)
    text.insert(at + 1, "\\");  // would end the script
  const std::vector<std::pair<std::string_view, std::string>> places = {
      {"@CSS@", std::string(assets::report_css)},
      {"@CHART_JS@", std::string(assets::chart_js)},
      {"@DATA@", text},
      {"@SCRIPT@", std::string(assets::bench_js)}};
  std::string_view rest = assets::bench_html;
  std::string out;
  for (const auto& [name, content] : places) {
    const std::size_t at = rest.find(name);
    out.append(rest.substr(0, at)).append(content);
    rest.remove_prefix(at + name.size());
  }
  return out.append(rest);
}

}  // namespace

std::string device_text(const CollisionBackend& backend, const Parts& parts) {
  const std::string engine = backend.name() + " on ";
  if (backend.name() == "gpu")
    for (const DeviceLine& line : parts.list_devices())
      if (line.kind == "vulkan" && line.usable && line.name == backend.device())
        return engine + line.name + ", " + line.reason;
  return engine + backend.device();
}

Result<std::unique_ptr<CollisionBackend>> bench_backend(const BenchOptions& options, const Parts& parts,
                                                        Console& console, BenchFacts& facts) {
  const double load = load_average();
  // Who answers which profile is part of what a time means.
  auto backend = choose_backend(options.backends.empty() ? "" : options.backends.front(), std::nullopt, parts,
                                [&](const std::string& sentence) {
                                  console.note(sentence);
                                  facts.more.emplace_back("engines", sentence);
                                });
  if (!backend) return backend.error();
  facts.device = device_text(**backend, parts);
  facts.more.emplace_back("load average", fmt::format("{:.1f} at the start", load));
  return backend;
}

std::vector<BenchCell> work_cells(const DeviceWork& work) {
  if (work == DeviceWork{}) return std::vector<BenchCell>(kWorkColumns.size(), std::string());
  return {work.submissions, work.dispatches, work.barriers, work.bytes_up, work.bytes_down, work.host_us};
}

double load_average() {
  double loads[1];
  return getloadavg(loads, 1) == 1 ? loads[0] : -1;
}

Result<void> write_bench(const std::string& directory, const BenchFacts& facts, const BenchTable& table,
                         const std::vector<BenchChart>& charts) {
  const std::filesystem::path root = directory;
  std::error_code error;
  std::filesystem::create_directories(root, error);
  if (error)
    return bad_value(fmt::format("{}: the directory can't be made ({})", directory, error.message()));

  const std::string machine = machine_text();
  if (auto done = write_text(root / "results.csv", csv(table, {machine, facts.device, PALPATE_COMMIT}));
      !done)
    return done;
  Json head{{"bench", facts.command}, {"version", PALPATE_VERSION}, {"commit", PALPATE_COMMIT},
            {"time", utc_now()},      {"machine", machine},         {"device", facts.device}};
  for (const auto& [name, value] : facts.more) head[name] = value;
  Json results = head;
  results["rows"] = json_rows(table);
  if (auto done = write_text(root / "results.json", results.dump(1) + "\n"); !done) return done;

  Json rows = Json::array();
  for (const auto& row : table.rows) {
    Json cells = Json::array();
    for (const BenchCell& cell : row) cells.push_back(readable(cell));
    rows.push_back(cells);
  }
  const Json data{
      {"facts", head}, {"charts", json_charts(charts)}, {"columns", table.columns}, {"rows", rows}};
  if (auto done = write_text(root / "report.html", page(data)); !done) return done;
  for (std::size_t i = 0; i < charts.size(); ++i)
    if (const std::string picture = chart_svg(charts[i]); !picture.empty())
      if (auto done = write_text(root / fmt::format("chart_{}.svg", i), picture); !done) return done;
  print(table);
  return {};
}

}  // namespace palpate
