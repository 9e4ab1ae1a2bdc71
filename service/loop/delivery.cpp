#include "service/loop/delivery.h"

#include <algorithm>

namespace palpate {
namespace {

/// splitmix64 (Steele, Lea, Flood 2014): a number for every (seed, query), the same everywhere.
std::uint64_t scrambled(std::uint64_t seed, std::uint64_t query) {
  std::uint64_t z = seed * 0x9E3779B97F4A7C15u + (query + 1) * 0xD1B54A32D192ED03u;
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
  return z ^ (z >> 31);
}

}  // namespace

int Delivery::duration(std::uint64_t query) const {
  switch (kind) {
    case Kind::kFixed:
    case Kind::kLost:
      return delay;
    case Kind::kRandom:
      return 1 + static_cast<int>(scrambled(seed, query) %
                                  static_cast<std::uint64_t>(std::max(2 * delay - 1, 1)));
    case Kind::kBursty:
      return query % 8 == 7 ? 4 * delay : delay;
  }
  return delay;
}

bool Delivery::lost(std::uint64_t query) const {
  return kind == Kind::kLost && scrambled(seed, query) % 4 == 0;
}

const LawResult* Courier::at(std::int64_t tick, const Pose& pose,
                             const std::function<void(LawResult&)>& contact) {
  const LawResult* fresh = asked_ && tick >= due_ ? deliver() : nullptr;
  if (!asked_) {
    pending_ = {};
    contact(pending_);
    pending_.tick = tick;
    pending_.gc = pose.position;
    pending_.rotation = pose.rotation;
    due_ = tick + delivery_.duration(query_);
    asked_ = true;
    if (due_ == tick) fresh = deliver();  // no delay at all
  }
  return fresh;
}

const LawResult* Courier::deliver() {
  asked_ = false;
  if (delivery_.lost(query_++)) return nullptr;
  arrived_ = pending_;
  return &arrived_;
}

}  // namespace palpate
