#pragma once
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "tests/compute/labyrinth_cases.h"
#include "tests/compute/lattice_cases.h"
#include "tests/compute/list_cases.h"

namespace palpate {

/// All made-up runs of preparation's modules, by module. The same every time: tests/compute holds them
/// against the definitions, tests/mutation asks mutants the same.
inline std::map<std::string, std::vector<ModuleRun>> module_runs() {
  std::map<std::string, std::vector<ModuleRun>> runs;
  for (auto&& of :
       {list_cases::scans(), list_cases::sorts(), list_cases::scatters(), labyrinth_cases::numbering(),
        labyrinth_cases::joins(), labyrinth_cases::votes(), labyrinth_cases::shells(),
        labyrinth_cases::doubts(), lattice_cases::expansions(), lattice_cases::half_crossings(),
        lattice_cases::crossings(), lattice_cases::voxels(), lattice_cases::samples()})
    for (const ModuleRun& run : of) runs[run.module].push_back(run);
  return runs;
}

}  // namespace palpate
