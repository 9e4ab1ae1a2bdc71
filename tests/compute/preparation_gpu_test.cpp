// Both engines prepare the same samples and right tables, and take what was foretold.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <random>
#include <string>
#include <string_view>

#include "compute/gpu/gpu_backend.h"
#include "compute/gpu/prepare/prepared_scene.h"
#include "compute/native/prepare/sample_lists.h"
#include "compute/native/prepare/scene.h"
#include "compute/scene/estimate.h"
#include "compute/scene/exact.h"
#include "compute/scene/search_tables.h"
#include "model/generate.h"
#include "model/scene/geometry_build.h"
#include "shaders/shared/frame.h"
#include "tests/compute/partition_equality.h"
#include "tests/compute/subject.h"

namespace palpate {
namespace {

/// Triangles of all sizes and directions, slivers among them.
Mesh soup(std::size_t triangles) {
  Mesh mesh;
  std::mt19937 random(20);
  std::uniform_real_distribution<double> place(-0.5, 0.5), power(-3.5, 0);
  for (std::size_t i = 0; i < triangles; ++i) {
    const Vec3 at(place(random), place(random), place(random));
    const double size = std::pow(10, power(random)), thin = i % 3 == 0 ? 0.001 : 1;
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    const Vec3 along(place(random), place(random), place(random)),
        across(place(random), place(random), place(random));
    mesh.vertices.insert(mesh.vertices.end(), {at, at + size * along, at + size * thin * across});
    mesh.triangles.push_back({first, first + 1, first + 2});
  }
  mesh.parts = {{"", 0, static_cast<std::uint32_t>(triangles)}};
  return mesh;
}

/// Whether every voxel's points are the 1024ths that hold its triangles' first corners, each once and with
/// all that begin there, and then their samples, one by one, with axis and entry.
testing::AssertionResult points_are_right(const SceneGeometry& geometry, const native::Scene& scene) {
  const PartitionView lists = scene.mockup;
  const gpu::GridConstants& grid_of_voxels = lists.grid;
  const VoxelSamples& samples = *scene.samples;
  std::vector<std::uint32_t> expected;
  std::vector<std::uint16_t> entries, owners;
  std::vector<VoxelSamples::Begin> begins{{0, 0, 0}};
  std::uint32_t number = 0;  // of the next sample
  for (std::size_t voxel = 0; voxel < lists.boundary_place.size(); ++voxel) {
    const Int3 low = grid_of_voxels.origin +
                     grid_of_voxels.size * lists.boundary_voxel(static_cast<std::uint32_t>(voxel)),
               high = low + (grid_of_voxels.size - 1);
    const VoxelSamples::Voxel grid(low, geometry.sample_spacing);
    const auto put = [&](const Int3& point, std::size_t entry, std::uint32_t axis) {
      const auto part = [&](int k) {
        return static_cast<std::uint32_t>(std::floor(1024.0 * (point[k] - low[k]) / grid_of_voxels.size));
      };  // exact: below 2^39
      expected.push_back(part(0) | part(1) << 10 | part(2) << 20 | axis << 30);
      entries.push_back(static_cast<std::uint16_t>(entry));
    };
    const auto for_triangles = [&](auto&& take) {
      for (std::uint32_t e = lists.list_begin[voxel]; e < lists.list_begin[voxel + 1]; ++e)
        take(e, exact::Corners{geometry.mockup.corner(lists.list_triangles[e], 0),
                               geometry.mockup.corner(lists.list_triangles[e], 1),
                               geometry.mockup.corner(lists.list_triangles[e], 2)});
    };
    std::map<std::uint32_t, std::vector<std::uint32_t>> corners;  // entries by vertex
    for_triangles([&](std::uint32_t e, const exact::Corners& t) {
      if (t[0] == glm::clamp(t[0], low, high))
        corners[geometry.mockup.triangles[lists.list_triangles[e]][0]].push_back(e - lists.list_begin[voxel]);
    });
    const std::size_t first_owner = owners.size();
    for (const auto& [vertex, its] : corners) {
      put(geometry.mockup.vertices[vertex], owners.size() - first_owner, 0);
      owners.insert(owners.end(), its.begin(), its.end());
    }
    bool same = true;
    for_triangles([&](std::uint32_t e, const exact::Corners& t) {
      const std::uint8_t axis = geometry.mockup.sample_axis[lists.list_triangles[e]];
      exact::for_samples(
          t, axis, geometry.sample_spacing, low, high, [&](const Int3& point, std::int64_t, std::int64_t) {
            put(point, e - lists.list_begin[voxel], axis);
            same = same && number < samples.count() && samples.sample(grid, axis, number) == point;
            ++number;
          });
    });
    if (!same) return testing::AssertionFailure() << "samples of voxel " << voxel << " differ";
    begins.push_back(
        {static_cast<std::uint32_t>(expected.size()), number, static_cast<std::uint32_t>(owners.size())});
  }
  if (samples.begin != begins) return testing::AssertionFailure() << "begins differ";
  if (samples.entries != entries) return testing::AssertionFailure() << "entries differ";
  if (samples.owners != owners) return testing::AssertionFailure() << "owners differ";
  if (samples.points.size() != expected.size() + VoxelSamples::kPointsAtOnce - 1 ||
      !std::equal(expected.begin(), expected.end(), samples.points.begin()))
    return testing::AssertionFailure() << "points differ";
  return testing::AssertionSuccess();
}

/// Whether every listed triangle's box, as far as it lies in its voxel, is rounded down to 256ths of the
/// voxel.
testing::AssertionResult boxes_are_right(const SceneGeometry& geometry, const native::Scene& scene) {
  const PartitionView lists = scene.mockup;
  const gpu::GridConstants& grid_of_voxels = lists.grid;
  const std::vector<std::uint8_t>& boxes = scene.search->boxes;
  if (boxes.size() != 6 * lists.list_triangles.size() + SearchTables::kBoxesAtOnce)
    return testing::AssertionFailure() << boxes.size() << " bytes of boxes";
  for (std::size_t voxel = 0; voxel < lists.boundary_place.size(); ++voxel) {
    const Int3 low =
        grid_of_voxels.origin + grid_of_voxels.size * lists.boundary_voxel(static_cast<std::uint32_t>(voxel));
    const std::size_t count = lists.list_begin[voxel + 1] - lists.list_begin[voxel];
    for (std::size_t i = 0; i < count; ++i)
      for (std::size_t k = 0; k < 6; ++k) {
        const int axis = static_cast<int>(k % 3);
        const auto corner = [&](int c) {
          return geometry.mockup.corner(lists.list_triangles[lists.list_begin[voxel] + i], c)[axis];
        };
        const std::int32_t end =
            k < 3 ? std::min({corner(0), corner(1), corner(2)}) : std::max({corner(0), corner(1), corner(2)});
        const double part = 256.0 * std::clamp(end - low[axis], 0, grid_of_voxels.size - 1) /
                            grid_of_voxels.size,
                     found = boxes[6 * lists.list_begin[voxel] + k * count + i];
        if (found > part + 1e-9 || found < part - 1 - 1e-9)
          return testing::AssertionFailure()
                 << "voxel " << voxel << ", entry " << i << ", end " << k << ": " << found << ", " << part;
      }
  }
  return testing::AssertionSuccess();
}

/// What a buffer of words holds.
std::vector<std::uint32_t> words_of(VulkanDevice& device, const VulkanBuffer& buffer, std::size_t count) {
  std::vector<std::uint32_t> out(count);
  EXPECT_GE(buffer.bytes(), 4 * count);
  EXPECT_TRUE(download(device, buffer, 0, out.data(), 4 * count));
  return out;
}

/// Whether a voxel's points on the device are the samples and first corners of the triangles that it lists,
/// in any order.
testing::AssertionResult device_points_are_right(VulkanDevice& device, const PreparedScene& prepared,
                                                 const SceneGeometry& geometry, const native::Scene& scene) {
  const PartitionView lists = scene.mockup;
  const std::int32_t size = lists.grid.size;
  const std::size_t voxels = lists.grid.boundary_voxels, each = size > gpu::kNarrowVoxel ? 3 : 2;
  const auto begin = words_of(device, prepared.sample_begin, voxels + 1);
  const auto points = words_of(device, prepared.sample_points, each * begin.back()),
             ids = words_of(device, prepared.sample_ids, begin.back());
  for (std::uint32_t voxel = 0; voxel < voxels; ++voxel) {
    const Int3 low = lists.grid.origin + size * lists.boundary_voxel(voxel), high = low + (size - 1);
    std::vector<std::array<std::int64_t, 4>> expected, found;
    const auto put = [](auto& to, const Int3& p, std::uint32_t id) { to.push_back({p.x, p.y, p.z, id}); };
    for (std::uint32_t e = lists.list_begin[voxel]; e < lists.list_begin[voxel + 1]; ++e) {
      const std::uint32_t id = lists.list_triangles[e];
      const exact::Corners t{geometry.mockup.corner(id, 0), geometry.mockup.corner(id, 1),
                             geometry.mockup.corner(id, 2)};
      if (t[0] == glm::clamp(t[0], low, high)) put(expected, t[0], id | gpu::kCornerProbe);
      exact::for_samples(t, geometry.mockup.sample_axis[id], geometry.sample_spacing, low, high,
                         [&](const Int3& p, std::int64_t, std::int64_t) { put(expected, p, id); });
    }
    for (std::size_t i = begin[voxel]; i < begin[voxel + 1]; ++i) {
      Int3 d;
      if (each == 3) {
        for (int k = 0; k < 3; ++k)
          d[k] = static_cast<std::int32_t>(points[3 * i + static_cast<std::size_t>(k)]);
      } else {
        const std::uint64_t packed = points[2 * i] | std::uint64_t{points[2 * i + 1]} << 32;
        for (int k = 0; k < 3; ++k) d[k] = static_cast<std::int32_t>(packed >> 20 * k & 0xFFFFF);
      }
      put(found, low + d, ids[i]);
    }
    std::sort(expected.begin(), expected.end());
    std::sort(found.begin(), found.end());
    if (found != expected) return testing::AssertionFailure() << "points of voxel " << voxel << " differ";
  }
  return testing::AssertionSuccess();
}

/// Whether the device's boxes are those of the native engine's search, in 32nds of the voxel.
testing::AssertionResult device_boxes_are_right(VulkanDevice& device, const PreparedScene& prepared,
                                                const native::Scene& scene) {
  const PartitionView lists = scene.mockup;
  const auto words = words_of(device, prepared.list_boxes, lists.grid.list_entries);
  for (std::uint32_t voxel = 0; voxel < lists.grid.boundary_voxels; ++voxel) {
    const std::size_t begin = lists.list_begin[voxel], count = lists.list_begin[voxel + 1] - begin;
    for (std::size_t i = 0; i < count; ++i)
      for (std::uint32_t k = 0; k < 6; ++k)
        if ((words[begin + i] >> 5 * k & 31u) != scene.search->boxes[6 * begin + k * count + i] / 8)
          return testing::AssertionFailure() << "voxel " << voxel << ", entry " << i << ", end " << k;
  }
  return testing::AssertionSuccess();
}

/// Boxes of what is connected by corners and fits into the tool: by labels that spread until none changes.
std::vector<std::array<std::int32_t, 6>> parts_of(const SceneGeometry& geometry) {
  const LatticeMesh& mesh = geometry.mockup;
  std::vector<std::uint32_t> label(mesh.vertices.size());
  for (std::uint32_t v = 0; v < label.size(); ++v) label[v] = v;
  for (bool changed = true; changed;) {
    changed = false;
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
      if (mesh.collapsed(t)) continue;
      const auto& [a, b, c] = mesh.triangles[t];
      const std::uint32_t least = std::min({label[a], label[b], label[c]});
      for (const std::uint32_t v : {a, b, c}) changed = changed || label[v] != least, label[v] = least;
    }
  }
  std::map<std::uint32_t, std::array<std::int32_t, 6>> boxes;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    if (mesh.collapsed(t)) continue;
    const Int3 first = mesh.corner(t, 0);
    auto& box = boxes
                    .try_emplace(label[mesh.triangles[t][0]],
                                 std::array{first.x, first.y, first.z, first.x, first.y, first.z})
                    .first->second;
    for (int corner = 0; corner < 3; ++corner)
      for (int k = 0; k < 3; ++k) {
        auto &low = box[static_cast<std::size_t>(k)], &high = box[static_cast<std::size_t>(k) + 3];
        low = std::min(low, mesh.corner(t, corner)[k]);
        high = std::max(high, mesh.corner(t, corner)[k]);
      }
  }
  std::vector<std::array<std::int32_t, 6>> out;
  const auto most = 2 * std::int64_t{geometry.tool_radius} + 2 * gpu::kCloseSteps;
  for (const auto& [root, box] : boxes)
    if (std::int64_t{box[3]} - box[0] <= most && std::int64_t{box[4]} - box[1] <= most &&
        std::int64_t{box[5]} - box[2] <= most)
      out.push_back(box);
  std::sort(out.begin(), out.end());
  return out;
}

TEST(Preparation, ListsTheSameSamplesInBothEnginesAndRightTablesForTheSearch) {
  struct Mockup {
    const char* name;
    Mesh mesh;
    double voxel_m, spacing_m;
    bool wide;  ///< heights in a voxel of more than 2^20 steps
  };
  const auto contacts = generate_scene("contacts", 8000, 1000),
             disassembly = generate_scene("disassembly", 4000, 1000);
  ASSERT_TRUE(contacts && disassembly);
  for (const Mockup& mockup : {Mockup{"contacts", contacts->mockup, 0, 0, true},
                               Mockup{"disassembly", disassembly->mockup, 0, 0, true},
                               Mockup{"soup", soup(500), 0.003, 0.0011, false},
                               Mockup{"soup, large voxels", soup(2000), 0.25, 0.0091, true}}) {
    SCOPED_TRACE(mockup.name);
    GeometrySettings settings;
    if (mockup.voxel_m > 0) settings.voxel_size_m = mockup.voxel_m;
    if (mockup.spacing_m > 0) settings.sample_spacing_m = mockup.spacing_m;
    const auto geometry = build_geometry(mockup.mesh, contacts->tool, settings);
    ASSERT_TRUE(geometry) << geometry.error().sentence;
    auto device = VulkanDevice::create({});
    ASSERT_TRUE(device);
    const auto prepared = prepare_scene(**device, *geometry, Plan{}, {});
    ASSERT_TRUE(prepared) << prepared.error().sentence;
    const auto native = native::prepare_scene(*geometry, Plan{}, {});
    ASSERT_TRUE(native) << native.error().sentence;
    expect_equal_tables(**device, *prepared, *native);
    ASSERT_TRUE(native->samples);
    EXPECT_GT(native->samples->count(), 10'000u);
    EXPECT_EQ(native->samples->wide, mockup.wide);
    EXPECT_TRUE(points_are_right(*geometry, *native));
    EXPECT_TRUE(boxes_are_right(*geometry, *native));
    EXPECT_TRUE(device_points_are_right(**device, *prepared, *geometry, *native));
    EXPECT_TRUE(device_boxes_are_right(**device, *prepared, *native));
    auto parts = native->search->parts;
    std::sort(parts.begin(), parts.end());
    EXPECT_EQ(parts, parts_of(*geometry));
    if (std::string_view(mockup.name).starts_with("soup")) {
      EXPECT_GT(parts.size(), 100u);
    }
    EXPECT_FALSE(SearchTables::make(*geometry, native->mockup, [] { return false; })) << "cancelled";
    const auto listing = [&](std::uint64_t most_bytes, bool go_on) {
      EntrySamples out;
      return native::list_samples(
          geometry->mockup, native->mockup, geometry->sample_spacing, most_bytes,
          [&](double) { return go_on; }, out);
    };
    EXPECT_EQ(listing(std::uint64_t{1} << 30, true), Listing::kDone);
    EXPECT_EQ(listing(4000, true), Listing::kTooMany);
    EXPECT_EQ(listing(std::uint64_t{1} << 30, false), Listing::kCancelled);
  }
}

TEST(Preparation, ListsNoSamplesWhereAVoxelListsMoreThanCanBeToldApart) {
  LatticeMesh mesh;
  mesh.vertices = {{1, 1, 1}, {90, 1, 1}, {1, 90, 1}};
  mesh.triangles = {{0, 1, 2}};
  mesh.sample_axis = {2};
  for (const std::uint32_t entries : {VoxelSamples::kLongestList, VoxelSamples::kLongestList + 1}) {
    Partition lists;  // one voxel of one brick; the triangle again and again
    lists.grid.origin = Int3(0);
    lists.grid.size = 100;
    lists.grid.bricks = Int3(1);
    lists.grid.mixed_bricks = lists.grid.boundary_voxels = 1;
    lists.grid.list_entries = entries;
    lists.list_begin = {0, entries};
    lists.list_triangles.resize(entries);
    lists.boundary_place = {0};
    lists.mixed_brick = {0};
    EntrySamples by_entry;
    const auto go_on = [](double) { return true; };
    ASSERT_EQ(native::list_samples(mesh, lists, 40, std::uint64_t{1} << 30, go_on, by_entry), Listing::kDone);
    VoxelSamples samples;
    const Listing outcome = list_points(mesh, lists, 40, go_on, std::move(by_entry), samples);
    EXPECT_EQ(outcome, entries == VoxelSamples::kLongestList ? Listing::kDone : Listing::kTooMany);
    if (outcome != Listing::kDone) continue;
    EXPECT_EQ(samples.entries.front(), 0);
    EXPECT_EQ(samples.entries.back(), VoxelSamples::kLongestList - 1);
    EXPECT_EQ(samples.owners.size(), VoxelSamples::kLongestList);  // of one corner
    EXPECT_EQ(samples.owners.back(), VoxelSamples::kLongestList - 1);
    EXPECT_EQ(samples.count(), 4 * VoxelSamples::kLongestList);  // of cells (1, 0), (0, 1), (2, 0) and (0, 2)
  }
}

TEST(Preparation, OfShadersRefusesAVoxelThatListsMoreThanASampleCanAsk) {
  const auto contacts = generate_scene("contacts", 8000, 1000);
  ASSERT_TRUE(contacts);
  Mesh crowd = soup(gpu::kLoopBudget + 1000);
  for (std::size_t corner = 0; corner < crowd.vertices.size(); ++corner)
    crowd.vertices[corner] *= corner % 3 == 0 ? 0.0 : 0.001;  // all share a corner, and so a voxel
  const auto geometry = build_geometry(crowd, contacts->tool, {});
  ASSERT_TRUE(geometry) << geometry.error().sentence;
  const auto device = taken(VulkanDevice::create({}));
  const auto refused = prepare_scene(*device, *geometry, Plan{}, {});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kBadValue);
  EXPECT_NE(refused.error().sentence.find("share a voxel, at most 30000"), std::string::npos)
      << refused.error().sentence;
  Plan paper;  // asks no samples
  paper.profile = Profile::kPaper;
  EXPECT_TRUE(prepare_scene(*device, *geometry, paper, {}));
}

TEST(Preparation, TakesNoMoreThanForetoldAndNotFarLess) {
  for (const auto& [name, triangles] : {std::pair{"disassembly", 1000},
                                        {"contacts", 25'000},
                                        {"disassembly", 100'000},
                                        {"disassembly", 300'000}}) {
    const Subject scene = subject(name, static_cast<std::uint64_t>(triangles), 1);
    auto device = VulkanDevice::create({});
    ASSERT_TRUE(device);
    const auto prepared = prepare_scene(**device, scene.geometry, Plan{}, {});
    ASSERT_TRUE(prepared) << prepared.error().sentence;
    const std::uint64_t foretold = estimate_preparation(scene.geometry, Plan{}),
                        taken = (*device)->most_allocated;
    EXPECT_LE(taken, foretold) << name << " " << triangles;
    EXPECT_GE(4 * taken + (std::uint64_t{256} << 20), foretold) << name << " " << triangles;
    std::printf("%s %d: taken %.1f MiB, foretold %.1f MiB\n", name, triangles,
                static_cast<double>(taken) / 1048576, static_cast<double>(foretold) / 1048576);
  }
}

TEST(Preparation, IsRefusedInASentenceBeforeItTakesWhatIsNotThere) {
  Subject scene = subject("disassembly", 4000, 1);
  scene.geometry.mockup_grid.size = 1;  // lists without end
  const auto backend = make_gpu_backend({});
  ASSERT_TRUE(backend);
  bool begun = false;
  const auto refused =
      (*backend)->prepare(scene.geometry, Plan{}, [&](const char*, double) { return begun = true; });
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kBadValue);
  EXPECT_NE(refused.error().sentence.find("MiB of memory of"), std::string::npos) << refused.error().sentence;
  EXPECT_FALSE(begun);
}

TEST(Preparation, EndsSoonAfterItIsCancelled) {
  const Subject scene = subject("disassembly", 4000, 1);
  const auto backend = make_gpu_backend({});
  ASSERT_TRUE(backend);
  int asked = 0;
  const auto cancelled =
      (*backend)->prepare(scene.geometry, Plan{}, [&](const char*, double) { return ++asked < 10; });
  ASSERT_FALSE(cancelled);
  EXPECT_EQ(cancelled.error().sentence, "preparation was cancelled");
  EXPECT_EQ(asked, 10) << "nobody is asked again";
}

}  // namespace
}  // namespace palpate
