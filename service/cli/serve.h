#pragma once
#include <CLI/App.hpp>

#include "service/server/server.h"

namespace palpate {

/// Adds `serve` to the command line; `options` and `outcome` outlive the parsing.
void add_serve_command(CLI::App& app, ServeOptions& options, const Parts& parts, Result<void>& outcome);

}  // namespace palpate
