#pragma once
#include <vector>

#include "compute/gpu/frame/recorder.h"
#include "model/collision_backend.h"

namespace palpate {

/// Bytes of a frame's buffers, its own and the scene's, by the first stage of `palpate plan` that uses them.
/// `zones`: they are joined, too.
std::vector<StageMemory> stage_memory(const FrameBuffers& buffers, bool zones);

}  // namespace palpate
