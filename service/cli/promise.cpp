#include "service/cli/promise.h"

#include <fmt/format.h>

#include <cmath>

#include "service/bench/error/error_sweep.h"

namespace palpate {
namespace {

constexpr double kPromised = 0.95, kLuck = 0.05;

/// ln of n over k.
double ln_choose(double n, double k) {
  return std::lgamma(n + 1) - std::lgamma(k + 1) - std::lgamma(n - k + 1);
}

}  // namespace

double chance_of_breaking(std::size_t over, std::size_t n) {
  double out = 0;
  for (std::size_t i = over; i <= n; ++i) {
    const auto all = static_cast<double>(n), k = static_cast<double>(i);
    out += std::exp(ln_choose(all, k) + k * std::log(1 - kPromised) + (all - k) * std::log(kPromised));
  }
  return out;
}

double chance_beyond_p95(std::size_t over, std::size_t n, std::size_t m) {
  // The p95 is the rank-th of the m; of all orders of m + n values those with k of the n beyond it.
  const double others = static_cast<double>(m), all = static_cast<double>(n),
               rank = std::ceil(kPromised * others);
  double out = 0;
  for (std::size_t i = over; i <= n; ++i) {
    const auto k = static_cast<double>(i);
    out += std::exp(ln_choose(rank - 1 + all - k, all - k) + ln_choose(others - rank + k, k) -
                    ln_choose(others + all, all));
  }
  return out;
}

PromiseKept promise_kept(const std::string& poses, const std::vector<double>& errors,
                         const std::vector<double>& us, double budget_us, double promised,
                         std::size_t decided) {
  PromiseKept out{.poses = poses,
                  .count = errors.size(),
                  .error_p95 = percentile(errors, 0.95),
                  .error_max = percentile(errors, 1),
                  .us_p95 = percentile(us, 0.95)};
  for (const double one : us)
    if (one > budget_us) ++out.slow;
  for (const double one : errors)
    if (one > promised) ++out.off;
  out.time = chance_of_breaking(out.slow, us.size()) >= kLuck;
  out.error = chance_beyond_p95(out.off, errors.size(), decided) >= kLuck;
  return out;
}

std::string promise_text(const PromiseKept& kept) {
  return fmt::format(
      "At {} poses {}: off by {:.3g} N at p95, {:.3g} at most, {:.0f} µs at p95. {} of them are off by more "
      "than "
      "the p95 above, {} take longer than the budget: {}.",
      kept.count, kept.poses, kept.error_p95, kept.error_max, kept.us_p95, kept.off, kept.slow,
      kept.error && kept.time ? "the promise is kept"
      : kept.error            ? "the budget is not kept, the error is"
      : kept.time             ? "the error is not kept, the budget is"
                              : "neither budget nor error is kept");
}

}  // namespace palpate
