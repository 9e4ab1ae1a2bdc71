#include "service/bench/error/error_findings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace palpate {
namespace {

constexpr double kTenfold = 10;

/// Median time and relative median error of each setting of a method; what can't be compared is left out.
std::vector<std::pair<double, double>> points_of(const ErrorCurves& curves, const ErrorTruths& truths,
                                                 std::size_t quantity, Profile profile) {
  std::vector<std::pair<double, double>> out;
  for (const ErrorPoint& point : curves.points) {
    if (point.setting.profile != profile || point.result.errors[quantity].empty()) continue;
    const double error = relative_error(point, truths, quantity, 0.5);
    if (std::isfinite(error)) out.emplace_back(percentile(point.result.times_us, 0.5), error);
  }
  std::sort(out.begin(), out.end());
  return out;
}

std::string time_text(double us) {
  return us < 999.5       ? fmt::format("{:.3g} µs", us)
         : us < 999'500.0 ? fmt::format("{:.3g} ms", us / 1000)
                          : fmt::format("{:.0f} ms", us / 1000);
}
/// Two digits, or all before the point: no exponents in sentences.
std::string number_text(double value) {
  return value < 99.5 ? fmt::format("{:.2g}", value) : fmt::format("{:.0f}", value);
}

std::string share_text(double part) { return number_text(100 * part) + " %"; }

/// The least error that is there after so long; empty: nothing answers yet.
std::optional<double> best_by(const std::vector<std::pair<double, double>>& points, double us) {
  std::optional<double> out;
  for (const auto& [time, error] : points)
    if (time <= us) out = out ? std::min(*out, error) : error;
  return out;
}

}  // namespace

std::optional<MethodLead> lead_of(const ErrorCurves& curves, const ErrorTruths& truths,
                                  std::size_t quantity) {
  const auto refined = points_of(curves, truths, quantity, Profile::kRefined),
             paper = points_of(curves, truths, quantity, Profile::kPaper);
  if (refined.empty() || paper.empty()) return std::nullopt;
  const auto nearer = [](const auto& a, const auto& b) { return a.second < b.second; };
  const auto best = std::min_element(paper.begin(), paper.end(), nearer);
  MethodLead out{.paper_error = best->second,
                 .paper_us = best->first,
                 .refined_least_us = refined.front().first,
                 .refined_best_error = std::min_element(refined.begin(), refined.end(), nearer)->second};
  for (const auto& [us, error] : refined)  // in the order of time
    if (error <= best->second) {
      out.us = us, out.error = error;
      break;
    }
  return out;
}

std::string where_wins(const ErrorCurves& curves, const ErrorTruths& truths, std::size_t quantity) {
  const auto refined = points_of(curves, truths, quantity, Profile::kRefined),
             paper = points_of(curves, truths, quantity, Profile::kPaper);
  if (refined.empty() || paper.empty()) return {};
  std::vector<double> times;
  for (const auto* points : {&refined, &paper})
    for (const auto& [us, error] : *points) times.push_back(us);
  std::sort(times.begin(), times.end());
  std::string out, last;
  for (const double us : times) {
    const auto r = best_by(refined, us), p = best_by(paper, us);
    const std::string now = !p        ? "refined alone answers"
                            : !r      ? "paper alone answers"
                            : *r < *p ? "refined is nearer"
                            : *p < *r ? "paper is nearer"
                                      : "both are as near";
    if (now == last) continue;
    out += fmt::format("{}from {} on {}", out.empty() ? "" : ", ", time_text(us), now);
    last = now;
  }
  return out;
}

std::string lead_sentence(const MethodLead& lead) {
  const std::string best =
      fmt::format("paper's best is {} off in {}", share_text(lead.paper_error), time_text(lead.paper_us));
  if (!lead.us)
    return fmt::format("{}; refined gets no nearer than {}, so paper wins where so much time is left", best,
                       share_text(lead.refined_best_error));
  std::string out = fmt::format("{}; refined is {} off in {}, {} times sooner", best, share_text(*lead.error),
                                time_text(*lead.us), number_text(lead.factor()));
  if (lead.factor() >= kTenfold) return out;
  if (*lead.us <= 1.2 * lead.refined_least_us)  // within a fifth, which like runs differ by
    return out + ": less than ten times, for that is its soonest frame: no setting of it takes less";
  return out +
         fmt::format(
             ": less than ten times, for so small an error takes it more samples than its soonest frame "
             "of {} has",
             time_text(lead.refined_least_us));
}

std::string lead_summary(const std::string& engines,
                         const std::vector<std::pair<std::string, MethodLead>>& leads) {
  std::string tenfold, less, none;
  std::size_t count = 0;
  for (const auto& [name, lead] : leads) {
    std::string& list = !lead.us ? none : lead.factor() >= kTenfold ? tenfold : less;
    list += (list.empty() ? "" : "; ") + name;
    if (lead.us) list += fmt::format(" ({} ×)", number_text(lead.factor()));
    if (lead.us && lead.factor() >= kTenfold) ++count;
  }
  std::string out = fmt::format(
      "{}: refined has an error of the force as small as paper's smallest ten times sooner or more on {} of "
      "{}",
      engines, count, leads.size());
  out += tenfold.empty() ? "." : ": " + tenfold + ".";
  if (!less.empty()) out += " Sooner by less, or later (below 1): " + less + ".";
  if (!none.empty()) out += " Not as small at all: " + none + ".";
  return out;
}

}  // namespace palpate
