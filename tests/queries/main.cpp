// Holds the planner's questions (docs/EXACTNESS.md, section 10) against whatever else can answer them. Exit
// code 1: something differs.
//   queries any [SCENE] --poses N        touches() of cpu (and with --ref of ref) against the sets' contact
//   queries distance [SCENE] --poses N   clearance() of cpu against that of ref
//   queries motions [SCENE] --poses N    first_contact() of cpu on N screws against dense sampling of the
//                                        same screw, and its time beside a frame's
// Without SCENE: every case of tests/equivalence in `refined`, N poses each.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <functional>
#include <string>
#include <vector>

#include "compute/native/native_backend.h"
#include "cpu_ref/distance_of_triangles.h"
#include "cpu_ref/ref_backend.h"
#include "model/lattice/rotation.h"
#include "model/lattice/screw.h"
#include "service/cli/pose_input.h"
#include "service/queries/first_contact.h"
#include "tests/equivalence/touching_poses.h"
#include "tests/queries/scene_poses.h"

namespace palpate::queries {
namespace {

double processor_seconds() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

bool alone = false;      // distances of cpu alone, for their time
std::size_t dense = 24;  // poses of each motion that are sampled

/// Whether a triangle of the tool that is collinear at a pose is so near. It is in no pair there, but on a
/// screw it counts as the segment that it is.
bool has_near_segment(const SceneGeometry& geometry, const LatticePose& pose, std::int32_t steps) {
  for (std::uint32_t m = 0; m < geometry.tool.triangles.size(); ++m) {
    if (geometry.tool.collapsed(m)) continue;
    const cpu_ref::Triangle moved(transform(pose, geometry.tool.corner(m, 0)),
                                  transform(pose, geometry.tool.corner(m, 1)),
                                  transform(pose, geometry.tool.corner(m, 2)));
    if (!moved.collapsed()) continue;
    for (std::uint32_t s = 0; s < geometry.mockup.triangles.size(); ++s)
      if (!geometry.mockup.collapsed(s) &&
          cpu_ref::distance_of(cpu_ref::triangle_of(geometry.mockup, s), moved).steps <= steps)
        return true;
  }
  return false;
}

struct Counts {
  std::uint64_t poses = 0, touching = 0, apart = 0, further = 0, differences = 0;
};

std::string text(const LatticePose& pose) {
  std::string out;
  for (const auto& row : pose.rotation_q30)
    for (const std::int32_t entry : row) out += std::to_string(entry) + " ";
  for (int k = 0; k < 3; ++k) out += std::to_string(pose.translation[k]) + " ";
  return out;
}
std::string text(const Clearance& c) {
  std::string out = c.kind == Clearance::Kind::kTouching  ? "touching"
                    : c.kind == Clearance::Kind::kFurther ? "further"
                                                          : "apart";
  for (const std::int64_t v : {std::int64_t{c.steps}, std::int64_t{c.static_id}, std::int64_t{c.mobile_id}})
    out += " " + std::to_string(v);
  for (const Int3& p : {c.on_static, c.on_mobile})
    out += " (" + std::to_string(p.x) + " " + std::to_string(p.y) + " " + std::to_string(p.z) + ")";
  return out;
}

void complain(const std::string& scene, std::size_t pose, const LatticePose& at, const std::string& a,
              const std::string& b, Counts& counts) {
  if (++counts.differences <= 5)
    std::printf("%s, pose %zu [%s]: %s against %s\n", scene.c_str(), pose, text(at).c_str(), a.c_str(),
                b.c_str());
}

bool failed(const Result<void>& done) {
  if (!done) std::fprintf(stderr, "%s\n", done.error().sentence.c_str());
  return !done;
}

void any(const std::string& name, const SceneGeometry& geometry, const std::vector<LatticePose>& poses,
         Counts& counts) {
  const auto native = make_native_backend();
  if (failed(native->prepare(geometry, Plan{}, [](const char*, double) { return true; }))) return;
  std::vector<std::uint8_t> bits(poses.size());
  const std::size_t warm = std::min<std::size_t>(poses.size(), 256);
  if (failed(native->touches(std::span(poses).first(warm), std::span(bits).first(warm))))
    ++counts.differences;
  const double before = processor_seconds();
  const auto start = std::chrono::steady_clock::now();
  if (failed(native->touches(poses, bits))) ++counts.differences;
  const double wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(),
               seconds = processor_seconds() - before;
  std::uint64_t touching = 0;
  constexpr std::size_t kAtOnce = 4096;
  std::vector<Contacts> contacts(std::min(kAtOnce, poses.size()));
  double frames = 0;
  for (std::size_t first = 0; first < poses.size(); first += kAtOnce) {
    const std::size_t count = std::min(kAtOnce, poses.size() - first);
    const double begun = processor_seconds();
    if (failed(native->query_batch(std::span(poses).subspan(first, count), std::span(contacts).first(count))))
      ++counts.differences;
    frames += processor_seconds() - begun;
    for (std::size_t i = 0; i < count; ++i) {
      touching += contacts[i].contact ? 1u : 0u;
      if ((bits[first + i] != 0) != contacts[i].contact)
        complain(name, first + i, poses[first + i], bits[first + i] != 0 ? "touches" : "does not touch",
                 contacts[i].contact ? "contact" : "none", counts);
    }
  }
  counts.poses += poses.size();
  counts.touching += touching;
  std::printf(
      "%s: %zu poses, %llu touch; %.2f us of processor time a pose, %.2f as whole frames, %.0f poses/s on "
      "the clock\n",
      name.c_str(), poses.size(), static_cast<unsigned long long>(touching),
      1e6 * seconds / static_cast<double>(poses.size()), 1e6 * frames / static_cast<double>(poses.size()),
      static_cast<double>(poses.size()) / wall);
}

void distance(const std::string& name, const SceneGeometry& geometry, const std::vector<LatticePose>& poses,
              Counts& counts) {
  const auto native = make_native_backend(), ref = make_ref_backend();
  Clearance warm;
  for (CollisionBackend* backend : {native.get(), ref.get()})
    if ((backend == ref.get() && alone) == false &&
        failed(backend->prepare(geometry, Plan{}, [](const char*, double) { return true; })))
      return;
  if (failed(native->clearance(poses.front(), INT32_MAX - 2, warm))) return;  // trees are made
  std::vector<double> us;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    Clearance found, expected, within;
    const double before = processor_seconds();
    if (failed(native->clearance(poses[i], INT32_MAX - 2, found))) ++counts.differences;
    us.push_back(1e6 * (processor_seconds() - before));
    if (alone)
      expected = found;
    else if (failed(ref->clearance(poses[i], INT32_MAX - 2, expected)))
      ++counts.differences;
    if (!(found == expected)) complain(name, i, poses[i], text(found), text(expected), counts);
    // The same with an end to the search just at it, and just before.
    if (expected.kind == Clearance::Kind::kApart && !alone) {
      if (failed(native->clearance(poses[i], expected.steps, within)) || !(within == expected))
        complain(name, i, poses[i], "within: " + text(within), text(expected), counts);
      if (expected.steps > 0 && (failed(native->clearance(poses[i], expected.steps - 1, within)) ||
                                 within.kind != Clearance::Kind::kFurther))
        complain(name, i, poses[i], "within a step less: " + text(within), "further", counts);
    }
    ++counts.poses;
    (expected.kind == Clearance::Kind::kTouching ? counts.touching
     : expected.kind == Clearance::Kind::kApart  ? counts.apart
                                                 : counts.further) += 1u;
  }
  std::sort(us.begin(), us.end());
  if (!us.empty())
    std::printf("%s: %zu poses, distance %.1f us p50, %.1f us p99\n", name.c_str(), us.size(),
                us[us.size() / 2], us[us.size() * 99 / 100]);
}

void motions(const std::string& name, const SceneGeometry& geometry, const std::vector<LatticePose>& poses,
             Counts& counts) {
  constexpr int kClosePoses = 20'000;
  constexpr int kMostTries = 12;  // of starts, the further the more: a free one is wanted
  const auto native = make_native_backend();
  if (failed(native->prepare(geometry, Plan{}, [](const char*, double) { return true; }))) return;
  const TouchRule rule = TouchRule::of(geometry, 0);
  equivalence::Random random(5);
  std::vector<double> us, frame_us, evaluations;
  std::uint64_t late = 0, early = 0, undecided = 0, from_contact = 0;
  const double voxel = geometry.mockup_grid.size * geometry.lattice.step_m;
  const auto some = [&] { return 2 * random.unit() - 1; };
  std::vector<LatticePose> samples(dense);
  std::vector<std::uint8_t> bits(dense);
  Contacts contacts;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (poses[i].beyond_lattice) continue;
    const Pose to = equivalence::pose_of(poses[i], geometry);
    double reach = std::pow(10, 2 * random.unit() - 0.5);  // a third of a voxel to thirty
    Pose from;
    std::uint8_t starts_in = 1;
    for (int tries = 0; tries < kMostTries && starts_in != 0; ++tries, reach *= 1.5) {
      from = {to.position + reach * voxel * Vec3(some(), some(), some()),
              glm::normalize(rotation_by(random.unit() * Vec3(some(), some(), some())) * to.rotation)};
      const auto start = to_lattice(from, geometry);
      if (start && failed(native->touches({&*start, 1}, {&starts_in, 1}))) ++counts.differences;
    }
    double before = processor_seconds();
    const auto found = first_contact(*native, geometry, from, to, rule);
    if (!found) {
      ++counts.differences;
      continue;
    }
    ++counts.poses;
    us.push_back(1e6 * (processor_seconds() - before));
    evaluations.push_back(static_cast<double>(found->evaluations));
    undecided += found->kind == FirstContact::Kind::kUndecided ? 1u : 0u;
    (found->kind == FirstContact::Kind::kNone ? counts.apart : counts.touching) += 1u;
    if (found->kind == FirstContact::Kind::kContact && found->time == 0) {
      ++from_contact;
      continue;
    }
    const Screw screw(from, to, geometry);
    // Sparse all along, dense before the contact.
    for (std::size_t k = 0; k < dense; ++k) {
      const auto number = static_cast<double>(k);
      samples[k] = *to_lattice(
          screw.at(found->time * (k % 2 == 0 ? number / static_cast<double>(dense)
                                             : 1 - 0.02 * random.unit() * random.unit() / (1 + number))),
          geometry);
    }
    if (failed(native->touches(samples, bits))) ++counts.differences;
    // Contact without a pair is none of its own: into an open body one gets through the opening, and a tool
    // smaller than a voxel may start inside a boundary voxel, where no set knows of it (docs/EXACTNESS.md,
    // section 10). What went through a surface is seen to by poses so close that none is stepped over.
    bool met = false, within = false;
    for (std::size_t k = 0; k < samples.size() && !met; ++k) {
      if (bits[k] == 0) continue;
      if (failed(native->query(samples[k], nullptr, contacts))) ++counts.differences;
      met = contacts.pairs != 0;
      within = within || !met;
    }
    if (within && !met && geometry.mockup.closed && geometry.tool.closed)
      for (int k = 0; k < kClosePoses && !met; ++k) {
        const auto at = to_lattice(screw.at(found->time * k / kClosePoses), geometry);
        if (failed(native->query(*at, nullptr, contacts))) ++counts.differences;
        met = contacts.pairs != 0;
      }
    if (met && ++late <= 5) std::printf("%s: motion %zu is late\n", name.c_str(), i);
    Clearance near;
    const LatticePose end = *to_lattice(screw.at(found->time), geometry);
    if (found->kind == FirstContact::Kind::kContact &&
        (failed(native->clearance(end, rule.early, near)) ||
         (near.kind == Clearance::Kind::kFurther && !has_near_segment(geometry, end, rule.early) &&
          ++early <= 5)))
      std::printf("%s: motion %zu is early\n", name.c_str(), i);
    before = processor_seconds();
    if (failed(native->query(end, nullptr, contacts))) ++counts.differences;
    frame_us.push_back(1e6 * (processor_seconds() - before));
  }
  counts.differences += late + early;
  const auto middle = [](std::vector<double>& v, double share) {
    if (v.empty()) return 0.0;
    std::sort(v.begin(), v.end());
    return v[static_cast<std::size_t>(share * static_cast<double>(v.size() - 1))];
  };
  std::printf(
      "%s: %zu motions (%llu from a contact), %llu late, %llu early, %llu undecided; %.1f us p50, %.1f p99, "
      "%g "
      "evaluations p50, %g p99; a frame at its end %.1f us p50\n",
      name.c_str(), us.size(), static_cast<unsigned long long>(from_contact),
      static_cast<unsigned long long>(late), static_cast<unsigned long long>(early),
      static_cast<unsigned long long>(undecided), middle(us, 0.5), middle(us, 0.99), middle(evaluations, 0.5),
      middle(evaluations, 0.99), middle(frame_us, 0.5));
}

int run(int argc, char** argv) {
  CLI::App app("the planner's questions against other answers");
  std::string mode, file, pull, name;
  std::size_t poses = 24;
  std::uint64_t seed = 1;
  double reach = 4;
  bool killer = false, path = false;
  app.add_option("mode", mode)->required()->check(CLI::IsMember({"any", "distance", "motions"}));
  app.add_option("scene", file);
  app.add_option("--poses", poses);
  app.add_option("--seed", seed);
  app.add_option("--reach", reach);
  app.add_flag("--killer", killer);
  app.add_option("--case", name, "the case of this name alone");
  app.add_flag("--alone", alone, "distance: cpu alone, for its time");
  app.add_option("--samples", dense, "motions: poses of each that are asked whether they touch")
      ->check(CLI::PositiveNumber);
  app.add_flag("--path", path, "poses along the scene's own path");
  app.add_option("--pull", pull, "poses along this CSV file's");
  CLI11_PARSE(app, argc, argv);
  const auto ask = mode == "any" ? any : mode == "distance" ? distance : motions;
  Counts counts;
  if (!file.empty()) {
    auto subject = subject_of_file(file);
    if (!subject) {
      std::fprintf(stderr, "%s\n", subject.error().sentence.c_str());
      return 1;
    }
    if (!pull.empty()) {
      auto read = read_poses(pull);
      if (!read) {
        std::fprintf(stderr, "%s\n", read.error().sentence.c_str());
        return 1;
      }
      subject->path = std::move(*read);
    }
    path = path || !pull.empty();
    ask(file, subject->geometry,
        path ? poses_along(*subject, poses, reach, seed) : poses_near(subject->geometry, poses, reach, seed),
        counts);
  } else {
    for (const equivalence::Case& c : equivalence::all_cases()) {
      if (c.profile != Profile::kRefined || (killer && !c.killer) || (!name.empty() && name != c.name))
        continue;
      auto scene = c.make(seed);
      if (!scene) continue;
      equivalence::Random random(seed);
      std::vector<LatticePose> asked;
      for (std::size_t i = 0; i < poses; ++i) {
        equivalence::Known known;
        asked.push_back(scene->pose(scene->geometry, random, known));
      }
      for (const LatticePose& pose : poses_near(scene->geometry, poses, reach, seed)) asked.push_back(pose);
      ask(c.name, scene->geometry, asked, counts);
    }
  }
  std::printf("%llu poses (%llu touch, %llu apart, %llu further), %llu differ\n",
              static_cast<unsigned long long>(counts.poses), static_cast<unsigned long long>(counts.touching),
              static_cast<unsigned long long>(counts.apart), static_cast<unsigned long long>(counts.further),
              static_cast<unsigned long long>(counts.differences));
  return counts.differences == 0 && counts.poses > 0 ? 0 : 1;
}

}  // namespace
}  // namespace palpate::queries

int main(int argc, char** argv) { return palpate::queries::run(argc, argv); }
