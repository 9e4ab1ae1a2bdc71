#include "bench/haptic/vps.h"

#include <cmath>

#include "bench/haptic/voxel_map.h"

namespace yardstick {
namespace {

constexpr int kVoxelsAcross = 512;
constexpr std::size_t kPoints = 100000;

struct ShellPoint {
  Vec3 place, inward;
};

/// Point n of N lies where n + ½ N-ths of the area are passed, at a place in that triangle that the golden
/// ratio's plane sequence gives.
std::vector<ShellPoint> shell_of(const TriMesh& mesh, std::size_t count) {
  std::vector<double> passed;
  double area = 0;
  const auto doubled = [&](std::size_t t) {
    const auto& i = mesh.triangles[t];
    return glm::cross(mesh.vertices[i[1]] - mesh.vertices[i[0]], mesh.vertices[i[2]] - mesh.vertices[i[0]]);
  };
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) passed.push_back(area += glm::length(doubled(t)));
  std::vector<ShellPoint> out;
  std::size_t t = 0;
  for (std::size_t n = 0; n < count; ++n) {
    const auto number = static_cast<double>(n);
    while (passed[t] < (number + 0.5) / static_cast<double>(count) * area) ++t;
    double u = std::fmod(number * 0.7548776662466927, 1.0), v = std::fmod(number * 0.5698402909980532, 1.0);
    if (u + v > 1) {
      u = 1 - u;
      v = 1 - v;
    }
    const auto& i = mesh.triangles[t];
    const Vec3 &a = mesh.vertices[i[0]], &b = mesh.vertices[i[1]], &c = mesh.vertices[i[2]];
    out.push_back({a + u * (b - a) + v * (c - a), -glm::normalize(doubled(t))});
  }
  return out;
}

class Vps final : public PenaltyAdapter {
 public:
  std::string name() const override { return "VPS"; }
  std::string version() const override { return "own, 100,000 points, 512 voxels across"; }

 protected:
  void build(const Case& subject) override {
    map_.build(subject.fixed, kVoxelsAcross);
    shell_ = shell_of(subject.tool, kPoints);
  }

  void find(const Pose& tool, std::vector<ContactSpring>& out) override {
    out.clear();
    const glm::dmat3 turn = glm::mat3_cast(tool.rotation);
    for (const ShellPoint& point : shell_) {
      const Vec3 place = turn * point.place + tool.position;
      Vec3 centre(0);
      const std::uint8_t value = map_.at(place, centre);
      if (value == 0) continue;
      const Vec3 inward = turn * point.inward;
      const double depth = glm::dot(centre - place, inward) + (value - 1) * map_.size();
      if (depth > 0) out.push_back({place, inward, depth});
    }
  }

  double spring_stiffness(double hand, std::size_t count) const override {
    return count < 10 ? hand : hand * 10 / static_cast<double>(count);
  }

 private:
  VoxelMap map_;
  std::vector<ShellPoint> shell_;
};

}  // namespace

std::unique_ptr<Adapter> make_vps() { return std::make_unique<Vps>(); }

}  // namespace yardstick
