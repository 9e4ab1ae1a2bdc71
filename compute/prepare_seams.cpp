#include "compute/prepare_seams.h"

#include <vector>

namespace palpate {

void find_seams(PrepareSteps& steps, const SceneGeometry& geometry, bool, BodyBuffers& body) {
  const std::vector<std::uint32_t> begin(geometry.mockup.triangles.size() + 1, 0);
  body.seam_begin = steps.filled("seams", begin);
  body.seams = steps.buffer("seams", 1);
}

}  // namespace palpate
