// Scenes of extreme scale, place and size. Both back ends, bit by bit; and where a scene is another one
// enlarged by a power of two or put elsewhere, the same integers as that one.
#include <gmock/gmock.h>

#include <cmath>

#include "compute/gpu/gpu_backend.h"
#include "compute/native/native_backend.h"
#include "cpu_ref/ref_backend.h"
#include "model/contact/response.h"
#include "model/generate/solids.h"
#include "model/lattice/pose.h"
#include "model/scene/geometry_build.h"
#include "tests/equivalence/contacts_difference.h"

namespace palpate {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

constexpr double kStiffness = 2000;

/// A scene and what all engines answer.
struct Asked {
  SceneGeometry geometry;
  Contacts contacts;
  ContactResponse response;
};

std::unique_ptr<Asked> ask(const Mesh& mockup, const Mesh& tool, const Vec3& position,
                           const GeometrySettings& settings = {}) {
  auto geometry = build_geometry(mockup, tool, settings);
  if (!geometry) throw std::runtime_error(geometry.error().sentence);
  auto out = std::make_unique<Asked>(Asked{std::move(*geometry), {}, {}});
  GpuOptions options;
  options.validation = true;
  auto gpu = make_gpu_backend(options);
  if (!gpu) throw std::runtime_error(gpu.error().sentence);
  const auto native = make_native_backend(), ref = make_ref_backend();
  const LatticePose pose = *to_lattice(Pose{position, Quat(1, 0, 0, 0)}, out->geometry);
  Contacts reference, by_native;
  for (CollisionBackend* backend : {gpu->get(), native.get(), ref.get()}) {
    if (auto prepared = backend->prepare(out->geometry, {}, {}); !prepared)
      throw std::runtime_error(prepared.error().sentence);
    if (auto answered = backend->query(pose, nullptr,
                                       backend == ref.get()      ? reference
                                       : backend == native.get() ? by_native
                                                                 : out->contacts);
        !answered)
      throw std::runtime_error(answered.error().sentence);
  }
  EXPECT_EQ(first_difference(out->contacts, reference), "") << "(gpu, ref)";
  EXPECT_EQ(first_difference(by_native, reference), "") << "(cpu, ref)";
  respond(reference, pose, out->geometry, Profile::kRefined, kStiffness, out->response);
  return out;
}

/// Coordinates that are whole multiples of 2^-24 m, so that enlarging by powers of two and moving to 10^6 m
/// round nothing.
Mesh coarse(Mesh mesh, double scale, const Vec3& offset = Vec3(0)) {
  for (Vec3& v : mesh.vertices)
    for (int k = 0; k < 3; ++k) v[k] = std::nearbyint(v[k] * 0x1p24) * 0x1p-24 * scale + offset[k];
  return mesh;
}

Mesh block() { return solids::box(Vec3(-0.5, -0.5, -0.25), Vec3(0.5, 0.5, 0), Int3(24, 24, 6)); }
Mesh ball() { return solids::sphere(0.125, 24, 12); }
const Vec3 kTouching(0.375, 0.4375, 0.09375);  // 31 mm deep, near an edge

void expect_same_integers(const Asked& a, const Asked& b, double scale) {
  EXPECT_EQ(first_difference(a.contacts, b.contacts), "");
  EXPECT_EQ(a.geometry.lattice.step_m, b.geometry.lattice.step_m * scale);
  ASSERT_EQ(a.response.areas.size(), b.response.areas.size());
  for (std::size_t i = 0; i < a.response.areas.size(); ++i) {
    EXPECT_EQ(a.response.areas[i].depth, b.response.areas[i].depth * scale);
    EXPECT_EQ(a.response.areas[i].normal, b.response.areas[i].normal);
  }
  EXPECT_EQ(a.response.wrench.force, b.response.wrench.force * scale);
}

TEST(Scale, FromAMillimetreToTenKilometresTheAnswerIsTheSameEnlarged) {
  const auto base = ask(coarse(block(), 1), coarse(ball(), 1), kTouching);
  ASSERT_FALSE(base->contacts.cst.empty());
  ASSERT_FALSE(base->contacts.est.empty());
  for (const int exponent : {-10, 13}) {  // 0.98 mm, 8.2 km
    const double scale = std::ldexp(1.0, exponent);
    const auto scaled = ask(coarse(block(), scale), coarse(ball(), scale), kTouching * scale);
    expect_same_integers(*scaled, *base, scale);
  }
}

TEST(Scale, AMillionMetresFromTheOriginTheAnswerIsTheSame) {
  const Vec3 away(1e6, -1e6, 1e6);
  const auto base = ask(coarse(block(), 1), coarse(ball(), 1), kTouching);
  const auto moved = ask(coarse(block(), 1, away), coarse(ball(), 1), kTouching + away);
  expect_same_integers(*moved, *base, 1);
  // The contact point in world metres, to what a double resolves out there: 1e6 · 2^-52, times a few
  // operations.
  for (std::size_t i = 0; i < base->response.areas.size(); ++i)
    EXPECT_LT(glm::length(moved->response.areas[i].point - away - base->response.areas[i].point), 1e-9);
}

TEST(Scale, AToolThousandTimesTheMockUpFindsItInside) {
  // A cube of 1 mm within a block of 1 m, away from its walls: no crossing, all of the cube inside the tool.
  const auto asked = ask(solids::box(Vec3(-0.0005), Vec3(0.0005)), solids::box(Vec3(-0.5), Vec3(0.5)),
                         Vec3(0.1, 0.05, 0.025));
  EXPECT_TRUE(asked->contacts.contact);
  EXPECT_THAT(asked->contacts.cst, IsEmpty());
  EXPECT_EQ(asked->contacts.est.size(), 12u);
  ASSERT_EQ(asked->contacts.areas.size(), 1u);
  EXPECT_EQ(asked->contacts.areas[0].static_ids.size(), 12u);
}

Mesh one_triangle(const Vec3& a, const Vec3& b, const Vec3& c) {
  Mesh mesh;
  mesh.vertices = {a, b, c};
  mesh.triangles = {{0, 1, 2}};
  mesh.parts = {{"triangle", 0, 1}};
  return mesh;
}

TEST(OneTriangle, AgainstOneTriangleIsOnePair) {
  const Mesh lying = one_triangle(Vec3(-1, -1, 0), Vec3(1, -1, 0), Vec3(0, 1, 0));
  const Mesh standing = one_triangle(Vec3(0, -0.25, -0.5), Vec3(0, 0.25, -0.5), Vec3(0, 0, 0.5));
  const auto crossing = ask(lying, standing, Vec3(0));
  EXPECT_EQ(crossing->contacts.pairs, 1u);
  EXPECT_THAT(crossing->contacts.cst, ElementsAre(0u));
  EXPECT_THAT(crossing->contacts.cmt, ElementsAre(0u));
  EXPECT_FALSE(ask(lying, standing, Vec3(5, 0, 0))->contacts.contact);
}

TEST(OneTriangle, AgainstABallIsFeltFromTheSideItFaces) {
  const Mesh lying = one_triangle(Vec3(-1, -1, 0), Vec3(1, -1, 0), Vec3(0, 1, 0));
  const auto above = ask(lying, ball(), Vec3(0, -0.25, 0.1));
  EXPECT_THAT(above->contacts.cst, ElementsAre(0u));
  ASSERT_EQ(above->response.areas.size(), 1u);
  EXPECT_GT(above->response.wrench.force.z, 0);
  // A sheet is pushed the way out of the ball: straight up where it is symmetric about the ball's axis, which
  // a triangle is not quite.
  EXPECT_LT(std::hypot(above->response.wrench.force.x, above->response.wrench.force.y),
            0.01 * above->response.wrench.force.z);
}

}  // namespace
}  // namespace palpate
