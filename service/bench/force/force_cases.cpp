#include "service/bench/force/force_cases.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "model/generate/solids.h"
#include "model/lattice/rotation.h"

namespace palpate {
namespace {

constexpr double kPi = 3.14159265358979323846, kMm = 1e-3;
constexpr double kHole = 30 * kMm, kRadius = 10 * kMm;  // how deep the holes are; of the pegs

Pose at(const Vec3& position, const Vec3& turn = Vec3(0)) { return {position, rotation_by(turn)}; }

/// count + 1 poses from place(0) to place(1).
std::vector<Pose> along(std::size_t count, const std::function<Pose(double)>& place) {
  std::vector<Pose> out;
  for (std::size_t i = 0; i <= count; ++i)
    out.push_back(place(static_cast<double>(i) / static_cast<double>(count)));
  return out;
}

Mesh block(const Vec3& min, const Vec3& max) { return solids::box(min * kMm, max * kMm, Int3(1)); }

Mesh joined(const std::vector<Mesh>& parts) {
  Mesh out;
  for (std::size_t i = 0; i < parts.size(); ++i) solids::append(out, parts[i], fmt::format("part {}", i + 1));
  return out;
}

/// A round hole of `radius` through a ring, about z, its middle at 0.
Mesh bore(double radius, std::uint32_t sides) {
  return solids::moved(solids::ring(radius, 3 * kRadius, kHole, sides), at(Vec3(0, 0, -kHole / 2)));
}
Mesh peg(double radius, std::uint32_t sides, double length = 2 * kHole) {
  return solids::moved(solids::cylinder(radius, length, sides, 8), at(Vec3(0, 0, -length / 2)));
}

/// A prism along z over a closed outline that is star-shaped about its mean.
Mesh prism(const std::vector<Vec3>& outline, double height) {
  std::vector<solids::Loop> loops(2, outline);
  for (Vec3& p : loops[0]) p.z = -height / 2;
  for (Vec3& p : loops[1]) p.z = height / 2;
  return solids::loft(loops, solids::Ends::kPoints);
}

/// Involute spur gear: pressure angle 20°, module `m`, `teeth`, with flanks thinner by `play` each (m).
Mesh gear(double m, int teeth, double play, double height) {
  const double pressure = 20 * kPi / 180, pitch = m * teeth / 2, base = pitch * std::cos(pressure),
               tip = pitch + m, foot = pitch - 1.25 * m;
  const auto involute = [](double a) { return std::tan(a) - a; };
  const auto half = [&](double r) {
    return kPi / (2 * teeth) - play / pitch + involute(pressure) -
           involute(r > base ? std::acos(base / r) : 0);
  };
  std::vector<Vec3> outline;
  const auto add = [&](double r, double angle) {
    outline.emplace_back(r * std::cos(angle), r * std::sin(angle), 0);
  };
  for (int t = 0; t < teeth; ++t) {
    const double middle = 2 * kPi * t / teeth;
    constexpr int kFlank = 8;
    add(foot, middle - half(base));
    for (int i = 0; i <= kFlank; ++i)
      add(std::max(base, foot) + (tip - std::max(base, foot)) * i / kFlank,
          middle - half(std::max(base, foot) + (tip - std::max(base, foot)) * i / kFlank));
    for (int i = kFlank; i >= 0; --i)
      add(std::max(base, foot) + (tip - std::max(base, foot)) * i / kFlank,
          middle + half(std::max(base, foot) + (tip - std::max(base, foot)) * i / kFlank));
    add(foot, middle + half(base));
  }
  return prism(outline, height);
}

using Truth = ForceCase::Truth;

/// Tilted about y until both rims are 1 mm deep: the sides' forces cancel, and the couple rights the peg.
ForceCase peg_tilted(std::uint32_t sides, double play) {
  constexpr std::size_t kSteps = 200;
  const double most = (play + 1 * kMm) / (kHole / 2);
  ForceCase out{.name = {},
                .mockup = bore(kRadius + play, sides),
                .tool = peg(kRadius, sides),
                .path = along(kSteps, [&](double t) { return at(Vec3(0), Vec3(0, most * t, 0)); })};
  for (const double deep : {0.1 * kMm, 0.5 * kMm, 1 * kMm}) {
    const auto i =
        std::min(kSteps, static_cast<std::size_t>(std::ceil(kSteps * (play + deep) / (play + 1 * kMm))));
    out.truths.push_back({.at = i,
                          .direction = {},
                          .most_force = 0.05 * kForceStiffness * deep,
                          .couple_against = Vec3(0, 1, 0)});
  }
  return out;
}

ForceCase peg_off_centre(std::uint32_t sides, double play, double angle) {
  const Vec3 way(std::cos(angle), std::sin(angle), 0);
  constexpr std::size_t kSteps = 150;
  ForceCase out{
      .name = {},
      .mockup = bore(kRadius + play, sides),
      .tool = peg(kRadius, sides),
      .path = along(kSteps, [&](double t) { return at(way * (0.5 * play + t * (0.5 * play + 0.5 * kMm))); }),
      .approach = way};
  out.truths.push_back({.at = kSteps, .direction = -way, .most_force = {}, .couple_against = {}});
  return out;
}

/// Carried round the hole, pressed against its wall.
ForceCase peg_round(std::uint32_t sides, double play) {
  return {
      .name = {},
      .mockup = bore(kRadius + play, sides),
      .tool = peg(kRadius, sides),
      .path = along(240,
                    [&](double t) {
                      return at((play + 0.3 * kMm) * Vec3(std::cos(2 * kPi * t), std::sin(2 * kPi * t), 0));
                    }),
      .loop = true};
}

ForceCase press_fit(std::uint32_t sides) {
  ForceCase out{.name = {},
                .mockup = bore(kRadius, sides),
                .tool = peg(kRadius + 0.1 * kMm, sides),
                .path = along(100, [](double t) { return at(Vec3(0.2 * kMm * t, 0, 0)); })};
  out.truths.push_back(
      {.at = 0, .direction = {}, .most_force = 0.05 * kForceStiffness * 0.1 * kMm, .couple_against = {}});
  for (const std::size_t i : {25u, 50u, 100u})
    out.truths.push_back(
        {.at = i, .direction = Vec3(-1, 0, 0), .direction_deg = 10, .most_force = {}, .couple_against = {}});
  return out;
}

/// Four walls round a square of side 2·half.
Mesh frame(double half, double height) {
  const double h = height / 2, w = 20;
  return joined({block(Vec3(half, -half - w, -h), Vec3(half + w, half + w, h)),
                 block(Vec3(-half - w, -half - w, -h), Vec3(-half, half + w, h)),
                 block(Vec3(-half, half, -h), Vec3(half, half + w, h)),
                 block(Vec3(-half, -half - w, -h), Vec3(half, -half, h))});
}

ForceCase square_peg_yawed() {
  ForceCase out{.name = {},
                .mockup = frame(10.1, 30),
                .tool = block(Vec3(-10, -10, -30), Vec3(10, 10, 30)),
                .path = along(150, [](double t) { return at(Vec3(0), Vec3(0, 0, 0.06 * t)); })};
  for (const std::size_t i : {75u, 150u})
    out.truths.push_back({.at = i,
                          .direction = {},
                          .most_force = 0.05 * kForceStiffness * 0.5 * kMm,
                          .couple_against = Vec3(0, 0, 1)});
  return out;
}
ForceCase square_peg_into_the_corner() {
  const Vec3 way = Vec3(1, 1, 0) / std::sqrt(2.0);
  ForceCase out{.name = {},
                .mockup = frame(10.2, 30),
                .tool = block(Vec3(-10, -10, -30), Vec3(10, 10, 30)),
                .path = along(150, [&](double t) { return at(1 * kMm * t * way); }),
                .approach = way};
  out.truths.push_back({.at = 150, .direction = -way, .most_force = {}, .couple_against = {}});
  return out;
}
ForceCase key_yawed() {
  ForceCase out{.name = {},
                .mockup = joined({block(Vec3(-20, -30, -20), Vec3(20, 30, 0)),
                                  block(Vec3(4.05, -30, 0), Vec3(20, 30, 6)),
                                  block(Vec3(-20, -30, 0), Vec3(-4.05, 30, 6))}),
                .tool = block(Vec3(-4, -15, 0.02), Vec3(4, 15, 8)),
                .path = along(150, [](double t) { return at(Vec3(0), Vec3(0, 0, 0.04 * t)); })};
  out.truths.push_back({.at = 150,
                        .direction = {},
                        .most_force = 0.05 * kForceStiffness * 0.5 * kMm,
                        .couple_against = Vec3(0, 0, 1)});
  return out;
}
ForceCase tongue_between_walls() {
  ForceCase out{.name = {},
                .mockup = joined({block(Vec3(-30, 3.1, -10), Vec3(30, 13, 10)),
                                  block(Vec3(-30, -13, -10), Vec3(30, -3.1, 10))}),
                .tool = block(Vec3(-12, -3, -20), Vec3(12, 3, 20)),
                .path = along(200, [](double t) { return at(Vec3(0, (2 * t - 1) * 0.6 * kMm, 0)); })};
  out.truths = {{.at = 0, .direction = Vec3(0, 1, 0), .most_force = {}, .couple_against = {}},
                {.at = 100, .direction = {}, .most_force = 1e-9, .couple_against = {}},
                {.at = 200, .direction = Vec3(0, -1, 0), .most_force = {}, .couple_against = {}}};
  return out;
}
ForceCase ring_on_a_shaft() {
  ForceCase out{.name = {},
                .mockup = peg(kRadius, 48, 80 * kMm),
                .tool = solids::moved(solids::ring(kRadius + 0.2 * kMm, 1.6 * kRadius, 12 * kMm, 48),
                                      at(Vec3(0, 0, -6 * kMm))),
                .path = along(150, [](double t) { return at(Vec3(0.8 * kMm * t, 0, 0)); }),
                .approach = Vec3(1, 0, 0)};
  out.truths.push_back({.at = 150, .direction = Vec3(-1, 0, 0), .most_force = {}, .couple_against = {}});
  return out;
}
ForceCase shaft_in_two_bearings() {
  const Mesh bearing = solids::ring(6.05 * kMm, 14 * kMm, 8 * kMm, 48);
  ForceCase out{.name = {},
                .mockup = joined({solids::moved(bearing, at(Vec3(0, 0, -34 * kMm))),
                                  solids::moved(bearing, at(Vec3(0, 0, 26 * kMm)))}),
                .tool = peg(6 * kMm, 48, 100 * kMm),
                .path = along(200, [](double t) { return at(Vec3(0), Vec3(0, 0.03 * t, 0)); })};
  out.truths.push_back({.at = 200,
                        .direction = {},
                        .most_force = 0.05 * kForceStiffness * 0.9 * kMm,
                        .couple_against = Vec3(0, 1, 0)});
  return out;
}
ForceCase dovetail_lifted() {
  const auto outline = [](double low, double high) {
    return std::vector<Vec3>{Vec3(-low, -3, 0) * kMm, Vec3(low, -3, 0) * kMm, Vec3(high, 3, 0) * kMm,
                             Vec3(-high, 3, 0) * kMm};
  };
  const auto cheek = [](double s) {
    std::vector<Vec3> out{Vec3(s * 10.1, -3, 0) * kMm, Vec3(s * 20, -3, 0) * kMm, Vec3(s * 20, 3, 0) * kMm,
                          Vec3(s * 6.1, 3, 0) * kMm};
    if (s < 0) std::reverse(out.begin(), out.end());
    return prism(out, 40 * kMm);
  };
  ForceCase out{.name = {},
                .mockup = joined({cheek(1), cheek(-1)}),
                .tool = prism(outline(10, 6), 30 * kMm),
                .path = along(150, [](double t) { return at(Vec3(0, 0.8 * kMm * t, 0)); }),
                .approach = Vec3(0, 1, 0)};
  out.truths.push_back({.at = 150, .direction = Vec3(0, -1, 0), .most_force = {}, .couple_against = {}});
  return out;
}
/// Two gears of 20 and 12 teeth in mesh, the second turned against a flank: the line of action leans by 20°.
ForceCase gears() {
  const double m = 3 * kMm, distance = m * 16;
  ForceCase out{.name = {},
                .mockup = gear(m, 20, 0.1 * kMm, 20 * kMm),
                .tool = gear(m, 12, 0.1 * kMm, 16 * kMm),
                .path = along(150, [&](double t) {
                  return at(Vec3(distance, 0, 0), Vec3(0, 0, kPi + kPi / 12 + 0.05 * t));
                })};
  const double lean =
      20 * kPi / 180;  // turned to the left, the left gear's flanks push the right one's teeth down and away
  out.truths.push_back({.at = 150,
                        .direction = Vec3(std::sin(lean), std::cos(lean), 0),
                        .direction_deg = 3,
                        .most_force = {},
                        .couple_against = Vec3(0, 0, 1)});
  return out;
}
/// One leg on the table, the other beside its edge and not touching.
ForceCase bracket(double gap, double voxel) {
  ForceCase out{.name = {},
                .mockup = block(Vec3(-60, -40, -20), Vec3(0, 40, 0)),
                .tool = joined({block(Vec3(-30, -10, 0), Vec3(gap, 10, 4)),
                                block(Vec3(gap, -10, -15), Vec3(gap + 4, 10, 4))}),
                .voxel_m = voxel,
                .path = along(100, [](double t) { return at(Vec3(0, 0, (0.1 - 0.6 * t) * kMm)); }),
                .approach = Vec3(0, 0, -1)};
  for (const std::size_t i : {50u, 100u})
    out.truths.push_back(
        {.at = i, .direction = Vec3(0, 0, 1), .direction_deg = 5, .most_force = {}, .couple_against = {}});
  return out;
}
ForceCase sphere_over_an_edge() {
  return {.name = {},
          .mockup = block(Vec3(-60, -60, -60), Vec3(0, 60, 0)),
          .tool = solids::sphere_of(8 * kMm, 4000),
          .path = along(240,
                        [](double t) {
                          return at(Vec3(2 + 2 * std::cos(2 * kPi * t), 0.3, 5 + 2 * std::sin(2 * kPi * t)) *
                                    kMm);
                        }),
          .loop = true};
}
ForceCase sphere_into_a_corner() {
  const Vec3 way = -Vec3(1, 1, 1) / std::sqrt(3.0);
  ForceCase out{
      .name = {},
      .mockup = joined({block(Vec3(-20, -20, -20), Vec3(40, 40, 0)),
                        block(Vec3(-20, -20, 0), Vec3(0, 40, 40)), block(Vec3(0, -20, 0), Vec3(40, 0, 40))}),
      .tool = solids::sphere_of(8 * kMm, 6000),
      .path = along(150, [&](double t) { return at(Vec3(8.1, 8.1, 8.1) * kMm + 2 * kMm * t * way); }),
      .approach = way};
  out.truths.push_back({.at = 150, .direction = -way, .most_force = {}, .couple_against = {}});
  return out;
}
/// A plate slides from one pad on to `pads`, pressed by 0.3 mm.
ForceCase plate_over_pads(int pads) {
  std::vector<Mesh> all;
  all.reserve(static_cast<std::size_t>(pads));
  for (int i = 0; i < pads; ++i) all.push_back(block(Vec3(-50 + 25 * i, -8, -10), Vec3(-38 + 25 * i, 8, 0)));
  return {.name = {},
          .mockup = joined(all),
          .tool = block(Vec3(-30, -20, 0), Vec3(30, 20, 5)),
          .path = along(400,
                        [&](double t) { return at(Vec3(-75 + t * (25 * (pads - 1) + 60), 0, -0.3) * kMm); })};
}
ForceCase plate_on_waves() {
  std::vector<Mesh> all;
  all.reserve(6);
  for (int i = 0; i < 6; ++i)
    all.push_back(solids::moved(solids::cylinder(6 * kMm, 60 * kMm, 48, 6),
                                {Vec3(-45 + 15 * i, 30, -6) * kMm, rotation_by(Vec3(kPi / 2, 0, 0))}));
  return {.name = {},
          .mockup = joined(all),
          .tool = block(Vec3(-30, -20, 0), Vec3(30, 20, 5)),
          .path = along(300, [](double t) {
            return at(Vec3(-20 + 40 * t, 0, -0.3) * kMm, Vec3(0, 0.01 * std::sin(2 * kPi * t), 0));
          })};
}
ForceCase box_off_a_table() {
  return {.name = {},
          .mockup = block(Vec3(-60, -40, -20), Vec3(0, 40, 0)),
          .tool = block(Vec3(-10, -10, -10), Vec3(10, 10, 10)),
          .path = along(240,
                        [](double t) {
                          return at(
                              Vec3(8 + 4 * std::cos(2 * kPi * t), 0, 10 + 0.5 * std::sin(2 * kPi * t)) * kMm,
                              Vec3(0.02, 0.04, 0));
                        }),
          .loop = true};
}
/// Through a plate and back, the same way.
ForceCase plate_pierced(double thick) {
  return {.name = {},
          .mockup = block(Vec3(-40, -40, -thick), Vec3(40, 40, 0)),
          .tool = solids::sphere_of(6 * kMm, 3000),
          .voxel_m = 2 * kMm,
          .path = along(400,
                        [&](double t) {
                          const double way = t < 0.5 ? 2 * t : 2 - 2 * t;
                          return at(Vec3(0.3, 0.2, 6.2 - way * (thick + 12.6)) * kMm);
                        }),
          .loop = true,
          .slips = true};
}
ForceCase pressed_down(Mesh mockup, Mesh tool, double from, double by, double voxel = 0,
                       const Vec3& side = Vec3(0)) {
  ForceCase out{.name = {},
                .mockup = std::move(mockup),
                .tool = std::move(tool),
                .voxel_m = voxel,
                .path = along(150, [&](double t) { return at((side + Vec3(0, 0, from - by * t)) * kMm); }),
                .approach = Vec3(0, 0, -1)};
  out.truths.push_back(
      {.at = 150, .direction = Vec3(0, 0, 1), .direction_deg = 3, .most_force = {}, .couple_against = {}});
  return out;
}
ForceCase cone_over_an_edge() {
  return {.name = {},
          .mockup = block(Vec3(-60, -60, -60), Vec3(0, 60, 0)),
          .tool = solids::cone(15 * kMm, 30 * kMm, 96),
          .path = along(240,
                        [](double t) {
                          return at(Vec3(2 * std::cos(2 * kPi * t), 0.3, std::sin(2 * kPi * t) - 0.5) * kMm);
                        }),
          .loop = true};
}
Mesh sheet(double half) {
  Mesh out;
  out.vertices = {Vec3(-half, -half, 0) * kMm, Vec3(half, -half, 0) * kMm, Vec3(half, half, 0) * kMm,
                  Vec3(-half, half, 0) * kMm};
  out.triangles = {{0, 1, 2}, {0, 2, 3}};
  out.parts = {{"sheet", 0, 2}};
  return out;
}
ForceCase on_a_sheet(double side) {
  ForceCase out{.name = {},
                .mockup = sheet(40),
                .tool = solids::sphere_of(10 * kMm, 4000),
                .voxel_m = 2 * kMm,
                .path = along(100, [&](double t) { return at(Vec3(1, 2, side * (10.1 - 1.5 * t)) * kMm); }),
                .approach = Vec3(0, 0, -side)};
  out.truths.push_back({.at = 100, .direction = Vec3(0, 0, side), .most_force = {}, .couple_against = {}});
  return out;
}
/// A box that lacks its side at `z`, mm.
Mesh open_box(const Vec3& min, const Vec3& max, double z) {
  Mesh open = block(min, max);
  decltype(open.triangles) kept;
  const auto is_there = [&](std::uint32_t v) { return std::abs(open.vertices[v].z - z * kMm) < 0.5 * kMm; };
  for (const auto& t : open.triangles)
    if (!(is_there(t[0]) && is_there(t[1]) && is_there(t[2]))) kept.push_back(t);
  open.triangles = kept;
  open.parts = {{"open", 0, static_cast<std::uint32_t>(kept.size())}};
  return open;
}
/// A box without its bottom, pressed on its lid from outside. It has no inside, so its own samples alone
/// push, some 70 here, and their sum's slope is as good as they are dense: 2.5 % of it is no gradient.
ForceCase on_an_open_box() {
  ForceCase out = pressed_down(open_box(Vec3(-30, -30, 0), Vec3(30, 30, 40), 0),
                               solids::sphere_of(8 * kMm, 4000), 48.1, 1.5, 2 * kMm, Vec3(3, 2, 0));
  out.most_antisymmetry = 0.03;
  return out;
}
/// A block in a box without its lid, against a wall from within: which of the two is the tool tells the sign.
ForceCase in_an_open_box(bool box_is_tool) {
  const Mesh around = open_box(Vec3(-20.2, -20.2, -20.2), Vec3(20.2, 20.2, 40), 40),
             within = block(Vec3(-20, -20, -20), Vec3(20, 20, 20));
  ForceCase out{.name = {},
                .mockup = box_is_tool ? within : around,
                .tool = box_is_tool ? around : within,
                .voxel_m = 2 * kMm,
                .path = along(150, [](double t) { return at(Vec3(0.8 * kMm * t, 0, 0)); }),
                .approach = Vec3(1, 0, 0)};
  out.truths = {{.at = 0, .direction = {}, .most_force = 1e-9, .couple_against = {}},
                {.at = 150, .direction = Vec3(-1, 0, 0), .most_force = {}, .couple_against = {}}};
  return out;
}

}  // namespace

std::vector<ForceCaseMaker> force_cases() {
  std::vector<ForceCaseMaker> out;
  const auto add = [&](const std::string& name, const std::function<ForceCase()>& make) {
    out.push_back({name, [name, make] {
                     ForceCase made = make();
                     made.name = name;
                     return made;
                   }});
  };
  for (const std::uint32_t sides : {24u, 48u, 96u, 240u})
    for (const double play : {0.05, 0.3, 3.0})
      add(fmt::format("peg of {} sides tilted, play {} mm", sides, play),
          [=] { return peg_tilted(sides, play * kMm); });
  for (const std::uint32_t sides : {24u, 96u})
    for (const double play : {0.05, 0.3}) {
      add(fmt::format("peg of {} sides off centre, play {} mm", sides, play),
          [=] { return peg_off_centre(sides, play * kMm, 0); });
      add(fmt::format("peg of {} sides off centre askew, play {} mm", sides, play),
          [=] { return peg_off_centre(sides, play * kMm, 1); });
      add(fmt::format("peg of {} sides round its hole, play {} mm", sides, play),
          [=] { return peg_round(sides, play * kMm); });
    }
  add("press fit of 48 sides", [] { return press_fit(48); });
  add("press fit of 96 sides", [] { return press_fit(96); });
  add("square peg yawed", square_peg_yawed);
  add("square peg into the corner", square_peg_into_the_corner);
  add("key yawed in its keyway", key_yawed);
  add("tongue between walls", tongue_between_walls);
  add("ring on a shaft", ring_on_a_shaft);
  add("shaft in two bearings", shaft_in_two_bearings);
  add("dovetail lifted", dovetail_lifted);
  add("gears of 20 and 12 teeth", gears);
  for (const double gap : {0.1, 0.3, 0.6})
    for (const double voxel : {1.5, 1.0, 0.5})
      add(fmt::format("bracket, leg at {} mm, voxels of {} mm", gap, voxel),
          [=] { return bracket(gap, voxel * kMm); });
  add("sphere over an edge", sphere_over_an_edge);
  add("sphere into a corner", sphere_into_a_corner);
  for (const int pads : {2, 4})
    add(fmt::format("plate on to {} pads", pads), [=] { return plate_over_pads(pads); });
  add("plate on six waves", plate_on_waves);
  add("box off a table", box_off_a_table);
  for (const double thick : {0.4, 2.0, 10.0})
    add(fmt::format("plate of {} mm pierced", thick), [=] { return plate_pierced(thick); });
  add("thin tool on a thick block", [] {
    return pressed_down(block(Vec3(-40, -40, -30), Vec3(40, 40, 0)),
                        block(Vec3(-15, -10, 0), Vec3(15, 10, 0.5)), 0.1, 0.35, 2 * kMm);
  });
  add("thick tool on a thin plate", [] {
    return pressed_down(block(Vec3(-40, -40, -0.8), Vec3(40, 40, 0)),
                        block(Vec3(-15, -10, 0), Vec3(15, 10, 20)), 0.1, 0.4, 2 * kMm);
  });
  add("pin on a plate", [] {
    return pressed_down(block(Vec3(-40, -40, -10), Vec3(40, 40, 0)),
                        solids::cylinder(0.8 * kMm, 30 * kMm, 16), 0.1, 1.5, 3 * kMm, Vec3(1.3, 0.7, 0));
  });
  add("plate on a pin", [] {
    return pressed_down(solids::moved(solids::cylinder(0.8 * kMm, 30 * kMm, 16), at(Vec3(0, 0, -30 * kMm))),
                        block(Vec3(-20, -20, 0), Vec3(20, 20, 6)), 0.1, 1.5, 3 * kMm);
  });
  add("thin plate whose faces do not meet on a pin", [] {
    return pressed_down(solids::moved(solids::cylinder(0.8 * kMm, 30 * kMm, 16), at(Vec3(0, 0, -30 * kMm))),
                        solids::split(block(Vec3(-20, -20, 0), Vec3(20, 20, 0.8)), 1e-3), 0.1, 0.4, 3 * kMm);
  });
  add("cone's tip on a block", [] {
    return pressed_down(block(Vec3(-40, -40, -30), Vec3(40, 40, 0)), solids::cone(15 * kMm, 30 * kMm, 96),
                        0.1, 2.1, 0, Vec3(3.1, 2.2, 0));
  });
  add("cone's tip over an edge", cone_over_an_edge);
  add("needle", [] {
    return pressed_down(block(Vec3(-40, -40, -30), Vec3(40, 40, 0)),
                        block(Vec3(-0.3, -0.3, 0), Vec3(0.3, 0.3, 40)), 0.1, 1.5, 4 * kMm, Vec3(3.1, 2.2, 0));
  });
  add("sheet from above", [] { return on_a_sheet(1); });
  add("sheet from below", [] { return on_a_sheet(-1); });
  add("open box from outside", on_an_open_box);
  add("block in an open box", [] { return in_an_open_box(false); });
  add("open box round a block", [] { return in_an_open_box(true); });
  add("tool wholly swallowed", [] {
    return pressed_down(block(Vec3(-40, -40, -60), Vec3(40, 40, 0)), solids::sphere_of(5 * kMm, 2000), -8, 4,
                        2 * kMm, Vec3(3, 2, 0));
  });
  return out;
}

}  // namespace palpate
