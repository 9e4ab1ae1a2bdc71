// No stage of a frame grows as a product of two sizes of a contact: one of twice the size costs about twice
// as much. Told by what stages look at, for time is noise.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <string>

#include "compute/native/native_backend.h"
#include "model/generate/solids.h"
#include "model/scene/geometry_build.h"

namespace palpate {
namespace {

/// What doubling a contact may cost (its rim and what a tree has above its leaves grow less, what is shared
/// out unevenly a little more).
constexpr double kMost = 2.3;

Contacts answer(const Mesh& mockup, const Mesh& tool, const GeometrySettings& settings, const Pose& pose) {
  auto geometry = build_geometry(mockup, tool, settings);
  EXPECT_TRUE(geometry) << geometry.error().sentence;
  const auto backend = make_native_backend();
  const auto done = backend->prepare(*geometry, Plan{}, {});
  EXPECT_TRUE(done) << done.error().sentence;
  const auto place = to_lattice(pose, *geometry);
  EXPECT_TRUE(place);
  Contacts contacts;
  for (int round = 0; round < 2; ++round) {  // the second knows what the first found
    const auto answered = backend->query(*place, nullptr, contacts);
    EXPECT_TRUE(answered) << answered.error().sentence;
  }
  EXPECT_TRUE(contacts.contact);
  return contacts;
}

/// By stage.
std::map<std::string, double> looks(const Mesh& mockup, const Mesh& tool, const GeometrySettings& settings,
                                    const Pose& pose) {
  std::map<std::string, double> out;
  const Contacts contacts = answer(mockup, tool, settings, pose);
  for (const Contacts::StageTime& stage : contacts.times)
    out[stage.stage] += static_cast<double>(stage.looks);
  return out;
}

/// A board whose face is pressed `depth_m` into a larger one, `length_m` of it, in triangles of `cell_m`.
std::map<std::string, double> pressed(double length_m, double depth_m, double cell_m, bool open,
                                      double voxel_m) {
  const auto cells = [&](double size) { return static_cast<int>(std::lround(size / cell_m)); };
  const Mesh table = solids::box(Vec3(0), Vec3(0.2, 0.1, 0.02), Int3(cells(0.2), cells(0.1), cells(0.02)));
  Mesh board =
      solids::box(Vec3(0), Vec3(length_m, 0.03, 0.01), Int3(cells(length_m), cells(0.03), cells(0.01)));
  if (open) board.triangles.pop_back();
  GeometrySettings settings;
  settings.voxel_size_m = voxel_m;
  settings.contact_samples = 0;  // all of them: fewer would hide the growth
  return looks(table, board, settings,
               {Vec3(0.0313, 0.0317, 0.02 - depth_m), glm::normalize(Quat(1, 0.0003, 0.0004, 0.01))});
}

void expect_growth(const std::map<std::string, double>& small, const std::map<std::string, double>& large,
                   double least) {
  for (const char* stage : {"cull", "sets", "field"}) {
    ASSERT_TRUE(small.contains(stage) && large.contains(stage)) << stage;
    const double ratio = large.at(stage) / small.at(stage);
    EXPECT_GT(small.at(stage), 1000) << stage;
    EXPECT_LT(ratio, kMost) << stage << ": " << small.at(stage) << " and " << large.at(stage);
    EXPECT_GT(ratio, least) << stage << ": what does not grow at all was not counted";
  }
}

TEST(Growth, AContactOfTwiceTheAreaIsAtMostALittleMoreThanTwiceTheWork) {
  for (const double depth : {0.0005, 0.004})
    for (const bool open : {false, true})
      expect_growth(pressed(0.05, depth, 0.001, open, 0.003), pressed(0.1, depth, 0.001, open, 0.003), 1.5);
}

// Twice the triangles of both bodies on the same area, and voxels as many triangles wide as before, as a
// scene that names no size gets them: with the old ones each would list twice as many for twice as many.
TEST(Growth, BodiesInTwiceTheTrianglesAreAtMostALittleMoreThanTwiceTheWork) {
  for (const bool open : {false, true})
    expect_growth(pressed(0.06, 0.002, 0.001, open, 0.003),
                  pressed(0.06, 0.002, 0.001 / std::sqrt(2), open, 0.003 / std::sqrt(2)),
                  1.2);  // voxels at the rim list few
}

// A ball wholly inside another: nothing touches, all samples of the ball count.
TEST(Growth, ASwallowedToolOfTwiceTheAreaIsAtMostALittleMoreThanTwiceTheWork) {
  const Mesh block = solids::sphere_of(0.1, 40'000);
  GeometrySettings settings;
  settings.voxel_size_m = 0.004;
  settings.contact_samples = 0;
  const auto swallowed = [&](double radius_m, std::uint64_t triangles) {
    return looks(block, solids::sphere_of(radius_m, triangles), settings,
                 {Vec3(0.01, 0.02, 0.003), Quat(1, 0, 0, 0)});
  };
  const auto small = swallowed(0.02, 4'000), large = swallowed(0.02 * std::sqrt(2), 8'000);
  for (const char* stage : {"sets", "field"})
    EXPECT_LT(large.at(stage) / small.at(stage), kMost)
        << stage << ": " << small.at(stage) << " and " << large.at(stage);
  EXPECT_GT(small.at("field"), 1000);
}

// Whatever such a tool has of them, about four times `contact_samples` are asked, or twice as many between
// two levels; and they say the same.
TEST(Growth, ASwallowedToolIsAskedAtFewOfItsSamples) {
  GeometrySettings settings;
  settings.voxel_size_m = 0.004;
  const auto ask = [&](std::uint32_t contact_samples) {
    settings.contact_samples = contact_samples;
    return answer(solids::sphere_of(0.1, 40'000), solids::sphere_of(0.03, 8'000), settings,
                  {Vec3(0.02, 0.03, 0.003), Quat(1, 0, 0, 0)});
  };
  const auto count = [](const Contacts& contacts) {
    std::uint64_t out = 0;
    for (const FieldBin& bin : contacts.field.bins) out += bin.samples;
    return out;
  };
  const Contacts all = ask(0), few = ask(256);
  EXPECT_GT(count(all), 8'000u);
  EXPECT_LT(count(few), 2u * 4 * 256);
  EXPECT_GT(count(few), 4u * 256 / 2);
  const auto area = [](const Contacts& contacts) {
    double out = 0;
    for (const FieldBin& bin : contacts.field.bins) out += static_cast<double>(bin.give);
    return out;
  };
  // A level's factors give each side its area; its sum of normals may be off by a 16th of that where the
  // level is still taken (EXACTNESS section 4).
  EXPECT_NEAR(area(few) / area(all), 1, 1.0 / 16);
}

}  // namespace
}  // namespace palpate
