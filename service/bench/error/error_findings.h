#pragma once
#include <optional>
#include <string>
#include <vector>

#include "service/bench/error/error_charts.h"

namespace palpate {

/// How soon refined is as near as paper's best, of one subject by one engine: the median error of a quantity
/// against the median time of a frame, each method against its own truth.
struct MethodLead {
  double paper_error = 0,
         paper_us = 0;                  ///< of paper's best setting; the error relative to its truth's median
  std::optional<double> us{}, error{};  ///< of refined's soonest setting that is no worse; empty: none is
  double refined_least_us = 0;          ///< of refined's soonest setting at all
  double refined_best_error = 0;        ///< of refined's best at all
  double factor() const { return us ? paper_us / *us : 0; }
};

/// Empty where one of the two has no points.
std::optional<MethodLead> lead_of(const ErrorCurves& curves, const ErrorTruths& truths, std::size_t quantity);

/// Which method is nearer at which times, in words: "up to 0.7 ms refined alone answers; from there on …".
/// Empty where one of the two has no points.
std::string where_wins(const ErrorCurves& curves, const ErrorTruths& truths, std::size_t quantity);

/// A lead of one subject in a sentence, with the reason where it is less than tenfold.
std::string lead_sentence(const MethodLead& lead);

/// All subjects: on how many refined is ten times sooner, and what the others lack. `engines`: who answered,
/// "By one engine, gpu".
std::string lead_summary(const std::string& engines,
                         const std::vector<std::pair<std::string, MethodLead>>& leads);

}  // namespace palpate
