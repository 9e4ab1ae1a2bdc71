// Areas and zones on meshes small enough to be read.
#include <gtest/gtest.h>

#include "cpu_ref/ref_backend.h"
#include "tests/cpu_ref/lattice_scene.h"

namespace palpate::cpu_ref {
namespace {

using Ids = std::vector<std::uint32_t>;

Contacts ask(const SceneGeometry& scene, Profile profile, const Int3& at = Int3(0)) {
  Plan plan;
  plan.profile = profile;
  const auto backend = make_ref_backend();
  if (const auto prepared = backend->prepare(scene, plan, {}); !prepared)
    throw std::runtime_error(prepared.error().sentence);
  Contacts contacts;
  if (const auto answered = backend->query(moved_by(at), nullptr, contacts); !answered)
    throw std::runtime_error(answered.error().sentence);
  return contacts;
}

std::vector<Ids> areas_of(const Contacts& contacts) {
  std::vector<Ids> areas;
  for (const ContactArea& area : contacts.areas) areas.push_back(area.static_ids);
  return areas;
}

/// A tool that crosses every triangle near the origin.
std::vector<Triangle> stamp(int half) {
  return lattice_box(Int3(-half, -half, -half), Int3(half, half, half));
}

TEST(Areas, TrianglesThatShareAnEdgeAreOne) {
  const auto scene = scene_of({Triangle(Int3(0, 0, 0), Int3(40, 0, 0), Int3(0, 40, 0)),
                               Triangle(Int3(40, 0, 0), Int3(40, 40, 0), Int3(0, 40, 0))},
                              stamp(20), 16, 4);
  for (const Profile profile : {Profile::kPaper, Profile::kRefined}) {
    const Contacts contacts = ask(scene, profile);
    ASSERT_EQ(areas_of(contacts), (std::vector<Ids>{{0, 1}}));
    EXPECT_EQ(contacts.areas[0].zones, (std::vector<Ids>{{0, 1}}));
  }
}

TEST(Areas, TrianglesThatShareAVertexAloneAreTwo) {
  const auto scene = scene_of({Triangle(Int3(0, 0, 0), Int3(40, 0, 0), Int3(0, 40, 0)),
                               Triangle(Int3(0, 0, 0), Int3(-40, 0, 0), Int3(0, -40, 0))},
                              stamp(20), 16, 4);
  for (const Profile profile : {Profile::kPaper, Profile::kRefined})
    EXPECT_EQ(areas_of(ask(scene, profile)), (std::vector<Ids>{{0}, {1}}));
}

TEST(Areas, AFanOfEdgeNeighboursIsOne) {
  std::vector<Triangle> fan;
  const std::vector<Int3> rim{{40, 0, 0}, {0, 40, 0}, {-40, 0, 0}, {0, -40, 0}, {40, 0, 0}};
  for (std::size_t i = 0; i + 1 < rim.size(); ++i) fan.emplace_back(Int3(0), rim[i], rim[i + 1]);
  EXPECT_EQ(areas_of(ask(scene_of(fan, stamp(20), 16, 4), Profile::kRefined)),
            (std::vector<Ids>{{0, 1, 2, 3}}));
}

TEST(Areas, ASharpEdgeMakesTwoZonesOfOneArea) {
  // Two faces of a box, at 90°, reached over their common edge.
  const auto scene = scene_of(lattice_box(Int3(-400, -400, -400), Int3(0, 400, 0)), stamp(60), 32, 8);
  const Contacts contacts = ask(scene, Profile::kRefined);
  ASSERT_EQ(contacts.areas.size(), 1u);
  EXPECT_EQ(contacts.areas[0].zones.size(), 2u);
  for (const Ids& zone : contacts.areas[0].zones)
    EXPECT_EQ(zone.size(), 1u);  // of each face the half at the edge
}

TEST(Areas, MobileTrianglesBelongToTheAreasThatHoldThem) {
  // Two patches far apart, a tool of two stamps, one on each: each area has the triangles of its own stamp.
  std::vector<Triangle> left = lattice_plate(Int3(-300, -20, 0), Int3(-260, 20, 0), 1),
                        right = lattice_plate(Int3(260, -20, 0), Int3(300, 20, 0), 1);
  const auto scene = scene_of(together({left, right}),
                              together({lattice_box(Int3(-290, -8, -8), Int3(-270, 8, 8)),
                                        lattice_box(Int3(270, -8, -8), Int3(290, 8, 8))}),
                              16, 4);
  const Contacts contacts = ask(scene, Profile::kRefined);
  ASSERT_EQ(contacts.areas.size(), 2u);
  for (const std::uint32_t m : contacts.areas[0].mobile_ids) EXPECT_LT(m, 12u);
  for (const std::uint32_t m : contacts.areas[1].mobile_ids) EXPECT_GE(m, 12u);
  EXPECT_FALSE(contacts.areas[0].mobile_ids.empty());
  EXPECT_FALSE(contacts.areas[1].mobile_ids.empty());
}

TEST(Areas, MoreThanTheLimitIsTruncationAndSaysSo) {
  // 300 triangles that share no corner under one large tool.
  std::vector<Triangle> many;
  for (int i = 0; i < 20; ++i)
    for (int j = 0; j < 15; ++j)
      many.emplace_back(Int3(i * 40, j * 40, 0), Int3(i * 40 + 20, j * 40, 0), Int3(i * 40, j * 40 + 20, 0));
  const auto scene = scene_of(many, lattice_box(Int3(-10, -10, -10), Int3(810, 610, 0)), 16, 4);
  const Contacts contacts = ask(scene, Profile::kPaper);
  EXPECT_TRUE(contacts.truncated);
  EXPECT_STREQ(contacts.truncated_capacity, "areas");
  EXPECT_TRUE(contacts.areas.empty());
  EXPECT_EQ(contacts.cst.size(), 300u);
  EXPECT_EQ(ask(scene, Profile::kRefined).areas.size(), 300u) << "people may look at as many as there are";
}

TEST(Sets, AreDisjointAndCoverTheContact) {
  const auto scene = scene_of(lattice_box(Int3(-400, -400, -400), Int3(0, 400, 0)), stamp(60), 32, 8);
  const Contacts contacts = ask(scene, Profile::kRefined, Int3(-20, 11, 30));
  for (const std::uint32_t s : contacts.cst) {
    EXPECT_FALSE(std::binary_search(contacts.bst.begin(), contacts.bst.end(), s));
    EXPECT_FALSE(std::binary_search(contacts.est.begin(), contacts.est.end(), s));
  }
  for (const std::uint32_t m : contacts.cmt) {
    EXPECT_FALSE(std::binary_search(contacts.bmt.begin(), contacts.bmt.end(), m));
    EXPECT_FALSE(std::binary_search(contacts.imt.begin(), contacts.imt.end(), m));
  }
  EXPECT_GT(contacts.pairs, 0u);
}

TEST(Sets, TouchingWithoutOverlapIsContact) {
  // A face on a face, and then a step away.
  const auto scene = scene_of(lattice_box(Int3(-400, -400, -400), Int3(400, 400, 0)),
                              lattice_box(Int3(-50, -50, 0), Int3(50, 50, 90)), 32, 8);
  EXPECT_TRUE(ask(scene, Profile::kRefined).contact);
  const Contacts apart = ask(scene, Profile::kRefined, Int3(0, 0, 1));
  EXPECT_FALSE(apart.contact);
  EXPECT_EQ(apart.pairs, 0u);
  EXPECT_FALSE(apart.bst.empty());  // near: reported, without force
  EXPECT_FALSE(apart.bmt.empty());
  EXPECT_TRUE(apart.areas.empty());
}

TEST(Sets, ATriangleThatCollapsesOnTheLatticeIsInNothing) {
  auto plate = lattice_plate(Int3(-40, -40, 0), Int3(40, 40, 0), 1);
  plate.emplace_back(Int3(-40, 0, 0), Int3(0, 0, 0), Int3(40, 0, 0));
  const Contacts contacts = ask(scene_of(plate, stamp(10), 16, 4), Profile::kRefined);
  EXPECT_EQ(contacts.cst, (Ids{0, 1}));
  EXPECT_TRUE(contacts.bst.empty());
}

TEST(Sets, BeyondTheLatticeIsFree) {
  const auto scene = scene_of(lattice_plate(Int3(-40, -40, 0), Int3(40, 40, 0), 1), stamp(10), 16, 4);
  Plan plan;
  const auto backend = make_ref_backend();
  ASSERT_TRUE(backend->prepare(scene, plan, {}));
  LatticePose pose = moved_by(Int3(0));
  Contacts contacts;
  ASSERT_TRUE(backend->query(pose, nullptr, contacts));
  EXPECT_TRUE(contacts.contact);
  pose.beyond_lattice = true;
  ASSERT_TRUE(backend->query(pose, nullptr, contacts));
  EXPECT_FALSE(contacts.contact);
  EXPECT_EQ(contacts.flags, 0u);
}

TEST(Backend, AnUnpreparedOneSaysSo) {
  Contacts contacts;
  const auto answered = make_ref_backend()->query(moved_by(Int3(0)), nullptr, contacts);
  ASSERT_FALSE(answered);
  EXPECT_EQ(answered.error().code, ErrorCode::kInternal);
}

}  // namespace
}  // namespace palpate::cpu_ref
