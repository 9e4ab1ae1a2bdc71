#pragma once
#include <memory>

#include "model/collision_backend.h"

namespace palpate {

/// The reference: plain, exact, independent of the GPU's algorithms.
std::unique_ptr<CollisionBackend> make_ref_backend();

}  // namespace palpate
