#include "service/queries/lone_query.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>
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

/// a + share · b.
Vec6 plus(const Vec6& a, double share, const Vec6& b) {
  Vec6 out;
  for (std::size_t i = 0; i < 6; ++i) out[i] = a[i] + share * b[i];
  return out;
}

constexpr int kMostTries =
    10;  // places along one step (chosen: a stiff wall is found to a thousandth of the step)
constexpr double kLevel =
    0.1;  // of the slope where a step begins: lower it need not get (chosen; Wolfe's second condition)
constexpr int kMostIdle = 12;    // evaluations that lead no nearer (chosen: a search that gets on halves what
                                 // is left every two or three)
constexpr double kFound = 1e-3;  // of the way: what nobody feels (chosen) …
constexpr double kFoundM = 1e-7;  // … and m
constexpr double kNear = 1e-2;    // of the way: from here on planes lead on by themselves (chosen)

}  // namespace

double Anderson::product(const Vec6& a, const Vec6& b) const {
  double sum = 0;
  for (std::size_t i = 0; i < 6; ++i) sum += a[i] * b[i] * (i < 3 ? 1 : gyration_ * gyration_);
  return sum;
}

double Anderson::length(const Vec6& v) const { return std::sqrt(product(v, v)); }

Vec6 Anderson::next(const Vec6& z, const Vec6& image) {
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
    for (std::size_t j = 0; j < kept; ++j) a[i][j] = product(rest_steps_[i], rest_steps_[j]);
    b[i] = product(rest_steps_[i], rest);
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

LoneQuery::LoneQuery(const SceneGeometry& geometry, double stiffness)
    : geometry_(geometry),
      stiffness_(stiffness),
      spring_{stiffness, stiffness * geometry.tool_gyration_m * geometry.tool_gyration_m},
      anderson_(geometry.tool_gyration_m) {}

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
Vec6 LoneQuery::next(const Vec6& apart) const {
  return spring_balance(spring_, device_, apart, PlaneFeel(planes_));
}

Result<void> LoneQuery::feel(PoseQuery& backend, const Ignored* ignored, const Pose& pose,
                             ContactResponse& response, bool from_before) {
  if (const auto asked = ask(backend, ignored, pose, response, from_before); !asked) return asked.error();
  felt(response);
  return {};
}

Result<Felt> LoneQuery::ask(PoseQuery& backend, const Ignored* ignored, const Pose& pose,
                            const ContactResponse& at_pose, bool from_before) {
  begin(pose, at_pose, from_before);
  while (const std::optional<Pose> there = wanted()) {
    const auto lattice = to_lattice(*there, geometry_);
    if (!lattice) return lattice.error();
    if (auto answered = backend.query(*lattice, ignored, contacts_); !answered) return answered.error();
    respond(contacts_, *lattice, geometry_, Profile::kRefined, stiffness_, response_);
    take(response_);
  }
  return felt_;
}

void LoneQuery::felt(ContactResponse& response) const {
  response.felt = felt_;
  if (!response.contact_points) response.felt->wrench.torque = Vec3(0);
  if (!felt_.settled) response.flags |= kFlagUnsettled;
}

std::optional<Pose> LoneQuery::wanted() const {
  if (stage_ == Stage::kDone) return std::nullopt;
  return Pose{tool_.gc - tool_.rotation * geometry_.tool_gc_m, tool_.rotation};
}

void LoneQuery::want(const Vec6& apart, Stage stage) {
  there_ = apart;
  tool_ = apart_from(device_, apart, spring_);
  stage_ = stage;
}

void LoneQuery::begin(const Pose& pose, const ContactResponse& at_pose, bool from_before) {
  stage_ = Stage::kDone;
  felt_ = {};
  felt_.tool = pose;
  felt_.evaluations = 1;
  const std::optional<Vec6> before = std::exchange(before_, std::nullopt);
  if (!at_pose.contact || !spring_.on()) return;
  device_ = {0, pose.position + pose.rotation * geometry_.tool_gc_m, glm::normalize(pose.rotation)};
  // What the planes of the balance before say of this pose: the tool follows the hand along a wall, not in.
  std::optional<Vec6> first;
  if (from_before && before) first = next(*before);
  fill_planes(at_pose, planes_);
  planes_.gc = device_.gc;
  planes_.rotation = device_.rotation;

  // m, and of the way: 20 µN at 2 kN/m, or what one can see (chosen)
  enough_ = from_before ? 1e-7 : 1e-8;
  enough_share_ = from_before ? 1e-3 : 1e-6;
  anderson_ = Anderson(geometry_.tool_gyration_m);
  apart_ = {};
  rest_ = pull(at_pose.wrench, apart_);
  image_ = best_ = next(apart_);
  farthest_ = farthest(at_pose);
  left_ = least_ = halved_ = anderson_.length(plus(image_, -1, apart_));
  idle_ = 0;
  if (first)
    want(*first, Stage::kFromBefore);
  else
    begin_step();
}

/// Whether the best place is near enough for a hand. Where thousands of newtons push from all round and
/// cancel but for a few, one cannot get nearer: every sample is rounded to the lattice.
bool LoneQuery::found() const { return least_ <= kFoundM + kFound * anderson_.length(best_); }

bool LoneQuery::settled() const { return left_ <= enough_ + enough_share_ * anderson_.length(image_); }

/// How far a step may lead from where the field is as it says, m: as far as the deepest sample lies. What
/// pushes further on is another wall, of which planes know nothing, and behind it is another balance; but
/// what is thinner than samples lie apart is passed. Where nothing pushes the spring leads back: as far as it
/// likes.
double LoneQuery::farthest(const ContactResponse& at) const {
  if (at.planes.empty()) return std::numeric_limits<double>::infinity();
  return std::max(at.max_depth, geometry_.lattice.step_m * geometry_.sample_spacing);
}

void LoneQuery::begin_step() {
  if (settled() || felt_.evaluations >= kMostEvaluations || (idle_ >= kMostIdle && found())) {
    finish();
    return;
  }
  way_ = plus(image_, -1, apart_);
  step_ = plus(anderson_.next(apart_, image_), -1, apart_);
  if (!(anderson_.product(rest_, step_) > 0)) step_ = way_;
  if (const double goes = anderson_.length(step_); goes > farthest_)
    for (double& one : step_) one *= farthest_ / goes;
  // `rest_` is minus the slope of E + ½ spring. A step is taken that leads to half as much left or goes on
  // downhill; else the lowest place is looked for along it (regula falsi, Illinois): planes that are left too
  // far are forgotten, and a step may go right through a wall.
  low_slope_ = slope_here_ = anderson_.product(rest_, step_);
  low_ = high_ = high_slope_ = 0;
  share_ = 1;
  tried_ = 1;
  want(plus(apart_, share_, step_), Stage::kStep);
}

void LoneQuery::take(const ContactResponse& there) {
  fill_planes(there, planes_);
  planes_.gc = tool_.gc;
  planes_.rotation = tool_.rotation;
  ++felt_.evaluations;
  const Vec6 rest_there = pull(there.wrench, there_), image_there = next(there_);
  const double left_there = anderson_.length(plus(image_there, -1, there_));
  const auto go_there = [&] {
    apart_ = there_;
    rest_ = rest_there;
    image_ = image_there;
    left_ = left_there;
    farthest_ = farthest(there);
    begin_step();
  };
  const bool nearer = left_there < least_;
  if (nearer) {
    least_ = left_there;
    best_ = image_there;
  }
  ++idle_;
  if (least_ < 0.5 * halved_) {
    halved_ = least_;
    idle_ = 0;
  }
  if (stage_ == Stage::kFromBefore) {
    if (nearer)  // least_ was left_
      go_there();
    else
      begin_step();
    return;
  }
  const double slope = anderson_.product(rest_there, step_);
  if (left_there <= (tried_ == 1 ? 0.5 : 0.8) * left_ || (slope >= 0 && high_ == 0) ||
      std::fabs(slope) <= kLevel * slope_here_ || tried_ == kMostTries ||
      felt_.evaluations == kMostEvaluations) {
    go_there();
    return;
  }
  if (tried_ == 1 && left_ < kNear * anderson_.length(image_)) {
    // What planes alone say, for Anderson's method has been misled.
    anderson_.forget();
    step_ = way_;
    low_slope_ = slope_here_ = anderson_.product(rest_, step_);
  } else {
    if (slope < 0) {
      if (high_ != 0) low_slope_ *= 0.5;
      high_ = share_;
      high_slope_ = slope;
    } else {
      if (low_ != 0) high_slope_ *= 0.5;
      low_ = share_;
      low_slope_ = slope;
    }
    share_ = low_ + (high_ - low_) * std::clamp(low_slope_ / (low_slope_ - high_slope_), 0.05, 0.95);
  }
  ++tried_;
  want(plus(apart_, share_, step_), Stage::kStep);
}

void LoneQuery::finish() {
  stage_ = Stage::kDone;
  // A spring turned by more than half a turn would pull the other way round.
  const double turn = glm::length(Vec3(best_[3], best_[4], best_[5]));
  felt_.settled = (settled() || found()) && turn <= std::numbers::pi;
  before_ = best_;
  felt_.wrench.force = spring_.stiffness_n_per_m * Vec3(best_[0], best_[1], best_[2]);
  felt_.wrench.torque = spring_.stiffness_nm_per_rad * Vec3(best_[3], best_[4], best_[5]);
  const LawPose tool = apart_from(device_, best_, spring_);
  felt_.tool = {tool.gc - tool.rotation * geometry_.tool_gc_m, tool.rotation};
}

Result<void> LoneQueries::feel(PoseQuery& backend, std::span<const Pose> poses,
                               std::span<ContactResponse* const> responses) {
  while (under_way_.size() < poses.size()) under_way_.emplace_back(geometry_, stiffness_);
  contacts_.resize(std::max(contacts_.size(), poses.size()));
  for (std::size_t i = 0; i < poses.size(); ++i) under_way_[i].begin(poses[i], *responses[i]);
  std::vector<std::size_t> asking;
  std::vector<LatticePose> places;
  std::vector<Contacts*> answers;
  for (;;) {
    asking.clear();
    places.clear();
    answers.clear();
    for (std::size_t i = 0; i < poses.size(); ++i) {
      const std::optional<Pose> there = under_way_[i].wanted();
      if (!there) continue;
      const auto lattice = to_lattice(*there, geometry_);
      if (!lattice) return lattice.error();
      asking.push_back(i);
      places.push_back(*lattice);
      answers.push_back(&contacts_[i]);
    }
    if (asking.empty()) break;
    if (auto answered = backend.query_together(places, answers); !answered) return answered;
    for (std::size_t k = 0; k < asking.size(); ++k) {
      respond(*answers[k], places[k], geometry_, Profile::kRefined, stiffness_, response_);
      under_way_[asking[k]].take(response_);
    }
  }
  for (std::size_t i = 0; i < poses.size(); ++i) under_way_[i].felt(*responses[i]);
  return {};
}

}  // namespace palpate
