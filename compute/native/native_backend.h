#pragma once
#include <memory>

#include "model/collision_backend.h"

namespace palpate {

/// The native engine: the host's processor decides everything, exactly and on all cores, with a preparation of its own; no Vulkan. Answers the profile
/// `refined`; prepare() refuses `paper` (kBadValue).
std::unique_ptr<CollisionBackend> make_native_backend();

}  // namespace palpate
