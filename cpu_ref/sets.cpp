#include "cpu_ref/sets.h"

#include <algorithm>
#include <iterator>

#include "cpu_ref/depth.h"
#include "cpu_ref/ray.h"
#include "cpu_ref/samples.h"
#include "cpu_ref/touched_voxels.h"
#include "cpu_ref/triangle_triangle.h"

namespace palpate::cpu_ref {
namespace {

template <class T>
void sort_unique(std::vector<T>& list) {
  std::sort(list.begin(), list.end());
  list.erase(std::unique(list.begin(), list.end()), list.end());
}

template <class T>
bool has(const std::vector<T>& ascending, const T& value) {
  return std::binary_search(ascending.begin(), ascending.end(), value);
}

std::vector<std::uint32_t> all_of(std::initializer_list<const std::vector<std::uint32_t>*> sets) {
  std::vector<std::uint32_t> result;
  for (const auto* set : sets) result.insert(result.end(), set->begin(), set->end());
  sort_unique(result);
  return result;
}

}  // namespace

Int3 to_tool(const LatticePose& pose, const Int3& point) {
  const Long3 from = difference(point, pose.translation);
  Int3 result;
  for (int c = 0; c < 3; ++c) {
    const std::int64_t sum = pose.rotation_q30[0][c] * from.x + pose.rotation_q30[1][c] * from.y +
                             pose.rotation_q30[2][c] * from.z;
    result[c] = static_cast<std::int32_t>((sum + (std::int64_t{1} << 29)) >> 30);
  }
  return result;
}

std::vector<Box> transform_tool(Frame& frame) {
  const LatticeMesh& mesh = frame.tool_mesh();
  for (const Int3& vertex : mesh.vertices) frame.vertices.push_back(transform(frame.pose, vertex));
  std::vector<Box> boxes;
  for (std::uint32_t m = 0; m < mesh.triangles.size(); ++m) {
    const auto& [a, b, c] = mesh.triangles[m];
    Triangle triangle(frame.vertices[a], frame.vertices[b], frame.vertices[c]);
    if (mesh.collapsed(m)) triangle = Triangle();
    Box box;  // empty: never found
    if (!triangle.collapsed()) {
      box = triangle.box();
      frame.tool_box.include(box.min);
      frame.tool_box.include(box.max);
    }
    frame.tool.push_back(triangle);
    boxes.push_back(box);
  }
  return boxes;
}

void find_pairs(Frame& frame, Contacts& out) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> candidates;
  BoxTree::meeting_pairs(frame.scene.mockup_tree, frame.tool_tree, candidates);
  for (const auto& [s, m] : candidates)
    if (triangles_intersect(triangle_of(frame.mockup(), s), frame.tool[m])) frame.pairs.emplace_back(s, m);
  out.pairs = frame.pairs.size();
  for (const auto& [s, m] : frame.pairs) {
    out.cst.push_back(s);
    out.cmt.push_back(m);
  }
  sort_unique(out.cst);
  sort_unique(out.cmt);
}

void find_voxel_sets(Frame& frame, Contacts& out) {
  const Partition& partition = frame.scene.mockup;
  for (std::uint32_t m = 0; m < frame.tool.size(); ++m) {
    if (frame.tool[m].collapsed()) continue;
    bool touches_boundary = false, touches_internal = false;
    for_each_touched_voxel(
        frame.tool[m], partition.grid, 0,
        [&](const Int3& begin, const Int3& end) { return !partition.block_is_external(begin, end); },
        [&](const Int3& voxel) {
          const std::uint64_t number = partition.number(voxel);
          const VoxelClass voxel_class = partition.classes.at(voxel);
          if (voxel_class == VoxelClass::kBoundary) {
            touches_boundary = true;
            frame.touched_boundary.push_back(number);
          } else if (voxel_class == VoxelClass::kInternal) {
            touches_internal = true;
            frame.touched_internal.push_back(number);
          }
        });
    if (has(out.cmt, m)) continue;
    if (touches_internal)
      out.imt.push_back(m);
    else if (touches_boundary)
      out.bmt.push_back(m);
  }
  sort_unique(frame.touched_boundary);
  sort_unique(frame.touched_internal);

  for (const std::uint64_t voxel : frame.touched_boundary)
    for (const std::uint32_t s : partition.listed(voxel))
      if (!has(out.cst, s)) out.bst.push_back(s);
  sort_unique(out.bst);
}

bool inside_tool(const Frame& frame, const Int3& point) {
  const Int3 own = to_tool(frame.pose, point);
  const VoxelClass voxel_class = frame.scene.tool.class_of(own);
  if (voxel_class != VoxelClass::kBoundary) return voxel_class == VoxelClass::kInternal;
  if (!frame.tool_mesh().closed) return frame.open_tool.inside(own);
  // The two frames round differently near the surface: the transformed mesh itself decides.
  std::vector<std::uint32_t> candidates;
  const Int3 along_x(1, 0, 0);
  frame.tool_tree.along_ray(point, along_x, candidates);
  int winding = 0;
  for (const std::uint32_t m : candidates)
    if (const auto crossing = ray_crosses(point, along_x, frame.tool[m])) winding += crossing->sign;
  return winding != 0;
}

void find_samples(Frame& frame, Contacts& out) {
  if (frame.scene.refined() && frame.scene.tool_has_inside) {
    // V_int voxels of an open tool may stand out of its triangles' box: they lie in the hull of V_bnd voxels,
    // and a point of such a voxel is within √3 (V + 6) of a triangle.
    const Int3 margin(2 * frame.scene.geometry->tool_grid.size + 20);
    const Box reach{frame.tool_box.min - margin, frame.tool_box.max + margin};
    std::vector<std::uint32_t> near;
    frame.scene.mockup_tree.meeting(reach, near);
    for (const std::uint32_t s : near) {
      if (frame.mockup().collapsed(s)) continue;
      const std::size_t before = frame.counting.size();
      for_each_sample(frame.mockup(), s, frame.scene.geometry->sample_spacing, reach, [&](const Int3& point) {
        if (inside_tool(frame, point)) frame.counting.push_back({s, point});
      });
      // A triangle that crosses nothing is wholly inside or wholly outside: one corner tells, where it has no
      // sample.
      const bool inside = frame.counting.size() > before || inside_tool(frame, frame.mockup().corner(s, 0));
      if (inside && !has(out.cst, s)) out.est.push_back(s);
    }
  }
  frame.contact_static = all_of({&out.cst, &out.bst, &out.est});
  frame.contact_mobile = all_of({&out.cmt, &out.bmt, &out.imt});
  out.contact = !out.cst.empty() || !out.imt.empty() || !out.est.empty();
}

}  // namespace palpate::cpu_ref
