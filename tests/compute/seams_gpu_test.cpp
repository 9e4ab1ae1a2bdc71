#include <algorithm>
#include <array>
#include <set>

#include "compute/prepare_seams.h"
#include "compute/prepared_scene.h"
#include "cpu_ref/triangle_triangle.h"
#include "model/generate/solids.h"
#include "model/geometry_build.h"
#include "tests/compute/code.h"
#include "tests/compute/gpu_test.h"
#include "tests/compute/probe_cases.h"

namespace palpate {
namespace {

using Pair = std::array<std::uint32_t, 2>;

class Seams : public GpuTest {
 protected:
  /// All seams of a mock-up on the device, each pair both ways, as the CSR has them; the same whoever looks for candidates.
  std::vector<Pair> on_device(const Mesh& mockup) {
    GeometrySettings settings;
    settings.voxel_size_m = 0.01;
    auto geometry = build_geometry(mockup, solids::box(Vec3(-0.01), Vec3(0.01)), settings);
    EXPECT_TRUE(geometry) << geometry.error().sentence;
    geometry_ = std::move(*geometry);
    const auto by_host = found(HostShare::kContacts), by_shaders = found(HostShare::kAreas);
    EXPECT_EQ(by_host, by_shaders);
    return by_host;
  }

  std::vector<Pair> found(HostShare share) {
    device().host_share = share;
    auto scene = prepare_scene(device(), geometry_, Plan{}, {});
    EXPECT_TRUE(scene) << scene.error().sentence;
    const std::size_t triangles = geometry_.mockup.triangles.size();
    std::vector<std::uint32_t> begin(triangles + 1), ids(scene->mockup.seam_entries);
    EXPECT_TRUE(download(device(), scene->mockup.seam_begin, 0, begin.data(), begin.size() * 4));
    EXPECT_TRUE(download(device(), scene->mockup.seams, 0, ids.data(), ids.size() * 4));
    std::vector<Pair> out;
    for (std::uint32_t s = 0; s < triangles; ++s)
      for (std::uint32_t i = begin[s]; i < begin[s + 1]; ++i) out.push_back({s, ids[i]});
    return out;
  }

  /// The definition, over all pairs, with the reference's predicates.
  std::vector<Pair> by_definition() const {
    const LatticeMesh& mesh = geometry_.mockup;
    std::vector<Pair> out;
    const auto count = static_cast<std::uint32_t>(mesh.triangles.size());
    for (std::uint32_t s = 0; s < count; ++s)
      for (std::uint32_t t = 0; t < count; ++t) {
        if (s == t || mesh.collapsed(s) || mesh.collapsed(t)) continue;
        const auto a = cpu_ref::triangle_of(mesh, s), b = cpu_ref::triangle_of(mesh, t);
        if (smooth(a.normal, b.normal, geometry_.smooth_angle) && touch(s, t, a, b)) out.push_back({s, t});
      }
    return out;
  }

  SceneGeometry geometry_;

 private:
  bool touch(std::uint32_t s, std::uint32_t t, const cpu_ref::Triangle& a, const cpu_ref::Triangle& b) const {
    const auto &vs = geometry_.mockup.triangles[s], &vt = geometry_.mockup.triangles[t];
    std::vector<int> i, j;
    for (int k = 0; k < 3; ++k) {
      if (std::find(vt.begin(), vt.end(), vs[static_cast<std::size_t>(k)]) != vt.end()) i.push_back(k);
      if (std::find(vs.begin(), vs.end(), vt[static_cast<std::size_t>(k)]) != vs.end()) j.push_back(k);
    }
    if (i.size() > 1) return false;
    if (i.empty()) return cpu_ref::triangles_intersect(a, b);
    return cpu_ref::segment_meets_triangle(a[(i[0] + 1) % 3], a[(i[0] + 2) % 3], b) ||
           cpu_ref::segment_meets_triangle(b[(j[0] + 1) % 3], b[(j[0] + 2) % 3], a);
  }
};

/// A triangle of a mesh given corner by corner.
void add(Mesh& mesh, Vec3 a, Vec3 b, Vec3 c) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), {a, b, c});
  mesh.triangles.push_back({first, first + 1, first + 2});
}

void finish(Mesh& mesh) { mesh.parts = {{"", 0, static_cast<std::uint32_t>(mesh.triangles.size())}}; }

TEST_F(Seams, ATJunctionInAFlatPlateIsASeam) {
  Mesh mesh;
  add(mesh, {0, 0, 0}, {0.4, 0, 0}, {0.2, 0.3, 0});       // one triangle above the line y = 0 …
  add(mesh, {0, 0, 0}, {0.1, -0.2, 0}, {0.2, 0, 0});      // … and two below, which share half of its side each
  add(mesh, {0.2, 0, 0}, {0.3, -0.2, 0}, {0.4, 0, 0});
  finish(mesh);
  const std::vector<Pair> want{{0, 1}, {0, 2}, {1, 0}, {2, 0}};   // 1 and 2 share a corner alone
  EXPECT_EQ(on_device(mesh), want);
}

TEST_F(Seams, AFanThatSharesOneCornerHasNone) {
  Mesh mesh;
  for (int i = 0; i < 6; i += 2) {   // every second triangle of a fan
    const double a = i * 1.0471975511965976, b = (i + 1) * 1.0471975511965976;
    add(mesh, {0, 0, 0}, {0.2 * std::cos(a), 0.2 * std::sin(a), 0}, {0.2 * std::cos(b), 0.2 * std::sin(b), 0});
  }
  finish(mesh);
  EXPECT_TRUE(on_device(mesh).empty());
}

TEST_F(Seams, AnEdgeSharedWithSmoothNormalsIsNone) {
  EXPECT_TRUE(on_device(solids::sphere(0.2, 24, 12)).empty());
}

TEST_F(Seams, AreThoseOfTheDefinitionWherePartsCrossAndCoincide) {
  Mesh mesh;
  solids::append(mesh, solids::sphere(0.2, 20, 10), "ball");
  solids::append(mesh, solids::moved(solids::sphere(0.2, 20, 10), Pose{Vec3(0.011, 0.003, 0.02), Quat(1, 0, 0, 0)}), "ball moved");
  solids::append(mesh, solids::box(Vec3(-0.3, -0.3, -0.22), Vec3(0.3, 0.3, -0.18), Int3(5, 5, 1)), "plate");
  solids::append(mesh, solids::box(Vec3(-0.3, -0.3, -0.22), Vec3(0.3, 0.3, -0.18), Int3(3, 4, 1)), "plate cut otherwise");
  solids::append(mesh, solids::box(Vec3(-0.3, -0.3, -0.22), Vec3(0.3, 0.3, -0.18), Int3(1, 1, 1)), "plate uncut");
  const auto got = on_device(mesh);
  EXPECT_GT(got.size(), 1000u);
  EXPECT_EQ(got, by_definition());
}

// An entry makes fewer pairs than its list is long; 92,683 triangles in one voxel make 2^32 + 55,607 together.
TEST(SeamRuns, HaveNoMorePairsThan32BitsCount) {
  for (const std::uint64_t longest : {0ull, 1ull, 256ull, 4095ull, 4096ull, 4097ull, 92'683ull, 0xFFFFFFFFull}) {
    const std::uint64_t entries = seam_entries_a_run(static_cast<std::uint32_t>(longest));
    EXPECT_LT(entries * longest, std::uint64_t{1} << 32) << longest;
    EXPECT_GE(entries, 1u);
  }
  EXPECT_EQ(seam_entries_a_run(92'683), 46'340u);
  EXPECT_EQ(seam_entries_a_run(300), 1u << 20);
}

TEST_F(Seams, TouchInMoreThanTheCommonCornerByTheReferencesPredicates) {
  const auto cases = probe_cases::seams();
  const auto answers = run_probe<gpu::SeamAnswer>(spirv::probe_seam, cases);
  std::size_t touching = 0, alone = 0;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    SCOPED_TRACE(i);
    const auto& c = cases[i];
    const cpu_ref::Triangle s(c.s[0], c.s[1], c.s[2]), t(c.t[0], c.t[1], c.t[2]);
    int common = 0, of_s = 0, of_t = 0;
    for (int j = 0; j < 3; ++j)
      for (int k = 0; k < 3; ++k)
        if (c.of_s[j] == c.of_t[k]) ++common, of_s = j, of_t = k;
    const bool want = common == 0 ? cpu_ref::triangles_intersect(s, t)
                                  : common == 1 && (cpu_ref::segment_meets_triangle(s[(of_s + 1) % 3], s[(of_s + 2) % 3], t) ||
                                                    cpu_ref::segment_meets_triangle(t[(of_t + 1) % 3], t[(of_t + 2) % 3], s));
    ASSERT_EQ(answers[i].touches != 0, want);
    ASSERT_EQ(answers[i].share_edge != 0, common > 1);
    ASSERT_FALSE(answers[i].alone != 0 && (want || common != 1));   // the cheap proof proves only what is so
    ASSERT_EQ(answers[i].culled, 0);
    touching += want ? 1u : 0u;
    alone += answers[i].alone != 0 ? 1u : 0u;
  }
  EXPECT_GT(touching, cases.size() / 10);
  EXPECT_GT(alone, cases.size() / 10);
}

}  // namespace
}  // namespace palpate
