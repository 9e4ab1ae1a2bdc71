// FCL: hierarchies of oriented boxes over both bodies, built once; the tool's turns with it.
#include <fcl/config.h>
#include <fcl/math/bv/OBB.h>
#include <fcl/narrowphase/collision.h>

#include <limits>

#include "bench/peers/fcl_model.h"
#include "bench/peers/make.h"

namespace palpate::peers {
namespace {

using Model = fcl::BVHModel<fcl::OBBd>;

class FclPeer final : public Peer {
 public:
  std::string name() const override { return "FCL OBB"; }
  std::string version() const override { return FCL_VERSION; }

  void build(const SceneGeometry& geometry) override {
    step_m_ = geometry.lattice.step_m;
    mockup_ids_ = load(geometry.mockup, step_m_, mockup_);
    tool_ids_ = load(geometry.tool, step_m_, tool_);
    // Which triangles met is all that is asked for: no points, no normals.
    request_.num_max_contacts = std::numeric_limits<std::size_t>::max();
    request_.enable_contact = false;
  }

  void find(const LatticePose& pose, std::vector<TrianglePair>& pairs) override {
    result_.clear();
    fcl::collide<double>(&mockup_, fcl::Transform3d::Identity(), &tool_, world_from_tool(pose, step_m_),
                         request_, result_);
    pairs.clear();
    for (std::size_t i = 0; i < result_.numContacts(); ++i) {
      const auto& contact = result_.getContact(i);
      pairs.emplace_back(mockup_ids_[static_cast<std::size_t>(contact.b1)],
                         tool_ids_[static_cast<std::size_t>(contact.b2)]);
    }
  }

 private:
  double step_m_ = 0;
  Model mockup_, tool_;
  std::vector<std::uint32_t> mockup_ids_, tool_ids_;
  fcl::CollisionRequestd request_;
  fcl::CollisionResultd result_;
};

}  // namespace

std::unique_ptr<Peer> make_fcl() { return std::make_unique<FclPeer>(); }

}  // namespace palpate::peers
