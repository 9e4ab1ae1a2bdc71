#pragma once
#include <memory>

#include "model/cache/disk_cache.h"
#include "model/collision_backend.h"

namespace palpate {

/// The native engine: the host's processor decides everything, exactly and on all cores, with a preparation
/// of its own; no Vulkan. Answers the profile `refined`; prepare() refuses `paper` (kBadValue). `cache`:
/// where prepared scenes are kept; may be null.
std::unique_ptr<CollisionBackend> make_native_backend(std::shared_ptr<DiskCache> cache = nullptr);

}  // namespace palpate
