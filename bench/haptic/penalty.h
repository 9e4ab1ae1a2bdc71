#pragma once
#include <vector>

#include "bench/haptic/adapter.h"

namespace yardstick {

/// A spring in the world: pushes the tool at `point` along `normal` (unit) by stiffness · depth.
struct ContactSpring {
  Vec3 point, normal;
  double depth = 0;  ///< m
};

/// A method that says where bodies overlap, as springs of `spring_stiffness`, behind the spring that the hand
/// holds: the tool is where both balance, found by Newton's method with the springs' own stiffness Σ k J Jᵀ.
class PenaltyAdapter : public Adapter {
 public:
  static constexpr int kMostEvaluations = 30;

  void prepare(const Case& subject) final;
  Answer answer(const Pose& hand) final;

 protected:
  virtual void build(const Case& subject) = 0;
  /// Replaces the contents of `out`.
  virtual void find(const Pose& tool, std::vector<ContactSpring>& out) = 0;
  /// Of each of `count` springs, N/m. `hand`: K.
  virtual double spring_stiffness(double hand, std::size_t count) const = 0;

 private:
  double stiffness_ = 0, gyration_ = 0;
  std::vector<ContactSpring> springs_;
};

}  // namespace yardstick
