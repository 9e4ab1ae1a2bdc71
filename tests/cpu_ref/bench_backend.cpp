#include "tests/cpu_ref/bench_backend.h"

#include "cpu_ref/ref_backend.h"

namespace palpate {

std::unique_ptr<CollisionBackend> make_bench_backend() { return make_ref_backend(); }

}  // namespace palpate
