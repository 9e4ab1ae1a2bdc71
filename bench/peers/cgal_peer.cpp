// CGAL: a tree of boxes over the mock-up, built once, and a query for every triangle of the tool, with exact
// predicates.
#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/version.h>

#include "bench/peers/bodies.h"
#include "bench/peers/make.h"

namespace palpate::peers {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Triangles = std::vector<Kernel::Triangle_3>;
using Primitive = CGAL::AABB_triangle_primitive<Kernel, Triangles::const_iterator>;
using Tree = CGAL::AABB_tree<CGAL::AABB_traits<Kernel, Primitive>>;

Kernel::Point_3 point(const Int3& v, double step_m) { return {step_m * v.x, step_m * v.y, step_m * v.z}; }

class CgalPeer final : public Peer {
 public:
  std::string name() const override { return "CGAL exact"; }
  std::string version() const override { return CGAL_VERSION_STR; }

  void build(const SceneGeometry& geometry) override {
    geometry_ = &geometry;
    const double step_m = geometry.lattice.step_m;
    mockup_ids_ = body_of(geometry.mockup).ids;
    tool_ids_ = body_of(geometry.tool).ids;
    mockup_.reserve(mockup_ids_.size());
    for (const std::uint32_t t : mockup_ids_)
      mockup_.emplace_back(point(geometry.mockup.corner(t, 0), step_m),
                           point(geometry.mockup.corner(t, 1), step_m),
                           point(geometry.mockup.corner(t, 2), step_m));
    tree_.insert(mockup_.cbegin(), mockup_.cend());
    tree_.build();
    turned_.reserve(geometry.tool.vertices.size());
  }

  void find(const LatticePose& pose, std::vector<TrianglePair>& pairs) override {
    const double step_m = geometry_->lattice.step_m;
    turned_.clear();
    for (const Int3& v : geometry_->tool.vertices) turned_.push_back(point(transform(pose, v), step_m));
    pairs.clear();
    for (const std::uint32_t t : tool_ids_) {
      const auto& [a, b, c] = geometry_->tool.triangles[t];
      const Kernel::Triangle_3 triangle(turned_[a], turned_[b], turned_[c]);
      if (triangle.is_degenerate()) continue;
      found_.clear();
      tree_.all_intersected_primitives(triangle, std::back_inserter(found_));
      for (const auto& primitive : found_)
        pairs.emplace_back(mockup_ids_[static_cast<std::size_t>(primitive - mockup_.cbegin())], t);
    }
  }

 private:
  const SceneGeometry* geometry_ = nullptr;
  std::vector<std::uint32_t> mockup_ids_, tool_ids_;
  Triangles mockup_;
  Tree tree_;
  std::vector<Kernel::Point_3> turned_;
  std::vector<Triangles::const_iterator> found_;
};

}  // namespace

std::unique_ptr<Peer> make_cgal() { return std::make_unique<CgalPeer>(); }

}  // namespace palpate::peers
