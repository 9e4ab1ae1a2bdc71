#include "service/bench/output.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <thread>

#include "generated/commit.h"
#include "service/cli/scene_host.h"
#include "service/cli/text_output.h"
#include "service/report/chart_svg.h"
#include "service/report/markup.h"
#include "service/report/provenance.h"
#include "service/report/report_assets.h"

namespace palpate {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kOpenRows = 40;  // a longer table is folded (chosen)

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

std::string anchor(std::size_t chart) { return fmt::format("chart-{}", chart); }

std::string findings_of(const BenchFacts& facts, const std::string& group) {
  std::string out;
  for (const auto& [where, sentence] : facts.findings)
    if (where == group) out += "<li>" + markup_text(sentence) + "</li>";
  return out.empty() ? out : "<ul class=\"findings\">" + out + "</ul>";
}

std::string figure(const Chart& chart, std::size_t number) {
  std::string out = "<figure class=\"bench\" id=\"" + anchor(number) + "\"><div class=\"picture scroll\">" +
                    chart_svg(chart) + "</div>";
  if (!chart.caption.empty()) out += "<p class=\"note\">" + markup_text(chart.caption) + "</p>";
  return out + "</figure>";
}

/// A page without scripts: contents, what the figures say, the charts with their captions, what was measured
/// on, the figures folded. Where charts have chapters, the contents name those.
std::string page(const BenchFacts& facts, const Json& head, const BenchTable& table,
                 const std::vector<Chart>& charts) {
  const std::string title = "palpate bench " + head["bench"].get<std::string>();
  std::string body = "<header><h1>" + markup_text(title) + "</h1><p>" +
                     markup_text(head["device"].get<std::string>()) + "</p></header>";
  std::string entries, chapters, group;
  for (std::size_t i = 0; i < charts.size(); ++i) {
    if (charts[i].group.empty()) {
      entries += "<a href=\"#" + anchor(i) + "\">" + markup_text(charts[i].title) + "</a>";
    } else if (charts[i].group != group) {
      const std::string place = "chapter-" + anchor(i);
      entries += "<a href=\"#" + place + "\">" + markup_text(charts[i].group) + "</a>";
      chapters += "<h2 id=\"" + place + "\">" + markup_text(charts[i].group) + "</h2>" +
                  findings_of(facts, charts[i].group);
    }
    group = charts[i].group;
    chapters += figure(charts[i], i);
  }
  if (charts.size() > 2)
    body += "<nav class=\"contents\" aria-label=\"Contents\">" + entries +
            "<a href=\"#facts\">Measured on</a><a href=\"#figures\">Figures</a></nav>";
  body += findings_of(facts, "") + chapters;
  body += "<h2 id=\"facts\">Measured on</h2><div class=\"scroll\"><table class=\"facts\">";
  for (const auto& [name, value] : head.items()) {
    if (!value.is_string()) continue;
    std::string words = name;
    std::replace(words.begin(), words.end(), '_', ' ');
    body +=
        "<tr><td>" + markup_text(words) + "</td><td>" + markup_text(value.get<std::string>()) + "</td></tr>";
  }
  body += fmt::format(
      "</table></div><h2 id=\"figures\">Figures</h2><details{}><summary>{} rows; results.csv has them, too"
      "</summary><div class=\"scroll\"><table><tr>",
      table.rows.size() <= kOpenRows ? " open" : "", table.rows.size());
  for (std::string column : table.columns) {
    std::replace(column.begin(), column.end(), '_', ' ');
    body += "<th>" + markup_text(column) + "</th>";
  }
  body += "</tr>";
  for (const auto& row : table.rows) {
    body += "<tr>";
    for (const BenchCell& cell : row) body += "<td>" + markup_text(readable(cell)) + "</td>";
    body += "</tr>";
  }
  body +=
      "</table></div></details><footer>Other work on the machine moves absolute figures. Whatever stands "
      "side by side was measured in turns: trust the ratios.</footer>";
  return "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" "
         "content=\"width=device-width, initial-scale=1\"><meta name=\"color-scheme\" content=\"light "
         "dark\"><title>" +
         markup_text(title) + "</title><style>" + std::string(assets::report_css) +
         "</style></head>\n<body><main>" + body + "</main></body></html>\n";
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

void BenchFacts::add_device(const std::string& text) {
  if (device.find(text) == std::string::npos) device += (device.empty() ? "" : "; ") + text;
}

double load_average() {
  double loads[1];
  return getloadavg(loads, 1) == 1 ? loads[0] : -1;
}

Result<void> write_bench(const std::string& directory, const BenchFacts& facts, const BenchTable& table,
                         const std::vector<Chart>& charts) {
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
  if (!facts.findings.empty()) {
    results["findings"] = Json::array();
    for (const auto& [where, sentence] : facts.findings)
      results["findings"].push_back(where.empty() ? sentence : where + ": " + sentence);
  }
  results["rows"] = json_rows(table);
  if (auto done = write_text(root / "results.json", results.dump(1) + "\n"); !done) return done;

  if (auto done = write_text(root / "report.html", page(facts, head, table, charts)); !done) return done;
  for (std::size_t i = 0; i < charts.size(); ++i)
    if (auto done = write_text(root / fmt::format("chart_{}.svg", i), chart_svg(charts[i])); !done)
      return done;
  print(table);
  return {};
}

}  // namespace palpate
