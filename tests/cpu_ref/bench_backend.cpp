#include "tests/cpu_ref/bench_backend.h"

#include "cpu_ref/cpu_backend.h"

namespace palpate {

std::unique_ptr<CollisionBackend> make_bench_backend() { return make_cpu_backend(); }

}  // namespace palpate
