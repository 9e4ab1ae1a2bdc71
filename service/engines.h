#pragma once
#include "service/cli/cli.h"

namespace palpate {

/// The back ends and the cache of prepared scenes: `Parts` without haptic devices, which only the program
/// has.
Parts engine_parts();

}  // namespace palpate
