#include "bench/haptic/case.h"

#include <algorithm>

namespace yardstick {

std::vector<Pose> along(const std::vector<Pose>& corners, std::size_t count) {
  std::vector<Pose> out;
  for (std::size_t i = 0; i < count; ++i) {
    const double place =
        static_cast<double>(i) / static_cast<double>(count - 1) * static_cast<double>(corners.size() - 1);
    const std::size_t a = std::min(static_cast<std::size_t>(place), corners.size() - 2);
    const double part = place - static_cast<double>(a);
    out.push_back({glm::mix(corners[a].position, corners[a + 1].position, part),
                   glm::slerp(corners[a].rotation, corners[a + 1].rotation, part)});
  }
  return out;
}

void finish(Case& subject) {
  subject.tool = shifted(std::move(subject.tool), -centre_of_volume(subject.tool));
  subject.gyration = gyration_radius(subject.tool);
}

}  // namespace yardstick
