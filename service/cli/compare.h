#pragma once
#include <string>

#include "model/result.h"

namespace CLI {
class App;
}

namespace palpate {

struct CompareOptions {
  std::string first, second;  ///< folders of runs
  bool json = false;
  std::string out;         ///< empty: none
  bool overwrite = false;  ///< the files of another comparison that `out` has already
};

/// Adds `compare`; all arguments outlive the parsing.
void add_compare_command(CLI::App& app, CompareOptions& options, Result<void>& outcome);

}  // namespace palpate
