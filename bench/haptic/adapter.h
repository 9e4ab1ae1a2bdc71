#pragma once
#include <memory>
#include <string>
#include <vector>

#include "bench/haptic/case.h"

namespace yardstick {

/// What the hand feels at a pose, and what finding it took.
struct Answer {
  Wrench wrench;
  std::uint32_t evaluations = 0;  ///< of the contact itself; more than one where a balance is sought
  bool settled = true;            ///< false: the balance was not found
};

/// A way to render contact. Each is asked pose by pose, remembers nothing of the pose before, and stands
/// behind the same spring: the tool hangs on the hand by K and Kρ². A method without a spring of its own
/// derives from PenaltyAdapter (penalty.h).
class Adapter {
 public:
  virtual ~Adapter() = default;
  virtual std::string name() const = 0;     ///< a column's head
  virtual std::string version() const = 0;  ///< and how it is set up
  /// Once for a case, which outlives the adapter. Throws std::runtime_error with a sentence.
  virtual void prepare(const Case& subject) = 0;
  virtual Answer answer(const Pose& hand) = 0;
};

struct AdapterMaker {
  std::string key;  ///< on the command line
  std::unique_ptr<Adapter> (*make)();
};

/// Those of this build (adapters.cpp).
std::vector<AdapterMaker> adapters();

}  // namespace yardstick
