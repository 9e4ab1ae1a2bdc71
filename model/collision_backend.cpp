#include "model/collision_backend.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace palpate {
namespace {

Error no_room(const Contacts& contacts) {
  return {ErrorCode::kInternal,
          std::string("a frame of a batch had too little room for ") + contacts.truncated_capacity};
}

}  // namespace

Result<void> CollisionBackend::query_batch(std::span<const LatticePose> poses, std::span<Contacts> out) {
  const std::size_t each = poses_together(poses.size());
  if (each <= 1)
    return share(poses.size(),
                 [&](PoseQuery& asked, std::size_t i) { return asked.query(poses[i], nullptr, out[i]); });
  return share((poses.size() + each - 1) / each, [&](PoseQuery& asked, std::size_t i) {
    const std::size_t first = i * each, count = std::min(each, poses.size() - first);
    std::vector<Contacts*> to(count);
    for (std::size_t k = 0; k < count; ++k) to[k] = &out[first + k];
    return asked.query_together(poses.subspan(first, count), to);
  });
}

Result<void> PoseQuery::touch_together(std::span<const LatticePose> poses, std::span<std::uint8_t> bits) {
  Contacts contacts;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (auto done = query(poses[i], nullptr, contacts); !done) return done;
    if (contacts.truncated) return no_room(contacts);
    bits[i] = contacts.contact ? 1 : 0;
  }
  return {};
}

Result<void> CollisionBackend::touches(std::span<const LatticePose> poses, std::span<std::uint8_t> bits) {
  constexpr std::size_t kAtOnce =
      64;  // contacts that are held (chosen: a large one's lists take half a megabyte)
  std::vector<Contacts> contacts(std::min(kAtOnce, poses.size()));
  for (std::size_t first = 0; first < poses.size(); first += kAtOnce) {
    const std::size_t count = std::min(kAtOnce, poses.size() - first);
    if (auto done = query_batch(poses.subspan(first, count), std::span(contacts).first(count)); !done)
      return done;
    for (std::size_t i = 0; i < count; ++i) {
      if (contacts[i].truncated) return no_room(contacts[i]);
      bits[first + i] = contacts[i].contact ? 1 : 0;
    }
  }
  return {};
}

// No point of the tool is faster than its origin and a turn about that at the tool's radius together.
Result<void> CollisionBackend::free_time(const LatticePose& pose, ScrewMotion& motion, double time,
                                         FreeTime& out) {
  const Twist twist = motion.screw.twist(time);
  const double longest = 1 - time;
  const double speed = std::sqrt(twist.velocity.x * twist.velocity.x + twist.velocity.y * twist.velocity.y +
                                 twist.velocity.z * twist.velocity.z) +
                       twist.angle * twist.radius;
  out = {.time = longest};
  const double reach = std::min(speed * longest + kMotionSlack + 1, 0x1p30);
  Clearance near;
  if (auto done = clearance(pose, static_cast<std::int32_t>(reach), near); !done) return done;
  if (near.kind == Clearance::Kind::kFurther) return {};
  const double free = std::max(near.steps - kMotionSlack, 0) / speed;
  if (free >= longest) return {};
  out = {.time = free,
         .blocked = true,
         .steps = near.steps,
         .static_id = near.static_id,
         .mobile_id = near.mobile_id};
  return {};
}

}  // namespace palpate
