#include "service/queries/lone_query.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "service/loop/law_result.h"

namespace palpate {
namespace {

/// Fixed planes.
class PlaneFeel final : public Feel {
 public:
  explicit PlaneFeel(const PlaneSet& planes) : planes_(planes) {}
  void operator()(const LawPose& tool, Wrench& push, StiffnessMatrix& slope) const override {
    push = {};
    slope = {};
    add_pushed(push, slope, planes_, 1, tool.gc, tool.rotation);
    for (std::size_t row = 0; row < 6; ++row)
      for (std::size_t column = 0; column < row; ++column) slope[column][row] = slope[row][column];
  }

 private:
  const PlaneSet& planes_;
};

/// Turns count by their way at the tool's radius of gyration, so that a length is a length.
struct Metric {
  double gyration;
  double product(const Vec6& a, const Vec6& b) const {
    double sum = 0;
    for (std::size_t i = 0; i < 6; ++i) sum += a[i] * b[i] * (i < 3 ? 1 : gyration * gyration);
    return sum;
  }
  double length(const Vec6& v) const { return std::sqrt(product(v, v)); }
};

/// a + share · b.
Vec6 plus(const Vec6& a, double share, const Vec6& b) {
  Vec6 out;
  for (std::size_t i = 0; i < 6; ++i) out[i] = a[i] + share * b[i];
  return out;
}

/// Anderson's method on z = T(z): the next z from the last few z and T(z).
class Anderson {
 public:
  explicit Anderson(const Metric& metric) : metric_(metric) {}

  Vec6 next(const Vec6& z, const Vec6& image) {
    const Vec6 rest = plus(image, -1, z);
    if (count_ > 0) {
      const std::size_t place = (count_ - 1) % kMemory;
      rest_steps_[place] = plus(rest, -1, last_rest_);
      image_steps_[place] = plus(image, -1, last_image_);
    }
    last_rest_ = rest;
    last_image_ = image;
    const std::size_t kept = std::min(count_++, kMemory);
    // Least squares |rest − Σ γ rest_steps|², by normal equations with a little of the identity.
    double a[kMemory][kMemory] = {}, b[kMemory] = {};
    for (std::size_t i = 0; i < kept; ++i) {
      for (std::size_t j = 0; j < kept; ++j) a[i][j] = metric_.product(rest_steps_[i], rest_steps_[j]);
      b[i] = metric_.product(rest_steps_[i], rest);
    }
    double trace = 0;
    for (std::size_t i = 0; i < kept; ++i) trace += a[i][i];
    if (!(trace > 0)) return image;
    for (std::size_t i = 0; i < kept; ++i) a[i][i] += 1e-10 * trace;
    for (std::size_t i = 0; i < kept; ++i)  // symmetric and positive: no pivots
      for (std::size_t j = i + 1; j < kept; ++j) {
        const double share = a[j][i] / a[i][i];
        for (std::size_t k = i; k < kept; ++k) a[j][k] -= share * a[i][k];
        b[j] -= share * b[i];
      }
    Vec6 out = image;
    for (std::size_t i = kept; i-- > 0;) {
      for (std::size_t k = i + 1; k < kept; ++k) b[i] -= a[i][k] * b[k];
      b[i] /= a[i][i];
      for (std::size_t k = 0; k < 6; ++k) out[k] -= b[i] * image_steps_[i][k];
    }
    return out;
  }
  void forget() { count_ = 0; }

 private:
  static constexpr std::size_t kMemory = 5;
  Metric metric_;
  std::size_t count_ = 0;
  std::array<Vec6, kMemory> rest_steps_{}, image_steps_{};
  Vec6 last_rest_{}, last_image_{};
};

}  // namespace

LoneQuery::LoneQuery(const SceneGeometry& geometry, double stiffness)
    : geometry_(geometry),
      stiffness_(stiffness),
      spring_{stiffness, stiffness * geometry.tool_gyration_m * geometry.tool_gyration_m} {}

Result<void> LoneQuery::evaluate(PoseQuery& backend, const Ignored* ignored, const LawPose& tool) {
  const Pose pose{tool.gc - tool.rotation * geometry_.tool_gc_m, tool.rotation};
  const auto lattice = to_lattice(pose, geometry_);
  if (!lattice) return lattice.error();
  if (auto answered = backend.query(*lattice, ignored, contacts_); !answered) return answered;
  respond(contacts_, *lattice, geometry_, Profile::kRefined, stiffness_, response_);
  fill_planes(response_, planes_);
  planes_.gc = tool.gc;
  planes_.rotation = tool.rotation;
  return {};
}

/// What is out of balance, as a way that the spring would give.
Vec6 LoneQuery::pull(const Wrench& push, const Vec6& apart) const {
  Vec6 out;
  for (int k = 0; k < 3; ++k) {
    const auto i = static_cast<std::size_t>(k);
    out[i] = push.force[k] / spring_.stiffness_n_per_m - apart[i];
    out[i + 3] = push.torque[k] / spring_.stiffness_nm_per_rad - apart[i + 3];
  }
  return out;
}

/// T: where the tool would be if the field were its planes at `apart`.
Vec6 LoneQuery::next(const LawPose& device, const Vec6& apart) const {
  return spring_balance(spring_, device, apart, PlaneFeel(planes_));
}

Result<void> LoneQuery::feel(PoseQuery& backend, const Ignored* ignored, const Pose& pose,
                             ContactResponse& response, bool from_before) {
  Result<Felt> felt = ask(backend, ignored, pose, response, from_before);
  if (!felt) return felt.error();
  if (!response.contact_points) felt->wrench.torque = Vec3(0);
  if (!felt->settled) response.flags |= kFlagUnsettled;
  response.felt = *felt;
  return {};
}

Result<Felt> LoneQuery::ask(PoseQuery& backend, const Ignored* ignored, const Pose& pose,
                            const ContactResponse& at_pose, bool from_before) {
  Felt out;
  out.tool = pose;
  out.evaluations = 1;
  const std::optional<Vec6> before = std::exchange(before_, std::nullopt);
  if (!at_pose.contact || !spring_.on()) return out;
  const LawPose device{0, pose.position + pose.rotation * geometry_.tool_gc_m, glm::normalize(pose.rotation)};
  // What the planes of the balance before say of this pose: the tool follows the hand along a wall, not in.
  std::optional<Vec6> begin;
  if (from_before && before) begin = spring_balance(spring_, device, *before, PlaneFeel(planes_));
  fill_planes(at_pose, planes_);
  planes_.gc = device.gc;
  planes_.rotation = device.rotation;

  const Metric metric{geometry_.tool_gyration_m};
  // m, and of the way: 20 µN at 2 kN/m, or what one can see (chosen)
  const double enough = from_before ? 1e-7 : 1e-8, enough_share = from_before ? 1e-3 : 1e-6;
  constexpr int kMostTries =
      10;  // places along one step (chosen: a stiff wall is found to a thousandth of the step)
  constexpr double kLevel =
      0.1;  // of the slope where a step begins: lower it need not get (chosen; Wolfe's second condition)
  constexpr double kNear = 1e-2;  // of the way: from here on planes lead on by themselves (chosen)
  Anderson anderson(metric);
  Vec6 apart{}, rest = pull(at_pose.wrench, apart), image = next(device, apart), best = image;
  double left = metric.length(plus(image, -1, apart)), least = left;
  if (begin) {
    if (auto done = evaluate(backend, ignored, apart_from(device, *begin, spring_)); !done)
      return done.error();
    ++out.evaluations;
    const Vec6 there = next(device, *begin);
    const double left_there = metric.length(plus(there, -1, *begin));
    if (left_there < left) {
      apart = *begin;
      rest = pull(response_.wrench, apart);
      image = best = there;
      left = least = left_there;
    }
  }
  const auto settled = [&] { return left <= enough + enough_share * metric.length(image); };
  while (!settled() && out.evaluations < kMostEvaluations) {
    const Vec6 way = plus(image, -1, apart);
    Vec6 step = plus(anderson.next(apart, image), -1, apart);
    if (!(metric.product(rest, step) > 0)) step = way;
    // `rest` is minus the slope of E + ½ spring. A step is taken that leads to half as much left or goes on
    // downhill; else the lowest place is looked for along it (regula falsi, Illinois): planes that are left
    // too far are forgotten, and a step may go right through a wall.
    double slope_here = metric.product(rest, step), low = 0, low_slope = slope_here, high = 0, high_slope = 0,
           share = 1;
    for (int tried = 1; out.evaluations < kMostEvaluations; ++tried) {
      const Vec6 there = plus(apart, share, step);
      if (auto done = evaluate(backend, ignored, apart_from(device, there, spring_)); !done)
        return done.error();
      ++out.evaluations;
      const Vec6 rest_there = pull(response_.wrench, there), image_there = next(device, there);
      const double left_there = metric.length(plus(image_there, -1, there)),
                   slope = metric.product(rest_there, step);
      if (left_there < least) {
        least = left_there;
        best = image_there;
      }
      if (left_there <= (tried == 1 ? 0.5 : 0.8) * left || (slope >= 0 && high == 0) ||
          std::fabs(slope) <= kLevel * slope_here || tried == kMostTries ||
          out.evaluations == kMostEvaluations) {
        apart = there;
        rest = rest_there;
        image = image_there;
        left = left_there;
        break;
      }
      if (tried == 1 &&
          left <
              kNear * metric.length(image)) {  // what planes alone say, for Anderson's method has been misled
        anderson.forget();
        step = way;
        low_slope = slope_here = metric.product(rest, step);
        continue;
      }
      if (slope < 0) {
        if (high != 0) low_slope *= 0.5;
        high = share;
        high_slope = slope;
      } else {
        if (low != 0) high_slope *= 0.5;
        low = share;
        low_slope = slope;
      }
      share = low + (high - low) * std::clamp(low_slope / (low_slope - high_slope), 0.05, 0.95);
    }
  }
  out.settled = settled();
  before_ = best;
  out.wrench.force = spring_.stiffness_n_per_m * Vec3(best[0], best[1], best[2]);
  out.wrench.torque = spring_.stiffness_nm_per_rad * Vec3(best[3], best[4], best[5]);
  const LawPose tool = apart_from(device, best, spring_);
  out.tool = {tool.gc - tool.rotation * geometry_.tool_gc_m, tool.rotation};
  return out;
}

}  // namespace palpate
