#include "tests/mutation/module_probes.h"

#include <algorithm>
#include <cstring>
#include <stdexcept>

#include "tests/compute/module_cases.h"

namespace palpate::mutation {

ModuleProbes::ModuleProbes(VulkanDevice& device) : device_(device) {
  for (auto& [module, runs] : module_runs())
    for (const ModuleRun& run : runs) runs_["shaders/" + module + ".comp"].push_back({run, {}});
}

Result<std::vector<Words>> ModuleProbes::ask(const ModuleRun& run, const std::string& code) {
  Words words(code.size() / 4);
  std::memcpy(words.data(), code.data(), code.size());
  return run_module(device_, {"a module", words.data(), code.size()}, run);
}

std::string ModuleProbes::difference(const std::string& name, const std::string& original,
                                     const std::string& mutant) {
  std::vector<Run>& runs = runs_.at(name);
  for (Run& run : runs) {
    if (!run.known.empty()) continue;
    auto known = ask(run.run, original);
    if (!known) throw std::runtime_error(name + ": " + known.error().sentence);
    run.known = std::move(*known);
  }
  std::string difference;
  for (std::size_t i = 0; i < runs.size() && difference.empty(); ++i) {
    const auto after = ask(runs[i].run, mutant);
    if (!after) {
      difference = after.error().sentence;
      break;
    }
    for (std::size_t b = 0; b < after->size(); ++b)
      if ((*after)[b] != runs[i].known[b])
        difference = "run " + std::to_string(i) + ", binding " + std::to_string(b);
  }
  // Nobody asks the same mutant again.
  std::erase_if(device_.pipelines, [&](const auto& made) {
    const auto& key = made.first;
    return key.size() >= mutant.size() / 4 &&
           std::memcmp(key.data() + (key.size() - mutant.size() / 4), mutant.data(), mutant.size()) == 0;
  });
  return difference;
}

}  // namespace palpate::mutation
