#include "compute/frame.h"

namespace palpate {

Result<std::unique_ptr<Frame>> Frame::create(VulkanDevice&, const SceneGeometry&, const PreparedScene&, const Plan&) {
  return std::unique_ptr<Frame>();
}

}  // namespace palpate
