// A back end with a spare: who is asked about what.
#include "service/steady_backend.h"

#include <gtest/gtest.h>

namespace palpate {
namespace {

/// Answers with the scene that it has prepared as the number of pairs; may find every frame too large.
class Teller final : public CollisionBackend {
 public:
  explicit Teller(bool truncates) : truncates_(truncates) {}
  Result<void> prepare(const SceneGeometry& geometry, const Plan&, const Progress&) override {
    scene_ = static_cast<std::uint64_t>(geometry.sample_spacing);
    return {};
  }
  Result<void> query(const LatticePose&, const Held*, Contacts& out) override {
    out = {};
    out.pairs = scene_;
    out.truncated = truncates_;
    out.truncated_capacity = truncates_ ? "something" : "";
    return {};
  }
  Result<VoxelPartition> partition(bool) const override { return VoxelPartition{}; }
  bool has_internal_voxels() const override { return false; }
  std::string name() const override { return truncates_ ? "first" : "spare"; }
  std::string device() const override { return name(); }
  std::uint64_t memory_bytes() const override { return 0; }

 private:
  bool truncates_;
  std::uint64_t scene_ = 0;
};

TEST(SteadyBackend, ANewSceneIsNewToTheSpareToo) {
  // The spare once went on with the scene before, of whose geometry nothing was left.
  SteadyBackend backend(std::make_unique<Teller>(true), [] { return std::make_unique<Teller>(false); });
  Contacts out;
  for (const int scene : {3, 4, 5}) {
    SceneGeometry geometry;
    geometry.sample_spacing = scene;
    ASSERT_TRUE(backend.prepare(geometry, {}, {}));
    ASSERT_TRUE(backend.query({}, nullptr, out));
    EXPECT_FALSE(out.truncated);
    EXPECT_EQ(out.pairs, static_cast<std::uint64_t>(scene));
  }
}

}  // namespace
}  // namespace palpate
