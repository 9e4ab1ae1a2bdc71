#pragma once
#include <CLI/App.hpp>
#include <optional>
#include <string>

#include "service/cli/cli.h"

namespace palpate {

struct PathOptions {
  SceneOptions common;
  std::string path;  ///< CSV file of poses
  double tolerance_m = 0;
  std::optional<double> within_m;
  std::string out;         ///< directory for path.csv, path.json and path.html; empty: none
  bool overwrite = false;  ///< those files of another check that `out` has already
};

/// Adds `path` to the command line; `options` and `outcome` outlive the parsing.
void add_path_command(CLI::App& app, PathOptions& options, const Parts& parts, Result<void>& outcome);

}  // namespace palpate
