// Holds clearance() of the native engine against CGAL's exact kernel: no pair is nearer, the named pair is as
// near, and both witnesses lie on their triangles but for rounding. CGAL finds the pairs whose boxes are near
// enough by itself.
//   distance_judge --poses N [--apart] [SCENE...]
// --apart: N poses a scene at which it does not touch, from near the mock-up to far from it.
// Without SCENE: the cases of tests/equivalence that together reach every rule.
#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <CGAL/box_intersection_d.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <string>
#include <vector>

#include "compute/native/native_backend.h"
#include "service/cli/pose_input.h"
#include "tests/queries/scene_poses.h"

namespace palpate::queries {
namespace {

using Kernel = CGAL::Exact_predicates_exact_constructions_kernel;
using NearBox = CGAL::Box_intersection_d::Box_with_info_d<double, 3, std::uint32_t>;

Kernel::Point_3 point(const Int3& p) { return {p.x, p.y, p.z}; }

struct Body {
  std::vector<Kernel::Triangle_3> triangles;  // by id; of one that counts
  std::vector<NearBox> boxes;
};

template <class Corner>
Body body_of(const LatticeMesh& mesh, double growth, Corner corner) {
  Body out;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const Int3 a = corner(t, 0), b = corner(t, 1), c = corner(t, 2);
    out.triangles.emplace_back(point(a), point(b), point(c));
    if (mesh.collapsed(t) || out.triangles.back().is_degenerate()) continue;
    double low[3], high[3];
    for (int k = 0; k < 3; ++k) {
      low[k] = std::min({a[k], b[k], c[k]}) - growth;
      high[k] = std::max({a[k], b[k], c[k]}) + growth;
    }
    out.boxes.emplace_back(low, high, t);
  }
  return out;
}

struct Counts {
  std::uint64_t poses = 0, touching = 0, apart = 0, pairs = 0, wrong = 0;
};

/// What is wrong with an answer; empty: nothing.
std::string judge(const SceneGeometry& geometry, Body& mockup, const LatticePose& pose,
                  const Clearance& found, Counts& counts) {
  Body tool = body_of(geometry.tool, found.steps + 1.0,
                      [&](std::uint32_t t, int k) { return transform(pose, geometry.tool.corner(t, k)); });
  const Kernel::FT least(static_cast<double>(found.steps) * found.steps),
      most(static_cast<double>(found.steps + 1) * (found.steps + 1));
  std::string wrong;
  bool as_near = false;
  std::pair<std::uint32_t, std::uint32_t> first{kNoTriangle, kNoTriangle};
  CGAL::box_intersection_d(mockup.boxes.begin(), mockup.boxes.end(), tool.boxes.begin(), tool.boxes.end(),
                           [&](const NearBox& s, const NearBox& m) {
                             ++counts.pairs;
                             const Kernel::FT d =
                                 CGAL::squared_distance(mockup.triangles[s.info()], tool.triangles[m.info()]);
                             if (d < least)
                               wrong = "triangles " + std::to_string(s.info()) + " and " +
                                       std::to_string(m.info()) + " are nearer";
                             if (d < most) {
                               as_near = true;
                               first = std::min(first, {s.info(), m.info()});
                             }
                           });
  if (!wrong.empty()) return wrong;
  if (!as_near) return "no pair is so near";
  if (first != std::pair{found.static_id, found.mobile_id})
    return "the pair named is not the first that is so near";
  const Kernel::FT rounding(0.75);
  if (CGAL::squared_distance(point(found.on_static), mockup.triangles[found.static_id]) > rounding)
    return "the witness is off the mock-up";
  if (CGAL::squared_distance(point(found.on_mobile), tool.triangles[found.mobile_id]) > rounding)
    return "the witness is off the tool";
  return "";
}

/// Poses at which the tool does not touch: along the scene's path as far as it is free, and about the
/// mock-up, ever further away. Fewer than `count` where they are rare.
std::vector<LatticePose> apart_poses(const Subject& subject, std::size_t count, double reach) {
  constexpr std::uint64_t kRounds = 32, kFurther = 4;
  const auto native = make_native_backend();
  std::vector<LatticePose> out;
  if (!native->prepare(subject.geometry, Plan{}, [](const char*, double) { return true; })) return out;
  for (std::uint64_t round = 0; round < kRounds && out.size() < count; ++round) {
    const double far = reach * static_cast<double>(1u << round % kFurther);
    const std::vector<LatticePose> drawn = round == 0 && subject.path.size() > 1
                                               ? poses_along(subject, count, far / 8, 3)
                                               : poses_near(subject.geometry, count / 4 + 1, far, 3 + round);
    std::vector<std::uint8_t> bits(drawn.size());
    if (!native->touches(drawn, bits)) return out;
    for (std::size_t i = 0; i < drawn.size() && out.size() < count; ++i)
      if (bits[i] == 0 && !drawn[i].beyond_lattice) out.push_back(drawn[i]);
  }
  return out;
}

void ask(const std::string& name, const SceneGeometry& geometry, const std::vector<LatticePose>& poses,
         Counts& counts) {
  const auto native = make_native_backend();
  if (!native->prepare(geometry, Plan{}, [](const char*, double) { return true; })) return;
  Body mockup =
      body_of(geometry.mockup, 0, [&](std::uint32_t t, int k) { return geometry.mockup.corner(t, k); });
  const std::uint64_t apart = counts.apart, wrong_before = counts.wrong;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    Clearance found;
    const auto answered = native->clearance(poses[i], INT32_MAX - 2, found);
    ++counts.poses;
    if (!answered) {
      std::printf("%s: %s\n", name.c_str(), answered.error().sentence.c_str());
      ++counts.wrong;
      continue;
    }
    if (found.kind == Clearance::Kind::kTouching) ++counts.touching;
    if (found.kind != Clearance::Kind::kApart) continue;
    ++counts.apart;
    const std::string wrong = judge(geometry, mockup, poses[i], found, counts);
    if (!wrong.empty() && ++counts.wrong - wrong_before <= 5)
      std::printf("%s, pose %zu: %s (%d steps)\n", name.c_str(), i, wrong.c_str(), found.steps);
  }
  std::printf("%s: %zu poses, %llu apart, %llu wrong\n", name.c_str(), poses.size(),
              static_cast<unsigned long long>(counts.apart - apart),
              static_cast<unsigned long long>(counts.wrong - wrong_before));
}

int run(int argc, char** argv) {
  CLI::App app("distances against CGAL");
  std::vector<std::string> scenes;
  std::size_t poses = 8;
  double reach = 4;
  bool apart = false;
  app.add_flag("--apart", apart);
  app.add_option("scenes", scenes);
  app.add_option("--poses", poses);
  app.add_option("--reach", reach);
  CLI11_PARSE(app, argc, argv);
  Counts counts;
  for (const std::string& file : scenes) {
    const auto subject = subject_of_file(file);
    if (!subject) {
      std::fprintf(stderr, "%s\n", subject.error().sentence.c_str());
      return 1;
    }
    ask(file, subject->geometry,
        apart                      ? apart_poses(*subject, poses, reach)
        : subject->path.size() > 1 ? poses_along(*subject, poses, reach / 8, 3)
                                   : poses_near(subject->geometry, poses, reach, 3),
        counts);
  }
  if (scenes.empty())
    for (const equivalence::Case& c : equivalence::all_cases()) {
      if (c.profile != Profile::kRefined || !c.killer) continue;
      if (auto scene = c.make(1))
        ask(c.name, scene->geometry, poses_near(scene->geometry, poses, reach, 3), counts);
    }
  std::printf("%llu poses, %llu touch, %llu apart; %llu pairs asked of CGAL; %llu wrong\n",
              static_cast<unsigned long long>(counts.poses), static_cast<unsigned long long>(counts.touching),
              static_cast<unsigned long long>(counts.apart), static_cast<unsigned long long>(counts.pairs),
              static_cast<unsigned long long>(counts.wrong));
  return counts.wrong == 0 && counts.apart > 0 ? 0 : 1;
}

}  // namespace
}  // namespace palpate::queries

int main(int argc, char** argv) { return palpate::queries::run(argc, argv); }
