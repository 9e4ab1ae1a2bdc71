#pragma once
#include "compute/gpu/frame/recorder.h"
#include "compute/gpu/prepare/prepared_scene.h"

namespace palpate {

/// Names what a frame reads of a prepared scene, which outlives `buffers`.
void name_scene(const PreparedScene& scene, FrameBuffers& buffers);

}  // namespace palpate
