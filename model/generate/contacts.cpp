#include <cmath>

#include "model/generate/chapter_scenes.h"
#include "model/generate/motion.h"
#include "model/generate/pieces.h"

// World: the cylinder's axis is z, the clamp comes along +y. Seen from above (z towards the reader):
//
//            ( cylinder )
//     \  /               \  /        the blocks' edges point to −y, towards the clamp's bar;
//   left block   U    right block    the pads at the tips of the U meet the cylinder 45° off its front
//      =========bar=========
//                |
//              handle
//
// The cylinder reaches higher than the blocks and the blocks reach lower: high up the clamp meets the
// cylinder alone, low down the edges alone, between them all four at once. All lengths in metres, all chosen.
namespace palpate {
namespace {

constexpr double kCylinderRadius = 0.030, kCylinderTop = 0.200;
constexpr double kBlockBottom = -0.080, kBlockTop = 0.120;
constexpr double kEdgeX = 0.075;                     // of the blocks' edges
constexpr double kPadRadius = 0.008, kPadX = 0.027;  // pads at (±kPadX, 0) of the tool
constexpr double kBarFront = -0.060;                 // y of the bar's front face in the tool
constexpr double kArm = 0.030, kHalfWidth = 0.006, kHalfHeight = 0.015;  // of the bow

/// y of the tool when the pads touch the cylinder.
double touching_y() {
  const double apart = kCylinderRadius + kPadRadius;
  return -std::sqrt(apart * apart - kPadX * kPadX);
}

std::vector<pieces::Piece> mockup() {
  const Quat eighth = rotation_about({0, 0, 1}, kPi / 4);
  const double edge_y = touching_y() + kBarFront;  // pads and bar touch at the same moment
  return {
      pieces::cylinder("cylinder", 1, kCylinderRadius, kCylinderTop, 24, {}),
      pieces::block("right block", {0, 0, kBlockBottom}, {0.070, 0.035, kBlockTop}, 1,
                    {{kEdgeX, edge_y, 0}, eighth}),
      pieces::block("left block", {0, 0, kBlockBottom}, {0.035, 0.070, kBlockTop}, 1,
                    {{-kEdgeX, edge_y, 0}, eighth}),
  };
}

std::vector<pieces::Piece> clamp() {
  // The bow: from the tip of the right arm towards −y, round half a turn, back to the tip of the left arm.
  const auto spine = [](const pieces::GridPlace& p) {
    const double f = p.fraction();
    const Turn t = turn_by(-0.5 * f);
    Pose pose;
    double quarters = -1;  // heading: −y
    if (p.span == 0) pose.position = {kPadX, -kArm * f, 0};
    if (p.span == 1) {
      pose.position = {kPadX * t.cos, -kArm + kPadX * t.sin, 0};
      quarters = -1 - 2 * f;
    }
    if (p.span == 2) {
      pose.position = {-kPadX, -kArm * (1 - f), 0};
      quarters = -3;
    }
    pose.rotation = rotation_about({0, 0, 1}, quarters * kPi / 2);
    return pose;
  };
  const auto section = [](const pieces::GridPlace& p) {
    const double f = 2 * p.fraction() - 1;
    if (p.span == 0) return std::pair(kHalfWidth, kHalfHeight * f);
    if (p.span == 1) return std::pair(-kHalfWidth * f, kHalfHeight);
    if (p.span == 2) return std::pair(-kHalfWidth, -kHalfHeight * f);
    return std::pair(kHalfWidth * f, -kHalfHeight);
  };
  const Quat towards_minus_y = rotation_about({1, 0, 0}, kPi / 2);
  return {
      pieces::swept("bow", 1, {{0.030, 1}, {0.012, 1}, {0.030, 1}, {0.012, 1}}, section,
                    {{kArm, 1}, {kPi * kPadX, 12}, {kArm, 1}}, spine, kHalfWidth),
      pieces::cylinder("right pad", 0.4, kPadRadius, 0.032, 24, {{kPadX, 0, -0.016}, Quat(1, 0, 0, 0)}),
      pieces::cylinder("left pad", 0.4, kPadRadius, 0.032, 24, {{-kPadX, 0, -0.016}, Quat(1, 0, 0, 0)}),
      pieces::block("bar", {-0.095, -0.076, -0.012}, {0.095, kBarFront, 0.012}, 1),
      pieces::cylinder("handle", 1, 0.010, 0.090, 12, {{0, -0.070, 0}, towards_minus_y}),
  };
}

/// Comes on along y, presses, twists about all three axes while pressing (`yaw`: about z, `tilt`: about x and
/// y), and goes back. With a `skew` about z one side comes first.
void collide(Motion& motion, double height, double push, double yaw, double tilt, double skew, int stage) {
  const double away = touching_y() - 0.030, pressed = touching_y() + push;
  motion.go({0, away, height}, {0, 0, skew}, 0.8, stage);
  if (skew != 0) {
    motion.go({0, touching_y() - 0.003, height}, {0, 0, skew}, 0.7, stage);
    motion.rest(0.4, stage);
  }
  motion.go({0, pressed, height}, Vec3(0), 1.0, stage);
  motion.rest(0.3, stage);
  for (const Vec3& turn : {Vec3(0, 0, yaw), Vec3(tilt, 0, 0), Vec3(0, tilt, 0)}) {
    motion.turn_to(turn, 0.3, stage);
    motion.turn_to(-turn, 0.5, stage);
    motion.turn_to(Vec3(0), 0.3, stage);
  }
  motion.go({0, away, height}, Vec3(0), 0.6, stage);
}

}  // namespace

GeneratedScene generate_contacts(std::uint64_t triangles, std::uint64_t tool_triangles) {
  GeneratedScene scene;
  scene.mockup = pieces::tessellate(mockup(), triangles);
  scene.tool = pieces::tessellate(clamp(), tool_triangles);

  // The hand pulls with 135 N/m (the default), the contact pushes back with 2000 N/m an area: 20 mm of intent
  // give 1–3 mm of depth.
  Motion motion({0, touching_y() - 0.040, 0.160}, Vec3(0), 1);
  motion.rest(0.4, 1);
  collide(motion, 0.160, 0.020, 0.06, 0.25, 0, 1);
  collide(motion, -0.040, 0.020, 0.04, 0.20, 0.15, 2);
  collide(motion, 0.060, 0.030, 0.03, 0.12, 0, 3);
  motion.rest(0.4, 3);
  scene.path = motion.take();
  scene.stage_names = {"two areas on the cylinder", "the corners of the blocks, one and then both",
                       "four areas at once"};
  scene.actuated = {true, true, true, true, true, true};
  return scene;
}

}  // namespace palpate
