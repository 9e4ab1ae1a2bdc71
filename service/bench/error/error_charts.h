#pragma once
#include <array>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "service/bench/error/error_sweep.h"
#include "service/bench/output.h"

namespace palpate {

/// A setting that was measured.
struct ErrorPoint {
  ErrorSetting setting;
  ErrorResult result;
};

/// What one engine answered of a subject.
struct ErrorCurves {
  std::string engine;
  std::vector<ErrorPoint> points;
};

/// What errors are held against.
struct ErrorTruths {
  std::string about;                  ///< a sentence: what the truth is
  std::optional<double> spacing_m{};  ///< of a converged run that stands in; empty: a closed form
  std::array<double, kErrorQuantities.size()>
      largest{};  ///< of the truth: an error of ten times as much has diverged
  /// Median of the truth over the poses, of `refined` and of `paper`, whose forces are two things: errors of
  /// F and T are shown as parts of it.
  std::array<std::array<double, kErrorQuantities.size()>, 2> typical{};
};

/// A percentile of a setting's error of F or T as a part of its method's truth; of the others as it is.
double relative_error(const ErrorPoint& point, const ErrorTruths& truths, std::size_t quantity,
                      double fraction);

/// error ~ knob^order by least squares over the logarithms; errors of 0 are left out.
struct FittedOrder {
  double order = 0, half_width = 0;  ///< of the interval that holds the order in 95 of 100 cases
  std::size_t points = 0;
};
std::optional<FittedOrder> fitted_order(const std::vector<std::pair<double, double>>& curve);

/// "1.52 ± 0.11 over 8 spacings".
std::string order_text(const FittedOrder& fit, const char* what);

/// The truth's own error, from the finest setting's error e at spacing h: a run at h_t converged with order p
/// is off by e r / (1 − r), r = (h_t / h)^p.
double own_error(double finest_error, double finest_spacing, double truth_spacing, double order);

/// Error of a quantity against the median time of a frame: a colour a method, a marker a knob, the line's
/// style a percentile, the knob's value at each point, 1 ms, the Pareto front of the medians.
Chart error_time_chart(const std::string& subject, const ErrorCurves& curves, const ErrorTruths& truths,
                       std::size_t quantity);

/// Error of a quantity against the sample spacing, with slopes of order one and two to compare with.
Chart convergence_chart(const std::string& subject, const ErrorCurves& curves, const ErrorTruths& truths,
                        std::size_t quantity);

/// Engines beside each other: the median error of F of `refined` over spacings, against the median time.
Chart engines_chart(const std::string& subject, const std::vector<ErrorCurves>& engines);

}  // namespace palpate
