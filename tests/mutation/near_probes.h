#pragma once
#include <cstdint>

namespace palpate::mutation {

/// What the host's exact predicates of the device's back end (compute/host_exact, HostHeights::add, HostFollow::pierces) say of the cases of
/// tests/compute/probe_cases.h and follow_cases.h, as a number that any other answer changes. tests/compute holds them against the definitions.
std::uint64_t near_probe();

}  // namespace palpate::mutation
