// Embree's collide: trees of boxes over both bodies, the tool's refitted at every pose; it proposes pairs of
// boxes that meet, and triangles are then tested in double precision.
#if PALPATE_EMBREE >= 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif
#include <tbb/task_arena.h>

#include <algorithm>

#include "bench/peers/bodies.h"
#include "bench/peers/make.h"
#include "bench/peers/triangle_pair.h"

namespace palpate::peers {
namespace {

/// A scene of boxes around the triangles of a body at its present place.
struct Boxes {
  std::vector<Vec3> points;  ///< m
  Body body;
  RTCScene scene = nullptr;
  RTCGeometry geometry = nullptr;

  DoubleTriangle triangle(unsigned i) const {
    const auto& [a, b, c] = body.triangles[i];
    return {points[a], points[b], points[c]};
  }

  static void bounds(const RTCBoundsFunctionArguments* arguments) {
    const auto& self = *static_cast<const Boxes*>(arguments->geometryUserPtr);
    const DoubleTriangle t = self.triangle(arguments->primID);
    // Rounded outwards: single precision must not lose a pair.
    const auto down = [](double v) { return std::nextafter(static_cast<float>(v), -INFINITY); };
    const auto up = [](double v) { return std::nextafter(static_cast<float>(v), INFINITY); };
    RTCBounds& out = *arguments->bounds_o;
    out.lower_x = down(std::min({t[0].x, t[1].x, t[2].x}));
    out.lower_y = down(std::min({t[0].y, t[1].y, t[2].y}));
    out.lower_z = down(std::min({t[0].z, t[1].z, t[2].z}));
    out.upper_x = up(std::max({t[0].x, t[1].x, t[2].x}));
    out.upper_y = up(std::max({t[0].y, t[1].y, t[2].y}));
    out.upper_z = up(std::max({t[0].z, t[1].z, t[2].z}));
  }

  void make(RTCDevice device, const LatticeMesh& mesh, double step_m, bool moves) {
    body = body_of(mesh);
    points.reserve(mesh.vertices.size());
    for (const Int3& v : mesh.vertices) points.push_back(step_m * Vec3(v));
    scene = rtcNewScene(device);
    if (moves) {
      rtcSetSceneBuildQuality(scene, RTC_BUILD_QUALITY_LOW);
      rtcSetSceneFlags(scene, RTC_SCENE_FLAG_DYNAMIC);
    }
    geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_USER);
    rtcSetGeometryUserPrimitiveCount(geometry, static_cast<unsigned>(body.triangles.size()));
    rtcSetGeometryUserData(geometry, this);
    rtcSetGeometryBoundsFunction(geometry, &Boxes::bounds, nullptr);
    if (moves) rtcSetGeometryBuildQuality(geometry, RTC_BUILD_QUALITY_REFIT);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene, geometry);
    rtcCommitScene(scene);
  }
  ~Boxes() {
    if (geometry != nullptr) rtcReleaseGeometry(geometry);
    if (scene != nullptr) rtcReleaseScene(scene);
  }
};

class EmbreePeer final : public Peer {
 public:
  EmbreePeer() : device_(rtcNewDevice("threads=1")) {}
  ~EmbreePeer() override {
    mockup_.reset();
    tool_.reset();
    rtcReleaseDevice(device_);
  }
  std::string name() const override { return "Embree collide"; }
  std::string version() const override { return RTC_VERSION_STRING; }

  void build(const SceneGeometry& geometry) override {
    geometry_ = &geometry;
    mockup_ = std::make_unique<Boxes>();
    tool_ = std::make_unique<Boxes>();
    one_thread_.execute([&] {
      mockup_->make(device_, geometry.mockup, geometry.lattice.step_m, false);
      tool_->make(device_, geometry.tool, geometry.lattice.step_m, true);
    });
  }

  void find(const LatticePose& pose, std::vector<TrianglePair>& pairs) override {
    const double step_m = geometry_->lattice.step_m;
    const std::vector<Int3>& vertices = geometry_->tool.vertices;
    for (std::size_t i = 0; i < vertices.size(); ++i)
      tool_->points[i] = step_m * Vec3(transform(pose, vertices[i]));
    pairs.clear();
    pairs_ = &pairs;
    // rtcCollide spreads over all of TBB's threads whatever the device was told; one arena of one thread
    // holds it.
    one_thread_.execute([&] {
      rtcCommitGeometry(tool_->geometry);
      rtcCommitScene(tool_->scene);
      rtcCollide(mockup_->scene, tool_->scene, &EmbreePeer::test, this);
    });
  }

 private:
  static void test(void* user, RTCCollision* collisions, unsigned count) {
    auto& self = *static_cast<EmbreePeer*>(user);
    for (unsigned i = 0; i < count; ++i) {
      const unsigned s = collisions[i].primID0, m = collisions[i].primID1;
      if (triangles_meet(self.mockup_->triangle(s), self.tool_->triangle(m)))
        self.pairs_->emplace_back(self.mockup_->body.ids[s], self.tool_->body.ids[m]);
    }
  }

  tbb::task_arena one_thread_{1};
  RTCDevice device_;
  const SceneGeometry* geometry_ = nullptr;
  std::unique_ptr<Boxes> mockup_, tool_;
  std::vector<TrianglePair>* pairs_ = nullptr;
};

}  // namespace

std::unique_ptr<Peer> make_embree() { return std::make_unique<EmbreePeer>(); }

}  // namespace palpate::peers
