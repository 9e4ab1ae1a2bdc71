// The exact pairs, by the reference's boxes and integers: what the others are held against.
#include "bench/peers/make.h"
#include "cpu_ref/box_tree.h"
#include "cpu_ref/triangle_triangle.h"

namespace palpate {
namespace {

using cpu_ref::Box;
using cpu_ref::BoxTree;
using cpu_ref::Triangle;

class Judge final : public Peer {
 public:
  std::string name() const override { return "exact"; }
  std::string version() const override { return "this build"; }

  void build(const SceneGeometry& geometry) override {
    geometry_ = &geometry;
    const LatticeMesh& mesh = geometry.mockup;
    std::vector<Box> boxes(mesh.triangles.size());
    for (std::uint32_t t = 0; t < boxes.size(); ++t)
      if (!mesh.collapsed(t)) boxes[t] = cpu_ref::triangle_of(mesh, t).box();
    mockup_tree_.build(std::move(boxes));
  }

  void find(const LatticePose& pose, std::vector<TrianglePair>& pairs) override {
    const LatticeMesh& mesh = geometry_->tool;
    std::vector<Triangle> tool(mesh.triangles.size());
    std::vector<Box> boxes(tool.size());
    for (std::uint32_t t = 0; t < tool.size(); ++t) {
      if (mesh.collapsed(t)) continue;
      tool[t] = Triangle(transform(pose, mesh.corner(t, 0)), transform(pose, mesh.corner(t, 1)),
                         transform(pose, mesh.corner(t, 2)));
      if (!tool[t].collapsed()) boxes[t] = tool[t].box();
    }
    BoxTree tool_tree;
    tool_tree.build(std::move(boxes));
    std::vector<TrianglePair> candidates;
    BoxTree::meeting_pairs(mockup_tree_, tool_tree, candidates);
    pairs.clear();
    for (const auto& [s, m] : candidates)
      if (cpu_ref::triangles_intersect(cpu_ref::triangle_of(geometry_->mockup, s), tool[m]))
        pairs.emplace_back(s, m);
  }

 private:
  const SceneGeometry* geometry_ = nullptr;
  BoxTree mockup_tree_;
};

}  // namespace

std::unique_ptr<Peer> make_judge() { return std::make_unique<Judge>(); }

}  // namespace palpate
