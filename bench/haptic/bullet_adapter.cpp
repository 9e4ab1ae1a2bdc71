#include "bench/haptic/bullet_adapter.h"

#include <BulletCollision/BroadphaseCollision/btDbvtBroadphase.h>
#include <BulletCollision/CollisionDispatch/btCollisionDispatcher.h>
#include <BulletCollision/CollisionDispatch/btCollisionObject.h>
#include <BulletCollision/CollisionDispatch/btCollisionWorld.h>
#include <BulletCollision/CollisionDispatch/btDefaultCollisionConfiguration.h>
#include <BulletCollision/CollisionShapes/btTriangleIndexVertexArray.h>
#include <BulletCollision/Gimpact/btGImpactCollisionAlgorithm.h>
#include <BulletCollision/Gimpact/btGImpactShape.h>

namespace yardstick {
namespace {

btVector3 vector_of(const Vec3& v) {
  return {static_cast<btScalar>(v.x), static_cast<btScalar>(v.y), static_cast<btScalar>(v.z)};
}
Vec3 vector_of(const btVector3& v) { return {v.x(), v.y(), v.z()}; }

struct Body {
  std::vector<btScalar> points;
  std::vector<int> indices;
  std::unique_ptr<btTriangleIndexVertexArray> arrays;
  std::unique_ptr<btGImpactMeshShape> shape;
  btCollisionObject object;

  void load(const TriMesh& mesh) {
    for (const Vec3& v : mesh.vertices)
      for (int k = 0; k < 3; ++k) points.push_back(static_cast<btScalar>(v[k]));
    for (const auto& t : mesh.triangles)
      for (const std::uint32_t i : t) indices.push_back(static_cast<int>(i));
    arrays = std::make_unique<btTriangleIndexVertexArray>(
        static_cast<int>(mesh.triangles.size()), indices.data(), static_cast<int>(3 * sizeof(int)),
        static_cast<int>(mesh.vertices.size()), points.data(), static_cast<int>(3 * sizeof(btScalar)));
    shape = std::make_unique<btGImpactMeshShape>(arrays.get());
    shape->setMargin(0);
    shape->updateBound();
    object.setCollisionShape(shape.get());
  }
};

/// Takes every point that Bullet finds between the two.
struct Collector final : btCollisionWorld::ContactResultCallback {
  const btCollisionObject* tool;
  std::vector<ContactSpring>* out;

  btScalar addSingleResult(btManifoldPoint& point, const btCollisionObjectWrapper* first, int, int,
                           const btCollisionObjectWrapper*, int, int) override {
    const double depth = -static_cast<double>(point.getDistance());
    // The normal points from the second body to the first.
    const double sign = first->getCollisionObject() == tool ? 1 : -1;
    const Vec3 normal = sign * vector_of(point.m_normalWorldOnB);
    if (depth > 0) out->push_back({vector_of(point.getPositionWorldOnB()), normal, depth});
    return 0;
  }
};

class Bullet final : public PenaltyAdapter {
 public:
  Bullet() : dispatcher_(&configuration_), world_(&dispatcher_, &broad_phase_, &configuration_) {
    // contactPairTest asks the table of closest points, into which GImpact's own registration puts nothing.
    dispatcher_.registerClosestPointsCreateFunc(GIMPACT_SHAPE_PROXYTYPE, GIMPACT_SHAPE_PROXYTYPE, &gimpact_);
  }

  std::string name() const override { return "Bullet"; }
  std::string version() const override {
    return std::to_string(btGetVersion() / 100) + "." + std::to_string(btGetVersion() % 100) +
           ", GImpact, all contact points";
  }

 protected:
  void build(const Case& subject) override {
    fixed_.load(subject.fixed);
    tool_.load(subject.tool);
  }

  void find(const Pose& tool, std::vector<ContactSpring>& out) override {
    out.clear();
    btTransform place;
    const glm::dmat3 turn = glm::mat3_cast(tool.rotation);
    for (int i = 0; i < 3; ++i)
      place.getBasis()[i].setValue(static_cast<btScalar>(turn[0][i]), static_cast<btScalar>(turn[1][i]),
                                   static_cast<btScalar>(turn[2][i]));
    place.setOrigin(vector_of(tool.position));
    tool_.object.setWorldTransform(place);
    Collector collector;
    collector.tool = &tool_.object;
    collector.out = &out;
    world_.contactPairTest(&tool_.object, &fixed_.object, collector);
  }

  double spring_stiffness(double hand, std::size_t) const override { return hand; }

 private:
  btGImpactCollisionAlgorithm::CreateFunc gimpact_;
  btDefaultCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_;
  btDbvtBroadphase broad_phase_;
  btCollisionWorld world_;
  Body fixed_, tool_;
};

}  // namespace

std::unique_ptr<Adapter> make_bullet() { return std::make_unique<Bullet>(); }

}  // namespace yardstick
