#pragma once
#include <memory>

#include "model/collision_backend.h"

namespace palpate {

/// Whom a BenchScene asks. Two definitions: the reference alone (tests/cpu_ref), and both back ends at once,
/// which fails a test wherever they differ (tests/equivalence).
std::unique_ptr<CollisionBackend> make_bench_backend();

}  // namespace palpate
