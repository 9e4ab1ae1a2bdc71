#pragma once
#include <cstddef>
#include <string>
#include <vector>

namespace palpate {

/// Whether a chosen setting is at other poses what it promised: 95 of 100 frames within the budget, and 95 of
/// 100 errors within the p95 of those that it was chosen by.
struct PromiseKept {
  std::string poses;                         ///< which: "of a hand in virtual time"
  std::size_t count = 0, slow = 0, off = 0;  ///< poses; over the budget; off by more than the promised p95
  double error_p95 = 0, error_max = 0, us_p95 = 0;
  bool time = true, error = true;  ///< false where luck alone would look so bad in fewer than one case of 20
};

/// `promised`: the p95 of `decided` errors.
PromiseKept promise_kept(const std::string& poses, const std::vector<double>& errors,
                         const std::vector<double>& us, double budget_us, double promised,
                         std::size_t decided);

/// In a sentence or two.
std::string promise_text(const PromiseKept& kept);

/// How likely `over` or more of n break a bound that 95 of 100 keep.
double chance_of_breaking(std::size_t over, std::size_t n);

/// How likely `over` or more of n lie beyond the p95 (nearest rank) of m others, all from one distribution,
/// whichever it is.
double chance_beyond_p95(std::size_t over, std::size_t n, std::size_t m);

}  // namespace palpate
