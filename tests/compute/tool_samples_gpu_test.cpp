// The tool's grid samples on the device: what preparation lists, and what a frame does without a list.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
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

/// As native_test's: more than are listed.
TEST_F(ToolSamples, AreWorkedOutInAFrameWhereThereAreTooMany) {
  const auto scene = equivalence::lattice_scene(equivalence::box_of(Int3(0, 0, -3000), Int3(2000, 1500, 0)),
                                                equivalence::box_of(Int3(0), Int3(12000, 12000, 40)), 504, 8);
  ASSERT_TRUE(scene) << scene.error().sentence;
  const auto prepared = prepare_scene(device(), *scene, Plan{}, {});
  ASSERT_TRUE(prepared) << prepared.error().sentence;
  ASSERT_FALSE(static_cast<bool>(prepared->tool_sample_points));
  const auto gpu = make_gpu_backend({});
  ASSERT_TRUE(gpu) << gpu.error().sentence;
  const auto ref = make_ref_backend();
  ASSERT_TRUE((*gpu)->prepare(*scene, Plan{}, {}));
  ASSERT_TRUE(ref->prepare(*scene, Plan{}, {}));
  const LatticePose pose =
      *to_lattice(Pose{Vec3(-5003, -4007, -11), glm::angleAxis(0.001, Vec3(0.6, 0.8, 0))}, *scene);
  Contacts found, expected;
  ASSERT_TRUE((*gpu)->query(pose, nullptr, found));
  ASSERT_TRUE(ref->query(pose, nullptr, expected));
  std::uint32_t pushes = 0;
  for (const FieldBin& bin : expected.field.bins) pushes += bin.samples;
  EXPECT_GT(pushes, 1000u);
  EXPECT_FALSE(found.truncated);
  EXPECT_EQ(first_difference(found, expected), "");
}

}  // namespace
}  // namespace palpate
