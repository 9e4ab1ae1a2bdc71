// The tool's grid samples on the device: what preparation lists, and what a frame does without a list.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "compute/gpu/gpu_backend.h"
#include "compute/gpu/prepare/prepared_scene.h"
#include "cpu_ref/ref_backend.h"
#include "cpu_ref/samples.h"
#include "model/generate/solids.h"
#include "model/scene/geometry_build.h"
#include "shaders/shared/frame_field.h"
#include "tests/compute/gpu_test.h"
#include "tests/equivalence/contacts_difference.h"
#include "tests/equivalence/lattice_shapes.h"

namespace palpate {
namespace {

class ToolSamples : public GpuTest {
 protected:
  static std::vector<std::uint32_t> words_of(const VulkanBuffer& buffer) {
    std::vector<std::uint32_t> out(buffer.bytes() / 4);
    EXPECT_TRUE(download(device(), buffer, 0, out.data(), buffer.bytes()));
    return out;
  }
};

using Sample = std::array<std::int32_t, 4>;  // point, level

/// By the reference: of a triangle whose samples weigh something.
std::vector<Sample> expected_of(const LatticeMesh& tool, std::uint32_t id, std::int32_t spacing) {
  std::vector<Sample> out;
  if (tool.collapsed(id) || tool.field_weight_q30[id] == 0) return out;
  const int axis = tool.sample_axis[id];
  cpu_ref::for_each_sample(tool, id, spacing, cpu_ref::triangle_of(tool, id).box(), [&](const Int3& p) {
    const cpu_ref::Cell cell{cpu_ref::floor_divide(std::int64_t{p[(axis + 1) % 3]}, std::int64_t{spacing}),
                             cpu_ref::floor_divide(std::int64_t{p[(axis + 2) % 3]}, std::int64_t{spacing})};
    out.push_back({p.x, p.y, p.z, cpu_ref::level_of(cell)});
  });
  return out;
}

TEST_F(ToolSamples, OfATriangleAreTheReferencesThoseOfTheHighestLevelFirst) {
  const auto geometry =
      build_geometry(solids::box(Vec3(-0.05), Vec3(0.05), Int3(2)), solids::sphere(0.02, 24, 16), {});
  ASSERT_TRUE(geometry) << geometry.error().sentence;
  const auto prepared = prepare_scene(device(), *geometry, Plan{}, {});
  ASSERT_TRUE(prepared) << prepared.error().sentence;
  ASSERT_TRUE(static_cast<bool>(prepared->tool_sample_points));
  const auto points = words_of(prepared->tool_sample_points), ends = words_of(prepared->tool_sample_ends);
  const LatticeMesh& tool = geometry->tool;
  ASSERT_EQ(ends.size(), 4 * gpu::kSampleEndTexels * tool.triangles.size());
  std::size_t all = 0;
  for (std::uint32_t id = 0; id < tool.triangles.size(); ++id) {
    std::vector<Sample> expected = expected_of(tool, id, geometry->sample_spacing), found;
    const std::uint32_t* const words = &ends[4 * gpu::kSampleEndTexels * id];
    for (std::uint32_t level = 0; level <= gpu::kMostSampleLevel; ++level)
      EXPECT_EQ(words[1 + level],
                static_cast<std::uint32_t>(
                    std::count_if(expected.begin(), expected.end(),
                                  [&](const Sample& s) { return s[3] >= static_cast<std::int32_t>(level); })))
          << "triangle " << id << ", level " << level;
    for (std::size_t i = words[0]; i < words[0] + words[1]; ++i) {
      Sample sample;
      for (std::size_t k = 0; k < 4; ++k) sample[k] = static_cast<std::int32_t>(points.at(4 * i + k));
      found.push_back(sample);
    }
    EXPECT_TRUE(std::is_sorted(found.begin(), found.end(),
                               [](const Sample& a, const Sample& b) { return a[3] > b[3]; }))
        << "triangle " << id;
    std::sort(expected.begin(), expected.end());
    std::sort(found.begin(), found.end());
    EXPECT_EQ(found, expected) << "triangle " << id;
    all += found.size();
  }
  EXPECT_GT(all, 1000u);
  EXPECT_EQ(points.size(), 4 * all);
}

/// A ball of long triangles that lie every way, and bumps, so that no three of its corners are alike; more
/// samples than are listed, of which a small block meets few.
equivalence::Triangles bumpy_ball() {
  constexpr int kRound = 60, kRings = 16;
  const auto at = [](int ring, int i) {
    const double theta = std::numbers::pi * ring / kRings, phi = 2 * std::numbers::pi * (i % kRound) / kRound,
                 r = 6500 + 150 * std::sin(7 * theta + 1) * std::cos(5 * phi);
    return Int3(std::lround(r * std::sin(theta) * std::cos(phi)),
                std::lround(r * std::sin(theta) * std::sin(phi)), std::lround(r * std::cos(theta)));
  };
  equivalence::Triangles out;
  for (int ring = 0; ring < kRings; ++ring)
    for (int i = 0; i < kRound; ++i) {
      if (ring > 0) out.push_back({at(ring, i), at(ring + 1, i), at(ring, i + 1)});
      if (ring + 1 < kRings) out.push_back({at(ring, i + 1), at(ring + 1, i), at(ring + 1, i + 1)});
    }
  return out;
}

/// As native_test's: more than are listed.
TEST_F(ToolSamples, AreWorkedOutInAFrameWhereThereAreTooMany) {
  const auto scene = equivalence::lattice_scene(equivalence::box_of(Int3(0, 0, -900), Int3(700, 500, 0)),
                                                bumpy_ball(), 504, 8);
  ASSERT_TRUE(scene) << scene.error().sentence;
  const auto prepared = prepare_scene(device(), *scene, Plan{}, {});
  ASSERT_TRUE(prepared) << prepared.error().sentence;
  ASSERT_FALSE(static_cast<bool>(prepared->tool_sample_points));
  const auto gpu = make_gpu_backend({});
  ASSERT_TRUE(gpu) << gpu.error().sentence;
  const auto ref = make_ref_backend();
  ASSERT_TRUE((*gpu)->prepare(*scene, Plan{}, {}));
  ASSERT_TRUE(ref->prepare(*scene, Plan{}, {}));
  // The block is cut by the ball's surface, on six sides of it.
  const Vec3 ways[] = {{0, 0, 1},          {0, 0.28, 0.96},     {0.6, 0, -0.8},
                       {-0.64, 0.6, 0.48}, {0.36, -0.8, -0.48}, {1, 0, 0}};
  for (const Vec3& way : ways) {
    SCOPED_TRACE(::testing::Message() << way.x << ' ' << way.y << ' ' << way.z);
    const LatticePose pose = *to_lattice(
        Pose{Vec3(350, 250, -450) - 6450.0 * way, glm::angleAxis(0.001, Vec3(0.6, 0.8, 0))}, *scene);
    Contacts found, expected;
    ASSERT_TRUE((*gpu)->query(pose, nullptr, found));
    ASSERT_TRUE(ref->query(pose, nullptr, expected));
    std::uint32_t pushes = 0;
    for (const FieldBin& bin : expected.field.bins) pushes += bin.samples;
    EXPECT_GT(pushes, 1000u);
    EXPECT_FALSE(found.truncated);
    EXPECT_EQ(first_difference(found, expected), "");
  }
}

}  // namespace
}  // namespace palpate
