// Contacts that are hard on arithmetic or on samples: shallow, small, thin, far from the origin.
#include "bench/haptic/case.h"
#include "bench/haptic/on_plane.h"
#include "bench/haptic/solids.h"

namespace yardstick {
namespace {

constexpr double kMm = 1e-3;

Case on_a_thin_plate(const Amount& amount) {
  Case out = on_plane("box on a plate of 1 mm", "stiff",
                      box(Vec3(-10, -10, -10) * kMm, Vec3(10, 10, 10) * kMm), 0.4 * kMm, amount);
  out.fixed = box(Vec3(-60, -60, -1) * kMm, Vec3(60, 60, 0) * kMm);
  return out;
}

Case far_away(const Amount& amount) {
  Case out = on_plane("ball in a plane, 1 km away", "stiff", sphere(20 * kMm, 96), 1 * kMm, amount);
  const Vec3 away(800, 600, 0);
  out.fixed = shifted(std::move(out.fixed), away);
  for (std::vector<Pose>* poses : {&out.path, &out.loop})
    for (Pose& pose : *poses) pose.position += away;
  out.rest.position += away;
  return out;
}

}  // namespace

std::vector<Case> stiff_cases(const Amount& amount) {
  return {on_plane("box, 20 µm deep", "stiff", box(Vec3(-40, -40, -10) * kMm, Vec3(40, 40, 10) * kMm),
                   0.02 * kMm, amount),
          on_plane("needle on a plane", "stiff", cylinder(0.5 * kMm, 50 * kMm, 24), 0.5 * kMm, amount),
          on_a_thin_plate(amount), far_away(amount)};
}

}  // namespace yardstick
