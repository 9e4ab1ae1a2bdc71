#pragma once
#include <vector>

#include "service/bench/output.h"
#include "service/cli/console.h"

namespace palpate {

/// What stands apart from methods and knobs of `bench error`: rows, charts and facts are added to its own.
struct ErrorApart {
  BenchTable& table;
  std::vector<Chart>& charts;
  BenchFacts& facts;

  /// What a ball's triangles cost by themselves: no method can be nearer to the round ball than its mesh is.
  void tessellation();

  /// What a hand feels against what it should, for results of all ages, by the shipped laws in virtual time.
  void control();

  /// The mock-up grows by a small box ever further away, so that the lattice's step grows; beside it single
  /// and double precision, whose numbers lie as far apart as the contact is far from the origin.
  Result<void> lattice_step(CollisionBackend& backend, bool cpu_clock, Console& console);

 private:
  void rows(const std::string& scene, const std::string& method, const std::string& knob, double value,
            const char* quantity, const std::vector<double>& errors, double us_p50, double us_p99);
};

}  // namespace palpate
