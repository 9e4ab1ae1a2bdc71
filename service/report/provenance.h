#pragma once
#include <string>
#include <utility>
#include <vector>

#include "model/scene/plan.h"
#include "model/scene/scene.h"

namespace palpate {

/// What the figures of a run belong to.
struct Provenance {
  std::string version, commit, machine, engine, command, time_utc;
  std::vector<std::pair<std::string, std::string>>
      inputs;  ///< what was read, "scene" first, and its SHA-256; of what is generated the parameters
  std::vector<std::string> kept, left_out;  ///< stages of the plan
};

/// Processor, threads, memory, kernel.
std::string machine_text();

/// "2026-03-01T12:00:00Z".
std::string utc_now();

/// This process's command as a shell takes it, the program by its name alone.
std::string typed_command();

/// `engine`: as outputs name it. Reads the scene's files once more, for their hashes; one that can't be read
/// any more has an empty one.
Provenance provenance_of(const Scene& scene, const PlanDecision& plan, const std::string& engine,
                         const std::string& command);

}  // namespace palpate
