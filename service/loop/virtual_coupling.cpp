#include "service/loop/virtual_coupling.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "model/lattice/rotation.h"

namespace palpate {
namespace {

/// Shortens the three numbers from `first` on to `limit`, as a vector.
void shorten(Vec6& v, std::size_t first, double limit) {
  const double size = std::hypot(v[first], v[first + 1], v[first + 2]);
  if (size <= limit) return;
  for (std::size_t i = first; i < first + 3; ++i) v[i] *= limit / size;
}

/// The law at rest at this tick.
class LawFeel final : public Feel {
 public:
  explicit LawFeel(const ForceLawState& law) : law_(law) {}
  void operator()(const LawPose& tool, Wrench& push, StiffnessMatrix& slope) const override {
    law_.feel(tool.gc, tool.rotation, push, slope);
  }

 private:
  const ForceLawState& law_;
};

}  // namespace

Couplings couplings_of(const Scene& scene, double tool_gyration_m) {
  const ControlSettings& control = scene.control;
  const double stiffness = scene.response.stiffness_n_per_m;
  return {.field = {control.coupling_n_per_m.value_or(stiffness),
                    control.coupling_nm_per_rad.value_or(stiffness * tool_gyration_m * tool_gyration_m)},
          .areas = {control.coupling_n_per_m.value_or(0), control.coupling_nm_per_rad.value_or(0)}};
}

/// How large a motion is: √(2 · the springs' energy), √J.
double VirtualCoupling::size(const Vec6& v) const {
  double lengths = 0, turns = 0;
  for (std::size_t axis = 0; axis < 3; ++axis)
    lengths += v[axis] * v[axis], turns += v[axis + 3] * v[axis + 3];
  return std::sqrt(settings_.stiffness_n_per_m * lengths + settings_.stiffness_nm_per_rad * turns);
}

/// How far the tool may go in this tick from where it hung, as size() measures.
double VirtualCoupling::allowed(const LawPose& device) {
  const double slides = settings_.stiffness_n_per_m, turns = settings_.stiffness_nm_per_rad;
  double way = 0, ticks = 1;
  if (followed_) {
    const Vec3 moved = device.gc - last_.gc,
               turned = rotation_vector(device.rotation * glm::conjugate(last_.rotation));
    ticks = static_cast<double>(std::max<std::int64_t>(device.tick - last_.tick, 1));
    // A motion along which there is no spring is the tool's own: it moves contacts all the same.
    const double stiffest = std::max(slides, turns / (kLongestLever * kLongestLever));
    const double along = slides > 0 ? slides : stiffest,
                 round = turns > 0 ? turns : stiffest * kLongestLever * kLongestLever;
    way = std::sqrt(along * glm::dot(moved, moved) + round * glm::dot(turned, turned));
  }
  last_ = device;
  followed_ = true;
  const double rate = change_n_per_s_ * 1e-3 * ticks;  // N
  return 3 * way + (slides > 0 ? rate / std::sqrt(slides) : rate * kLongestLever / std::sqrt(turns));
}

Wrench VirtualCoupling::force(const Wrench& pushed) const {
  Wrench out = pushed;
  if (settings_.stiffness_n_per_m > 0)
    out.force = settings_.stiffness_n_per_m * Vec3(apart_[0], apart_[1], apart_[2]);
  if (settings_.stiffness_nm_per_rad > 0)
    out.torque = settings_.stiffness_nm_per_rad * Vec3(apart_[3], apart_[4], apart_[5]);
  return out;
}

LawPose VirtualCoupling::follow(const ForceLawState& law, const LawPose& device) {
  const double far = allowed(device);
  const Vec6 apart = spring_balance(settings_, device, apart_, LawFeel(law));
  Vec6 change{};
  for (std::size_t axis = 0; axis < 6; ++axis) change[axis] = apart[axis] - apart_[axis];
  if (const double goes = size(change); change_n_per_s_ > 0 && goes > far)
    for (double& one : change) one *= far / goes;
  shorten(change, 0, kFastest);
  shorten(change, 3, kFastestTurn);
  bool finite = true;
  for (std::size_t axis = 0; axis < 6; ++axis) {
    apart_[axis] += change[axis];
    finite = finite && std::isfinite(apart_[axis]);
  }
  if (!finite) reset();
  return apart_from(device, apart_, settings_);
}

}  // namespace palpate
