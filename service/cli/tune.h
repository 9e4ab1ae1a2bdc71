#pragma once
#include <optional>
#include <string>

#include "service/bench/bench.h"

namespace CLI {
class App;
}

namespace palpate {

struct TuneOptions {
  BenchOptions bench;  ///< scene, poses, frames, rounds, back ends
  double budget_us = 0;
  bool json = false, apply = false;
  std::optional<std::string> clock{};  ///< "wall" or "cpu"; empty: the one that suits the engine
};

/// Adds `tune`; all arguments outlive the parsing.
void add_tune_command(CLI::App& app, TuneOptions& options, const Parts& parts, Result<void>& outcome);

}  // namespace palpate
