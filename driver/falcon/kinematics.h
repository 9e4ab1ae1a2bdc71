#pragma once
#include <array>
#include <cstdint>
#include <optional>

#include "model/lattice/vector.h"

/// Kinematics of the Novint Falcon, a delta robot of three legs. Base frame: origin in the middle of the
/// base, z out of the base towards the hand, y up; metres, radians, newtons. Leg i lies in the plane turned
/// by φ_i about z; its own frame has u away from the axis, v along the motor's shaft, w along z. Geometry:
/// the public constants of the device, with the names used there.
namespace palpate::falcon {

using Encoders = std::array<std::int16_t, 3>;  ///< counts since homing
using Angles = std::array<double, 3>;          ///< θ1 of each leg, rad, from u towards w

inline constexpr double kUpperArm = 0.060;         ///< a
inline constexpr double kForearm = 0.1025;         ///< b, the parallelogram's long side
inline constexpr double kGripOffset = 0.01443;     ///< c
inline constexpr double kForearmJoints = 0.01125;  ///< d = e, between the parallelogram and its two hinges
inline constexpr double kShaftOffset = -0.025;     ///< f
inline constexpr double kBaseRadius = 0.0400;      ///< r
inline constexpr double kBaseShift = -0.02309;     ///< s

/// The angle that counts stand for, rad: 35° + n · (0.01425 / 0.110) · 360° / 1280.
double angle_of_counts(double counts);
/// Its inverse, in counts and fractions of them.
double counts_of_angle(double angle);
Angles angles_of_encoders(const Encoders& encoders);

/// Whether the arms can stand so. Chosen, well beyond the workspace, which needs −56° to 113°: −70° to 135°.
/// Without it encoders that are off by a whole turn would go for others, for the equations below know no
/// turns.
bool possible(const Angles& angles);

/// Where the grip is for the angles, m; nothing where the legs don't meet or the search doesn't settle.
/// Newton's method from `guess` on the three leg equations, until the step is under 1e-15 m or rounding stops
/// it; a fixed number of steps at most, so it is fit for the 1 kHz loop. `guess`: the last position, or
/// kCentre.
std::optional<Vec3> position_of_angles(const Angles& angles, const Vec3& guess);

/// The angles that put the grip at `position`, by each leg's quadratic in tan(θ1/2), its elbow outwards;
/// nothing out of reach.
std::optional<Angles> angles_of_position(const Vec3& position);

/// Torque of each motor, N·m, that exerts `force` (N, base frame) at the grip: τ = Jᵀ F with J =
/// ∂position/∂θ1, by the principle of virtual work. Nothing at a singular position.
std::optional<std::array<double, 3>> torques_of_force(const Angles& angles, const Vec3& position,
                                                      const Vec3& force);

/// Where all encoders read 0, m, near enough for a first guess.
inline constexpr Vec3 kCentre{0.0, 0.0, 0.1346};

}  // namespace palpate::falcon
