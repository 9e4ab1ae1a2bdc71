#include "service/report/compare_page.h"

#include <fmt/format.h>

#include <functional>
#include <nlohmann/json.hpp>
#include <vector>

#include "service/report/markup.h"
#include "service/report/report_assets.h"
#include "service/report/report_series.h"

namespace palpate {
namespace {

std::string curve(const std::vector<RecordedTick>& ticks,
                  const std::function<double(const RecordedTick&)>& value) {
  Envelope envelope;
  for (const RecordedTick& tick : ticks) envelope.push(tick.time_s, value(tick));
  std::string out;
  envelope.append_extremes(out);
  return out;
}

/// Size of the difference at common ticks.
std::string difference_curve(const RecordedRun& first, const RecordedRun& second,
                             const std::function<Vec3(const RecordedTick&)>& value) {
  Envelope envelope;
  for (std::size_t i = 0, j = 0; i < first.ticks.size() && j < second.ticks.size();) {
    const RecordedTick &a = first.ticks[i], &b = second.ticks[j];
    if (a.tick == b.tick) envelope.push(a.time_s, glm::length(value(a) - value(b)));
    i += a.tick <= b.tick;
    j += b.tick <= a.tick;
  }
  std::string out;
  envelope.append_extremes(out);
  return out;
}

std::string row(const std::string& name, const std::string& first, const std::string& second,
                const std::string& last) {
  return "<tr><td>" + markup_text(name) + "</td><td>" + markup_text(first) + "</td><td>" +
         markup_text(second) + "</td><td>" + markup_text(last) + "</td></tr>";
}

constexpr const char* kScript = R"js('use strict';
(() => {
  const data = JSON.parse(document.getElementById('data').textContent), time = Plot.group();
  for (const chart of data) {
    const figure = document.createElement('figure');
    document.getElementById('charts').append(figure);
    Plot.draw(figure, { ...chart, xUnit: 's' }, time);
  }
})();)js";

}  // namespace

std::string difference_text(const RunDifference& difference, const TickDifference& q) {
  if (difference.common == 0) return "nothing to compare";
  if (!q.first_at_s) return "the same";
  return fmt::format("{:.3g} {} at {:.3f} s at most, root mean square {:.3g} {}, from {:.3f} s on", q.largest,
                     q.unit, q.largest_at_s, q.rms, q.unit, *q.first_at_s);
}

std::string compare_page(const RecordedRun& first, const RecordedRun& second,
                         const RunDifference& difference) {
  std::string data = "[";
  const auto chart = [&](const std::string& title, const std::string& unit, const std::string& series) {
    data += fmt::format("{}{{\"title\":\"{}\",\"unit\":\"{}\",\"series\":[{}]}}", data.size() > 1 ? "," : "",
                        title, unit, series);
  };
  const auto line = [](const char* label, const char* colour, const std::string& points) {
    return fmt::format("{{\"label\":\"{}\",\"colour\":\"{}\",\"points\":{}}}", label, colour, points);
  };
  for (const bool torque : {false, true}) {
    const std::string what = torque ? "torque" : "force", unit = torque ? "N·m" : "N";
    const auto of = [torque](const Wrench& wrench) { return torque ? wrench.torque : wrench.force; };
    for (int axis = 0; axis < 3; ++axis) {
      const auto value = [&](const RecordedTick& tick) { return of(tick.sent)[axis]; };
      chart("Sent " + what + " " + "xyz"[axis], unit,
            line("first", "first", curve(first.ticks, value)) + "," +
                line("second", "second", curve(second.ticks, value)));
    }
    chart("Size of the difference, " + what, unit,
          line("sent", "accent",
               difference_curve(first, second, [&](const RecordedTick& t) { return of(t.sent); })) +
              "," + line("response", "time", difference_curve(first, second, [&](const RecordedTick& t) {
                           return of(t.response);
                         })));
  }
  data += "]";

  std::string body = std::string("<header><h1>") +
                     (difference.same_trace() ? "The same trace" : "Two runs compared") +
                     "</h1><p>First: " + markup_text(first.folder) +
                     ". Second: " + markup_text(second.folder) + ".</p></header>";
  body += fmt::format(
      "<p class=\"lead\" style=\"margin-top:14px\">{} ticks in both, {} in the first alone, {} in the second "
      "alone; in {} only one is in contact{}.</p>",
      difference.common, difference.only_first, difference.only_second, difference.contact_differs,
      stopped_text(difference).empty() ? "" : "; " + stopped_text(difference));
  body +=
      "<h2>Tick by tick, over the ticks in both</h2><div class=\"scroll\"><table "
      "class=\"differences\"><tr><th>quantity</th><th>largest, "
      "first</th><th>largest, "
      "second</th><th>difference</th></tr>";
  for (const TickDifference& q : difference.quantities) {
    const bool sized = q.first_peak > 0 || q.second_peak > 0;
    body += row(q.name, sized ? fmt::format("{:.4g} {}", q.first_peak, q.unit) : "",
                sized ? fmt::format("{:.4g} {}", q.second_peak, q.unit) : "", difference_text(difference, q));
  }
  body += "</table></div>";
  for (const bool provenance : {true, false}) {
    body += provenance ? "<h2>Differences of provenance</h2>" : "<h2>Differences of figures</h2>";
    std::string rows;
    for (const FactDifference& fact : difference.facts)
      if (fact.provenance == provenance)
        rows += row(fact.name, fact.first, fact.second, fact.ratio ? fmt::format("{:.4g}", *fact.ratio) : "");
    body += rows.empty() ? "<p class=\"lead\">None.</p>"
                         : "<div class=\"scroll\"><table class=\"facts "
                           "differences\"><tr><th>figure</th><th>first</th><th>second</th><th>second over "
                           "first</th></tr>" +
                               rows + "</table></div>";
  }
  body +=
      "<h2>Forces</h2><p class=\"lead help\">Drag to look closer, double-click for the whole.</p><div "
      "id=\"charts\"></div>";
  return "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" "
         "content=\"width=device-width, initial-scale=1\"><meta name=\"color-scheme\" content=\"light "
         "dark\"><title>palpate "
         "compare</title><style>" +
         std::string(assets::report_css) + "</style></head>\n<body><main>" + body + "</main><script>" +
         std::string(assets::plot_js) + "</script><script type=\"application/json\" id=\"data\">" + data +
         "</script><script>" + kScript + "</script></body></html>\n";
}

}  // namespace palpate
