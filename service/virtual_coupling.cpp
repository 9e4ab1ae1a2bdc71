#include "service/virtual_coupling.h"

#include <cmath>
#include <cstddef>

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
  void operator()(const LawPose& tool, Wrench& push, StiffnessMatrix& slope) const override { law_.feel(tool.gc, tool.rotation, push, slope); }

 private:
  const ForceLawState& law_;
};

}  // namespace

LawPose VirtualCoupling::follow(const ForceLawState& law, const LawPose& device) {
  const Vec6 apart = spring_balance(settings_, device, apart_, LawFeel(law));
  Vec6 change{};
  for (std::size_t axis = 0; axis < 6; ++axis) change[axis] = apart[axis] - apart_[axis];
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
