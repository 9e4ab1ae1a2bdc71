#include <cmath>

#include "model/generate/centreline.h"
#include "model/generate/chapter_scenes.h"
#include "model/generate/motion.h"
#include "model/generate/pieces.h"

// A pipe of 44 mm leaves a wall along x, bends left, up and away, and ends open to the clamp. Behind it: an
// engine's plates, casings, cylinders, bolts. All lengths in metres, all chosen. The clamp's frame is the
// guide's: x along the pipe, z where its ears are.
namespace palpate {
namespace {

using Outline = std::vector<std::pair<double, double>>;
using pieces::GridPlace;
using pieces::Piece;

constexpr double kPipeRadius = 0.022, kBendRadius = 0.140;
constexpr double kBore = 0.030, kBand = 0.0075,
                 kHalfWidth = 0.022;                         // clamp, unfastened: 8 mm of play on the pipe
constexpr double kGap = 22.0 / 360;                          // turns either side of z
constexpr double kPortal = 0.200, kPortalThickness = 0.012;  // the first obstacle's front, along the pipe
constexpr double kSlotHalf = 0.024, kEarTop = 0.066, kEarOutside = 0.015;

Centreline pipe_line() {
  Centreline line;
  line.straight(0.300);
  line.bend({0, 1, 0}, 50 * kPi / 180, kBendRadius);
  line.straight(0.140);
  line.bend({0, 0, 1}, 60 * kPi / 180, kBendRadius);
  line.straight(0.100);
  line.bend({0, -1, 0}, 45 * kPi / 180, kBendRadius);
  line.straight(0.140);
  return line;
}

Piece pipe(const Centreline& line) {
  std::vector<pieces::Span> spine;
  for (const Centreline::Part& part : line.parts()) spine.push_back({part.length, part.radius > 0 ? 6u : 1u});
  const auto circle = [](const GridPlace& p) {
    const Turn t = turn_by(p.fraction());
    return std::pair(kPipeRadius * t.cos, kPipeRadius * t.sin);
  };
  const auto frame = [line](const GridPlace& p) {
    const Centreline::Part& part = line.parts()[p.span];
    return line.frame(part.start + part.length * p.fraction());
  };
  return pieces::swept("pipe", 0.45, {{2 * kPi * kPipeRadius, 12}}, circle, spine, frame, kPipeRadius);
}

/// The first obstacle: a plate across the pipe with an opening for the clamp's band and a slot above it for
/// its ears.
Piece portal() {
  const Outline opening{{0.046, -0.046},     {0.046, 0.041},      {kSlotHalf, 0.041}, {kSlotHalf, 0.074},
                        {-kSlotHalf, 0.074}, {-kSlotHalf, 0.041}, {-0.046, 0.041},    {-0.046, -0.046}};
  const Outline outside{{0.085, -0.150}, {0.085, 0.020},  {0.085, 0.105},  {0.045, 0.105},
                        {-0.045, 0.105}, {-0.085, 0.105}, {-0.085, 0.020}, {-0.085, -0.150}};
  return pieces::framed_opening("portal", 1, opening, outside, false, kPortalThickness,
                                {{kPortal, 0, 0}, Quat(1, 0, 0, 0)});
}

std::vector<Piece> mockup(const Centreline& line) {
  const Quat none(1, 0, 0, 0);
  const Quat z_to_x = rotation_about({0, 1, 0}, kPi / 2);
  const Quat left_50 = rotation_about({0, 0, 1}, 50 * kPi / 180);
  std::vector<Piece> all{
      pipe(line),
      portal(),
      pieces::cylinder("flange", 0.8, 0.050, 0.012, 12, {{0, 0, 0}, z_to_x}),
      pieces::block("wall", {-0.012, -0.200, -0.150}, {0, 0.200, 0.150}, 0),
      pieces::block("base plate", {-0.050, -0.320, -0.162}, {1.000, 0.520, -0.150}, 0),
      pieces::block("casing", {0.080, -0.300, -0.150}, {0.460, -0.110, 0.060}, 3),
      pieces::block("gearbox", {0.740, 0.020, -0.150}, {0.960, 0.420, 0.080}, 3),
      pieces::block("heat shield", {-0.090, -0.002, -0.120}, {0.090, 0.002, 0.080}, 1,
                    {{0.545, 0.010, 0}, left_50}),
      pieces::block("cover", {0.070, -0.310, 0.060}, {0.470, -0.105, 0.064}, 0),
      pieces::block("post", {0.560, -0.300, -0.150}, {0.620, -0.240, 0.250}, 0),
      pieces::cylinder("engine cylinder 1", 2, 0.060, 0.260, 12, {{0.120, 0.300, -0.150}, none}),
      pieces::cylinder("engine cylinder 2", 2, 0.060, 0.260, 12, {{0.270, 0.300, -0.150}, none}),
      pieces::cylinder("engine cylinder 3", 2, 0.060, 0.260, 12, {{0.420, 0.380, -0.150}, none}),
      pieces::torus("hose", 1, 0.080, 0.012, {{0.850, 0.220, 0.092}, none}),
      pieces::cylinder("reservoir", 1.5, 0.050, 0.300, 12, {{0.500, -0.200, -0.090}, z_to_x}),
  };
  // Bolts: two rows along the casing's cover, one row along the base plate.
  for (int i = 0; i < 8; ++i) {
    const double x = 0.095 + 0.050 * i;
    for (const double y : {-0.295, -0.120})
      all.push_back(pieces::cylinder("bolt", 0.4, 0.006, 0.006, 6, {{x, y, 0.064}, none}));
    all.push_back(pieces::cylinder("bolt", 0.4, 0.008, 0.010, 6, {{x, 0.480, -0.150}, none}));
  }
  return all;
}

std::vector<Piece> clamp() {
  // The band goes round x from one side of the gap to the other, seen from +x counter-clockwise.
  const auto spine = [](const GridPlace& p) {
    const double from_z = kGap + (1 - 2 * kGap) * p.fraction();  // turns
    const Turn t = turn_by(0.25 + from_z);
    const double middle = kBore + kBand / 2;
    // Frame: x along the band (tangent), y inwards, z along the clamp's x.
    const Quat half_about_xz(0, 0.70710678118654752, 0, 0.70710678118654752);  // x to z, z to x, y to −y
    return Pose{{0, middle * t.cos, middle * t.sin},
                rotation_about({1, 0, 0}, 2 * kPi * (0.25 + from_z)) * half_about_xz};
  };
  const auto section = [](const GridPlace& p) {
    const double f = 2 * p.fraction() - 1;
    if (p.span == 0) return std::pair(kBand / 2, kHalfWidth * f);
    if (p.span == 1) return std::pair(-kBand / 2 * f, kHalfWidth);
    if (p.span == 2) return std::pair(-kBand / 2, -kHalfWidth * f);
    return std::pair(kBand / 2 * f, -kHalfWidth);
  };
  std::vector<Piece> all{pieces::swept("band", 1,
                                       {{2 * kHalfWidth, 1}, {kBand, 1}, {2 * kHalfWidth, 1}, {kBand, 1}},
                                       section, {{2 * kPi * kBore * (1 - 2 * kGap), 20}}, spine, kBand)};
  // Two ears with a hole each for the bolt that has been taken out.
  constexpr double kHole = 0.0075, kEarBottom = 0.031, kEarThickness = 0.005, kHalfEar = 0.018;
  constexpr double kCentre = (kEarBottom + kEarTop) / 2, kHalfHeight = (kEarTop - kEarBottom) / 2;
  constexpr double kDiagonal = kHole * 0.70710678118654752;
  const Outline hole{
      {kDiagonal, -kDiagonal}, {kDiagonal, kDiagonal}, {-kDiagonal, kDiagonal}, {-kDiagonal, -kDiagonal}};
  const Outline square{
      {kHalfEar, -kHalfHeight}, {kHalfEar, kHalfHeight}, {-kHalfEar, kHalfHeight}, {-kHalfEar, -kHalfHeight}};
  const Quat x_to_y = rotation_about({0, 0, 1}, kPi / 2);
  for (const double y : {-kEarOutside, kEarOutside - kEarThickness})
    all.push_back(pieces::framed_opening(y < 0 ? "right ear" : "left ear", 0.8, hole, square, true,
                                         kEarThickness, {{0, y, kCentre}, x_to_y}));
  return all;
}

std::vector<GuidePoint> guide(const Centreline& line) {
  std::vector<GuidePoint> points;
  const int count = static_cast<int>((line.length() + 0.160) / 0.004);
  for (int i = 0; i <= count; ++i) points.push_back({0.004 * i, line.frame(0.004 * i)});
  return points;
}

/// What the hand intends. It pulls with 135 N/m and turns with 2 N·m/rad (the defaults), so that it means to
/// go farther than it gets.
std::vector<PathPoint> path(const Centreline& line) {
  const double first_bend_end = 0.300 + 50 * kPi / 180 * kBendRadius;
  const double second_bend = first_bend_end + 0.140;
  const auto at = [](double travel) { return Vec3(travel, 0, 0); };

  Motion motion(at(0.090), Vec3(0), 1);
  motion.rest(0.6, 1);
  // 2: turned by 30°, the right ear meets the plate beside the slot.
  motion.turn_to({0.52, 0, 0}, 0.5, 2);
  motion.go(at(kPortal - 0.018 + 0.014), {0.52, 0, 0}, 1.2, 2);
  motion.rest(0.3, 2);
  motion.go(at(0.165), {0.52, 0, 0}, 0.4, 2);
  motion.turn_to(Vec3(0), 0.4, 2);
  // 3: between the walls of the slot, turned one way and the other.
  motion.go(at(kPortal + kPortalThickness / 2), Vec3(0), 0.4, 3);
  motion.turn_to({0.24, 0, 0}, 0.5, 3);
  motion.rest(0.2, 3);
  motion.turn_to({-0.24, 0, 0}, 0.7, 3);
  motion.rest(0.2, 3);
  motion.turn_to(Vec3(0), 0.4, 3);
  // 4: behind the first bend, tilted about z against the pipe.
  motion.go(at(first_bend_end + 0.070), Vec3(0), 1.0, 4);
  motion.turn_to({0, 0, 0.42}, 0.6, 4);
  motion.rest(0.2, 4);
  motion.turn_to(Vec3(0), 0.4, 4);
  // 5: in the middle of the second bend, turned about everything while it moves.
  motion.go(at(second_bend + 0.060), Vec3(0), 0.6, 5);
  motion.go(at(second_bend + 0.070), {0.15, 0.34, -0.20}, 0.6, 5);
  motion.go(at(second_bend + 0.080), {-0.15, -0.30, -0.25}, 0.8, 5);
  motion.rest(0.2, 5);
  motion.turn_to(Vec3(0), 0.4, 5);
  // 6: round the last bend and off.
  motion.go(at(line.length() + 0.100), Vec3(0), 1.4, 6);
  motion.rest(0.3, 6);
  return motion.take();
}

}  // namespace

GeneratedScene generate_disassembly(std::uint64_t triangles, std::uint64_t tool_triangles) {
  const Centreline line = pipe_line();
  GeneratedScene scene;
  scene.mockup = pieces::tessellate(mockup(line), triangles);
  scene.tool = pieces::tessellate(clamp(), tool_triangles);
  scene.guide = guide(line);
  scene.path = path(line);
  scene.stage_names = {"initial position",
                       "against the first obstacle",
                       "upper part of the obstacle, turning about x",
                       "against the pipe, turning about z",
                       "against the pipe, turning about all axes",
                       "final position"};
  scene.actuated = {true, false, false, true, true, true};
  return scene;
}

}  // namespace palpate
