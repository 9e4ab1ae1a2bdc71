#pragma once
#include <cstdint>
#include <memory>

#include "driver/haptic_device.h"
#include "model/result.h"
#include "model/scene/scene.h"

namespace palpate {

/// A haptic device that isn't there: its mass and damping, held by a hand that follows a path as a mass, a
/// spring and a damper. Deterministic; read and write never allocate, look at no clock, and one write() is
/// one tick of 1 ms.
///
/// Free motion (no guide): the hand holds the tool at its centre of mass gc; gc moves as a point mass, the
/// tool turns about gc with a round inertia. Guided (the chapter's rig): the tool has a travel along the
/// guide and three rotations about its own origin, relative to the guide's frame; the actuators are one force
/// along the guide and three torques about the frame's axes. What moves the generalised coordinates is the
/// wrench's virtual work on them, so a torque does push along a guide whose frame turns with travel.
///
/// Integration: translation and travel are solved exactly for a wrench held over the tick and a path linear
/// in it; rotation likewise in the tangent space at the hand's rotation (left out: terms of the order of rate
/// × rate × tick, Coriolis coupling of travel and rotation). Stable at any stiffness of the hand. Its limits
/// shorten force and torque, keeping direction. `settings.path` empty: the hand rests at `start`.
Result<std::unique_ptr<HapticDevice>> make_simulated_device(const DeviceSettings& settings, const Pose& start,
                                                            const Vec3& tool_gc_m);

}  // namespace palpate
