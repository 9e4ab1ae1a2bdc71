// FCL: hierarchies of oriented boxes over both bodies, built once; the tool's turns with it.
#include <fcl/config.h>
#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/math/bv/OBB.h>
#include <fcl/narrowphase/collision.h>

#include <limits>

#include "bench/peers/bodies.h"
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
    mockup_ids_ = load(geometry.mockup, mockup_);
    tool_ids_ = load(geometry.tool, tool_);
    // Which triangles met is all that is asked for: no points, no normals.
    request_.num_max_contacts = std::numeric_limits<std::size_t>::max();
    request_.enable_contact = false;
  }

  void find(const LatticePose& pose, std::vector<TrianglePair>& pairs) override {
    const RigidMotion motion = rigid_motion(pose, step_m_);
    fcl::Transform3d world_from_tool = fcl::Transform3d::Identity();
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) world_from_tool.linear()(i, j) = motion.rotation[i][j];
      world_from_tool.translation()(i) = motion.translation_m[i];
    }
    result_.clear();
    fcl::collide<double>(&mockup_, fcl::Transform3d::Identity(), &tool_, world_from_tool, request_, result_);
    pairs.clear();
    for (std::size_t i = 0; i < result_.numContacts(); ++i) {
      const auto& contact = result_.getContact(i);
      pairs.emplace_back(mockup_ids_[static_cast<std::size_t>(contact.b1)],
                         tool_ids_[static_cast<std::size_t>(contact.b2)]);
    }
  }

 private:
  std::vector<std::uint32_t> load(const LatticeMesh& mesh, Model& model) const {
    Body body = body_of(mesh);
    std::vector<fcl::Vector3d> points;
    points.reserve(mesh.vertices.size());
    for (const Int3& v : mesh.vertices) points.emplace_back(step_m_ * v.x, step_m_ * v.y, step_m_ * v.z);
    std::vector<fcl::Triangle> triangles;
    triangles.reserve(body.triangles.size());
    for (const auto& [a, b, c] : body.triangles) triangles.emplace_back(a, b, c);
    model.beginModel(static_cast<int>(triangles.size()), static_cast<int>(points.size()));
    model.addSubModel(points, triangles);
    model.endModel();
    return std::move(body.ids);
  }

  double step_m_ = 0;
  Model mockup_, tool_;
  std::vector<std::uint32_t> mockup_ids_, tool_ids_;
  fcl::CollisionRequestd request_;
  fcl::CollisionResultd result_;
};

}  // namespace

std::unique_ptr<Peer> make_fcl() { return std::make_unique<FclPeer>(); }

}  // namespace palpate::peers
