#include "service/bench/error/numerics_cases.h"

#include <algorithm>
#include <cmath>

#include "model/generate/solids.h"

namespace palpate {
namespace {

constexpr double kMm = 1e-3;
const Vec3 kAside = Vec3(0.617, -0.331, 0) * kMm;  // of nothing's symmetry

double area_of(double longest_side) { return longest_side * longest_side / 64; }

/// ∫ min(φ, way to the nearest of the four sides) over a rectangle a × b, 2φ no larger than either: what lies
/// further inside has φ, the margin grows from 0.
double sunk(double a, double b, double depth) {
  return (a - 2 * depth) * (b - 2 * depth) * depth + (a + b) * depth * depth - 8 * depth * depth * depth / 3;
}

/// The same with the two sides of length b alone.
double between(double a, double b, double depth) { return b * (a * depth - depth * depth); }

}  // namespace

NumericsScene corner_scene(const CornerExtreme& e) {
  // h deep, with normal (0, 0, 1), the section is a triangle of area S = 3√3/2 h². Of the plane's samples the
  // nearest of three faces is √3 h times the least of a place's barycentric coordinates away, a ninth on
  // average; the cube's own push by the volume S h / 3. So F = K / (2 A_ref) · S h (√3/9 + 1/3).
  NumericsScene out;
  const double side = 20 * kMm, half = side / 2, block = 20 * kMm;
  const Vec3 away(e.offset, e.offset / 2, 0);
  out.mockup = solids::box(Vec3(-block, -block, -block), Vec3(block, block, 0), Int3(1, e.strips, 1));
  for (Vec3& v : out.mockup.vertices) v = v * e.scale + away;
  out.tool = solids::box(Vec3(-half), Vec3(half));
  for (Vec3& v : out.tool.vertices) v *= e.scale;
  out.pose.rotation = glm::angleAxis(0.61, Vec3(0, 0, 1)) *
                      glm::angleAxis(std::atan(std::sqrt(2.0)), glm::normalize(Vec3(1, -1, 0)));
  out.pose.position = (kAside + Vec3(0, 0, half * std::sqrt(3.0) - e.depth)) * e.scale + away;
  out.stiffness = e.stiffness, out.voxel = e.voxel * e.scale, out.spacing = e.spacing * e.scale;
  const double h = e.depth, section = 1.5 * std::sqrt(3.0) * h * h;
  out.reference_area = area_of(side * e.scale);
  out.force = Vec3(
      0, 0, e.stiffness * e.scale * (section * h * (std::sqrt(3.0) / 9 + 1.0 / 3) / (2 * area_of(side))));
  out.length = e.depth * e.scale;
  return out;
}

NumericsScene long_patch(double aspect) {
  NumericsScene out;
  const double width = 4 * kMm, length = aspect * width, tall = std::min(length, 10 * kMm), deep = 0.2 * kMm,
               block = length + 10 * kMm;
  out.mockup = solids::box(Vec3(-block, -block, -20 * kMm), Vec3(block, block, 0));
  out.tool = solids::box(Vec3(-length / 2, -width / 2, 0), Vec3(length / 2, width / 2, tall));
  out.pose = {kAside + Vec3(0, 0, -deep), glm::angleAxis(0.61, Vec3(0, 0, 1))};
  out.voxel = std::max(1.0, aspect / 64) * kMm;  // as many along the patch, however long it is
  out.reference_area = area_of(std::max(length, tall));
  out.force = Vec3(
      0, 0, out.stiffness / (2 * out.reference_area) * (sunk(length, width, deep) + length * width * deep));
  out.length = deep;
  return out;
}

NumericsScene many_patches(int count) {
  NumericsScene out;
  // Pads so wide that they are no thin pieces, which would speak for themselves (EXACTNESS section 4).
  const double pad = 4 * kMm, tall = 30 * kMm, pitch = 8 * kMm, deep = 0.2 * kMm, half = count * pitch / 2;
  for (int y = 0; y < count; ++y)
    for (int x = 0; x < count; ++x) {
      const Vec3 low(x * pitch - half, y * pitch - half, -tall);
      solids::append(out.mockup, solids::box(low, low + Vec3(pad, pad, tall)), "");
    }
  const double side = 2 * half + pitch;  // a margin that no pad reaches
  out.tool = solids::box(Vec3(-side / 2, -side / 2, 0), Vec3(side / 2, side / 2, 5 * kMm));
  out.pose = {kAside + Vec3(0, 0, -deep), Quat(1, 0, 0, 0)};
  out.voxel = 2 * kMm, out.spacing = 0.4 * kMm;
  out.reference_area = area_of(std::max(side, 5 * kMm));
  out.force = Vec3(
      0, 0,
      out.stiffness / (2 * out.reference_area) * count * count * (pad * pad * deep + sunk(pad, pad, deep)));
  out.length = deep;
  return out;
}

NumericsScene peg_with_play(double play, bool aside) {
  NumericsScene out;
  const double side = 20 * kMm, gap = play * side, half = side / 2, hole = half + gap, wall = 15 * kMm,
               deep = 15 * kMm;
  const auto add = [&](const Vec3& low, const Vec3& high) {
    solids::append(out.mockup, solids::box(low, high), "");
  };
  add(Vec3(hole, -hole - wall, -deep), Vec3(hole + wall, hole + wall, deep));
  add(Vec3(-hole - wall, -hole - wall, -deep), Vec3(-hole, hole + wall, deep));
  add(Vec3(-hole, hole, -deep), Vec3(hole, hole + wall, deep));
  add(Vec3(-hole, -hole - wall, -deep), Vec3(hole, -hole, deep));
  out.tool = solids::box(Vec3(-half, -half, -2 * deep), Vec3(half, half, 2 * deep));
  out.pose.position = Vec3(aside ? 2 * gap : 0, 0, 0);
  out.spacing = 0.5 * kMm;
  out.reference_area = area_of(4 * deep);
  out.contact = aside;
  out.length = gap;
  // The wall's samples end with the hole, whose edges the peg's faces stand over; the peg's end with the peg,
  // between walls that are as far away.
  if (aside)
    out.force = Vec3(-out.stiffness / (2 * out.reference_area) *
                         (between(side, 2 * deep, gap) + between(2 * deep, side, gap)),
                     0, 0);
  return out;
}

NumericsScene tongue_pressed(double overlap) {
  NumericsScene out;
  const double side = 20 * kMm, over = overlap * side, half = side / 2, inner = half - over, high = 10 * kMm,
               wall = 15 * kMm, length = 12 * kMm;
  for (const double sign : {1.0, -1.0}) {
    const double near = sign * inner, far = sign * (inner + wall);
    solids::append(out.mockup,
                   solids::box(Vec3(-2 * length, std::min(near, far), -high),
                               Vec3(2 * length, std::max(near, far), high)),
                   "");
  }
  out.tool = solids::box(Vec3(-length, -half, -2 * high), Vec3(length, half, 2 * high));
  out.pose.position = Vec3(0.617 * kMm, over / 2, 0.331 * kMm);
  out.spacing = 0.5 * kMm;
  out.reference_area = area_of(4 * high);
  const auto pushes = [&](double deep) {
    return between(2 * length, 2 * high, deep) + between(2 * high, 2 * length, deep);
  };
  out.force =
      Vec3(0, -out.stiffness / (2 * out.reference_area) * (pushes(1.5 * over) - pushes(0.5 * over)), 0);
  out.length = over;
  return out;
}

HungBar hung_bar(double slimness) {
  HungBar out;
  NumericsScene& scene = out.scene;
  const double length = 50 * kMm, side = slimness * length, deep = side / 20, block = side / 2 + 2 * kMm;
  scene.mockup = solids::box(Vec3(-block, -block, -block), Vec3(block, block, 0));
  scene.tool = solids::box(Vec3(-side / 2, -side / 2, 0), Vec3(side / 2, side / 2, length));
  scene.pose.position = kAside + Vec3(0, 0, -deep);
  scene.voxel = std::max(side / 4, 0.2 * kMm), scene.spacing = std::max(side / 40, scene.voxel / 60);
  scene.reference_area = area_of(length);
  const auto push = [&](double u) {
    return scene.stiffness / (2 * scene.reference_area) * (sunk(side, side, u) + side * side * u);
  };
  double low = 0, high = deep;  // K (deep − u) falls, the push grows
  for (int i = 0; i < 100; ++i) {
    const double u = (low + high) / 2;
    (push(u) < scene.stiffness * (deep - u) ? low : high) = u;
  }
  scene.force = Vec3(0, 0, push(low));
  scene.length = deep;
  out.ratio = side * side / scene.reference_area;
  return out;
}

}  // namespace palpate
