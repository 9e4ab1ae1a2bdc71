// FCL's answers to a planner's questions, with the boxes that suit them: rectangles swept by a ball, alone or
// beside oriented boxes.
#include <fcl/config.h>
#include <fcl/math/bv/OBBRSS.h>
#include <fcl/math/bv/RSS.h>
#include <fcl/narrowphase/collision.h>
#include <fcl/narrowphase/distance.h>

#include <optional>
#include <type_traits>

#include "bench/peers/fcl_model.h"
#include "bench/peers/make.h"

namespace palpate::peers {
namespace {

template <class Box>
class FclQuestions final : public QuestionPeer {
 public:
  explicit FclQuestions(std::string name) : name_(std::move(name)) {}
  std::string name() const override { return name_; }
  std::string version() const override { return FCL_VERSION; }

  void build(const SceneGeometry& geometry) override {
    step_m_ = geometry.lattice.step_m;
    load(geometry.mockup, step_m_, mockup_);
    load(geometry.tool, step_m_, tool_);
  }

  /// With rectangles swept by a ball alone FCL takes a hundred times as long and more: nobody would ask it
  /// so.
  std::optional<bool> touches(const LatticePose& pose) override {
    if constexpr (std::is_same_v<Box, fcl::RSSd>) return std::nullopt;
    const fcl::CollisionRequestd request(1, false);  // ends at the first pair
    fcl::CollisionResultd result;
    fcl::collide<double>(&mockup_, fcl::Transform3d::Identity(), &tool_, world_from_tool(pose, step_m_),
                         request, result);
    return result.isCollision();
  }

  double distance(const LatticePose& pose) override {
    const fcl::DistanceRequestd request(true);  // with the nearest points, as palpate's
    fcl::DistanceResultd result;
    return fcl::distance<double>(&mockup_, fcl::Transform3d::Identity(), &tool_,
                                 world_from_tool(pose, step_m_), request, result);
  }

 private:
  std::string name_;
  double step_m_ = 0;
  fcl::BVHModel<Box> mockup_, tool_;
};

}  // namespace

std::unique_ptr<QuestionPeer> make_fcl_obbrss() {
  return std::make_unique<FclQuestions<fcl::OBBRSSd>>("FCL OBBRSS");
}
std::unique_ptr<QuestionPeer> make_fcl_rss() { return std::make_unique<FclQuestions<fcl::RSSd>>("FCL RSS"); }

}  // namespace palpate::peers
