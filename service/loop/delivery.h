#pragma once
#include <cstdint>
#include <functional>

#include "service/loop/law_result.h"

namespace palpate {

/// When answers come, in ticks of virtual time. One query at a time: the next begins at the tick at which the
/// last one ends.
struct Delivery {
  enum class Kind : std::uint8_t {
    kFixed,   ///< every query takes `delay`; 0: answered in the same tick
    kRandom,  ///< 1 … 2·delay − 1, evenly
    kBursty,  ///< `delay`, but every eighth four times that
    kLost,    ///< `delay`, and one answer in four never comes
  };
  Kind kind = Kind::kFixed;
  int delay = 1;
  std::uint64_t seed = 1;

  int duration(std::uint64_t query) const;  ///< ticks that query number `query` takes
  bool lost(std::uint64_t query) const;
};

/// Asks, waits and brings, as a Delivery says: the collision worker of a loop in virtual time.
class Courier {
 public:
  explicit Courier(const Delivery& delivery) : delivery_(delivery) {}

  /// To be called at every tick. The result that arrives at this one, or null; it holds until the next call.
  /// When nothing is under way, `contact` fills a new one for the tool at `pose`, its centre of mass and
  /// rotation.
  const LawResult* at(std::int64_t tick, const Pose& pose, const std::function<void(LawResult&)>& contact);

 private:
  const LawResult* deliver();

  Delivery delivery_;
  LawResult pending_, arrived_;
  std::int64_t due_ = 0;     ///< tick at which the query under way ends
  std::uint64_t query_ = 0;  ///< its number
  bool asked_ = false;       ///< there is one
};

}  // namespace palpate
