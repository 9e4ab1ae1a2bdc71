// Bullet's GImpact: quantised box trees over both bodies, built once, and its own triangle test, in single
// precision as Debian builds it. Its contact API would merge and multiply pairs, so tree and test are called
// by themselves.
#include <BulletCollision/CollisionShapes/btTriangleIndexVertexArray.h>
#include <BulletCollision/Gimpact/btGImpactShape.h>
#include <LinearMath/btScalar.h>

#include "bench/peers/bodies.h"
#include "bench/peers/make.h"

namespace palpate::peers {
namespace {

struct Shape {
  std::vector<btScalar> points;
  std::vector<int> indices;
  std::vector<std::uint32_t> ids;
  std::unique_ptr<btTriangleIndexVertexArray> arrays;
  std::unique_ptr<btGImpactMeshShape> shape;

  void load(const LatticeMesh& mesh, double step_m) {
    Body body = body_of(mesh);
    ids = std::move(body.ids);
    points.reserve(mesh.vertices.size() * 3);
    for (const Int3& v : mesh.vertices)
      for (int k = 0; k < 3; ++k) points.push_back(static_cast<btScalar>(step_m * v[k]));
    indices.reserve(body.triangles.size() * 3);
    for (const auto& triangle : body.triangles)
      for (const std::uint32_t i : triangle) indices.push_back(static_cast<int>(i));
    arrays = std::make_unique<btTriangleIndexVertexArray>(
        static_cast<int>(body.triangles.size()), indices.data(), static_cast<int>(3 * sizeof(int)),
        static_cast<int>(mesh.vertices.size()), points.data(), static_cast<int>(3 * sizeof(btScalar)));
    shape = std::make_unique<btGImpactMeshShape>(arrays.get());
    shape->setMargin(0);
    shape->updateBound();
    part()->lockChildShapes();
  }
  btGImpactMeshShapePart* part() const { return shape->getMeshPart(0); }
};

class BulletPeer final : public Peer {
 public:
  std::string name() const override { return "Bullet GImpact"; }
  std::string version() const override {
    return std::to_string(btGetVersion() / 100) + "." + std::to_string(btGetVersion() % 100);
  }

  void build(const SceneGeometry& geometry) override {
    step_m_ = geometry.lattice.step_m;
    mockup_.load(geometry.mockup, step_m_);
    tool_.load(geometry.tool, step_m_);
  }

  void find(const LatticePose& pose, std::vector<TrianglePair>& pairs) override {
    const RigidMotion motion = rigid_motion(pose, step_m_);
    const auto scalar = [](double value) { return static_cast<btScalar>(value); };
    btTransform world_from_tool;
    btMatrix3x3& basis = world_from_tool.getBasis();
    for (int i = 0; i < 3; ++i)
      basis[i].setValue(scalar(motion.rotation[i][0]), scalar(motion.rotation[i][1]),
                        scalar(motion.rotation[i][2]));
    world_from_tool.setOrigin(
        {scalar(motion.translation_m.x), scalar(motion.translation_m.y), scalar(motion.translation_m.z)});

    candidates_.resizeNoInitialize(0);
    btGImpactQuantizedBvh::find_collision(mockup_.part()->getBoxSet(), btTransform::getIdentity(),
                                          tool_.part()->getBoxSet(), world_from_tool, candidates_);
    pairs.clear();
    for (int i = 0; i < candidates_.size(); ++i) {
      const GIM_PAIR& pair = candidates_[i];
      btPrimitiveTriangle s, m;
      mockup_.part()->getPrimitiveTriangle(pair.m_index1, s);
      tool_.part()->getPrimitiveTriangle(pair.m_index2, m);
      m.applyTransform(world_from_tool);
      s.m_margin = m.m_margin = 0;
      s.buildTriPlane();
      m.buildTriPlane();
      GIM_TRIANGLE_CONTACT contact;
      if (s.overlap_test_conservative(m) && s.find_triangle_collision_clip_method(m, contact))
        pairs.emplace_back(mockup_.ids[static_cast<std::size_t>(pair.m_index1)],
                           tool_.ids[static_cast<std::size_t>(pair.m_index2)]);
    }
  }

 private:
  double step_m_ = 0;
  Shape mockup_, tool_;
  btPairSet candidates_;
};

}  // namespace

std::unique_ptr<Peer> make_bullet() { return std::make_unique<BulletPeer>(); }

}  // namespace palpate::peers
