#pragma once
#include <map>
#include <string>
#include <vector>

#include "compute/vulkan/device.h"
#include "tests/compute/module_run.h"

namespace palpate::mutation {

/// Preparation's modules by themselves, on made-up buffers (tests/compute/module_cases.h), asked of mutants.
/// tests/compute holds the same runs against the definitions.
class ModuleProbes {
 public:
  /// `device` outlives this.
  explicit ModuleProbes(VulkanDevice& device);

  /// Whether there is a run of this source file.
  bool has(const std::string& name) const { return runs_.contains(name); }

  /// What differs between the buffers that a module leaves and those of its mutant, SPIR-V; empty: nothing.
  /// Throws std::runtime_error where the unchanged module fails.
  std::string difference(const std::string& name, const std::string& original, const std::string& mutant);

 private:
  struct Run {
    ModuleRun run;
    std::vector<Words> known;  ///< empty: not asked yet
  };
  Result<std::vector<Words>> ask(const ModuleRun& run, const std::string& code);

  VulkanDevice& device_;
  std::map<std::string, std::vector<Run>> runs_;
};

}  // namespace palpate::mutation
