#include "tests/mutation/questions.h"

#include <cmath>

#include "model/lattice/rotation.h"
#include "model/lattice/screw.h"
#include "tests/equivalence/random.h"
#include "tests/equivalence/touching_poses.h"
#include "tests/mutation/must.h"

namespace palpate::mutation {
namespace {

constexpr std::size_t kMotions = 4;  // of a case
constexpr int kMostTries = 12;       // of starts, the further the more: a free one is wanted

/// The furthest of ever longer ways from a time on, `side` 1 or −1, before something stops being so.
template <class Holds>
double furthest(double from, double side, Holds&& holds) {
  double out = from;
  for (double way = 0x1p-40; way < 1; way *= 2) {
    const double time = from + side * way;
    if (time < 0 || time > 1 || !holds(time)) break;
    out = time;
  }
  return out;
}

}  // namespace

Questions::Questions(CollisionBackend& backend, const SceneGeometry& geometry,
                     const std::vector<LatticePose>& poses, const std::vector<std::uint8_t>& touch)
    : rule_(TouchRule::of(geometry, 0)), poses_(poses), touch_(touch) {
  equivalence::Random random(7);
  const auto some = [&] { return 2 * random.unit() - 1; };
  const double voxel = geometry.mockup_grid.size * geometry.lattice.step_m;
  for (const LatticePose& pose : poses) {
    if (motions_.size() == kMotions) break;
    if (pose.beyond_lattice) continue;
    const Pose to = equivalence::pose_of(pose, geometry);
    double reach = std::pow(10, 2 * random.unit() - 0.5);  // a third of a voxel to thirty
    for (int tries = 0; tries < kMostTries; ++tries, reach *= 1.5) {
      const Pose from = {
          to.position + reach * voxel * Vec3(some(), some(), some()),
          glm::normalize(rotation_by(random.unit() * Vec3(some(), some(), some())) * to.rotation)};
      const auto start = to_lattice(from, geometry);
      std::uint8_t starts_in = 1;
      if (start) must(backend.touches({&*start, 1}, {&starts_in, 1}));
      if (starts_in != 0) continue;
      motions_.push_back(motion_to(backend, geometry, from, to));
      break;
    }
  }
}

Questions::Motion Questions::motion_to(CollisionBackend& backend, const SceneGeometry& geometry,
                                       const Pose& from, const Pose& to) const {
  const FirstContact found = must(first_contact(backend, geometry, from, to, rule_));
  Motion out{from, to, found.kind, found.time, found.time};
  if (found.kind != FirstContact::Kind::kContact) return out;
  const Screw screw(from, to, geometry);
  out.latest = furthest(found.time, 1, [&](double time) {
    const LatticePose at = *to_lattice(screw.at(time), geometry);
    std::uint8_t bit = 0;
    must(backend.touches({&at, 1}, {&bit, 1}));
    return bit == 0;
  });
  out.soonest = furthest(found.time, -1, [&](double time) {
    Clearance near;
    must(backend.clearance(*to_lattice(screw.at(time), geometry), rule_.early, near));
    return near.kind != Clearance::Kind::kFurther;
  });
  return out;
}

std::string Questions::difference(CollisionBackend& backend, const SceneGeometry& geometry) const {
  std::vector<std::uint8_t> bits(poses_.size());
  if (auto r = backend.touches(poses_, bits); !r) return r.error().sentence;
  for (std::size_t i = 0; i < bits.size(); ++i)
    if (bits[i] != touch_[i]) return "touches at pose " + std::to_string(i);
  for (std::size_t i = 0; i < motions_.size(); ++i) {
    const Motion& motion = motions_[i];
    const auto found = first_contact(backend, geometry, motion.from, motion.to, rule_);
    if (!found) return found.error().sentence;
    const std::string name = "motion " + std::to_string(i);
    if (found->kind != motion.kind) return name + ": its end";
    if (found->time > motion.latest) return name + " is late";
    if (found->time < motion.soonest) return name + " is early";
  }
  return {};
}

}  // namespace palpate::mutation
