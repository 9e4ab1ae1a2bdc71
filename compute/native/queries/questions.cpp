#include "compute/native/queries/questions.h"

#include <algorithm>
#include <glm/common.hpp>
#include <numeric>

#include "compute/scene/search_tables.h"

namespace palpate::native {
namespace {

constexpr std::size_t kFewCorners =
    64;  // of a part of the tool, of which one is mostly in a voxel that is V_ext (chosen)

std::vector<std::vector<Int3>> parts_of(const LatticeMesh& mesh) {
  std::vector<std::uint32_t> parent(mesh.vertices.size());
  std::iota(parent.begin(), parent.end(), 0u);
  const auto root = [&](std::uint32_t v) {
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
  };
  std::vector<bool> used(mesh.vertices.size());
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    if (mesh.collapsed(t)) continue;
    for (const std::uint32_t v : mesh.triangles[t]) {
      used[v] = true;
      parent[root(v)] = root(mesh.triangles[t][0]);
    }
  }
  std::vector<std::vector<std::uint32_t>> members(mesh.vertices.size());
  for (std::uint32_t v = 0; v < mesh.vertices.size(); ++v)
    if (used[v]) members[root(v)].push_back(v);
  std::vector<std::vector<Int3>> out;
  for (const auto& part : members) {
    if (part.empty()) continue;
    std::vector<Int3>& corners = out.emplace_back();
    const std::size_t step = (part.size() + kFewCorners - 1) / kFewCorners;  // spread over it
    for (std::size_t i = 0; i < part.size(); i += step) corners.push_back(mesh.vertices[part[i]]);
  }
  return out;
}

}  // namespace

Containment::Containment(const SceneGeometry& geometry, const SceneTables& scene)
    : mockup(scene.mockup),
      told_by_corners(geometry.mockup.closed && geometry.tool.closed),
      mockup_has_inside(scene.mockup.has_internal),
      tool_parts(parts_of(geometry.tool)),
      small_parts(scene.search->parts),
      tool_low(geometry.tool.box_min),
      tool_high(geometry.tool.box_max) {}

Result<bool> Questions::by_frame(const LatticePose& pose) {
  if (auto answered = frame_.query(pose, nullptr, contacts_); !answered) return answered.error();
  return contacts_.contact;
}

/// Where no pair meets and none is within kCloseSteps, IMT and EST are of whole parts that are contained: one
/// corner of the tool's in V_ext, where the closed mock-up's winding is 0, tells that none of its part's
/// triangles touches a V_int voxel, where it is not; and a part of the mock-up inside the tool lies in the
/// tool's box. Rounding, of samples and of the tool's own frame, moves no point by kCloseSteps.
bool Questions::surely_outside(const LatticePose& pose) const {
  if (!containment_.told_by_corners) return false;
  if (containment_.mockup_has_inside)
    for (const std::vector<Int3>& part : containment_.tool_parts)
      if (std::none_of(part.begin(), part.end(), [&](const Int3& corner) {
            return containment_.mockup.at(containment_.mockup.voxel_of(transform(pose, corner))).kind ==
                   gpu::kVoxelExternal;
          }))
        return false;
  if (containment_.small_parts.empty()) return true;
  Int3 low(INT32_MAX), high(INT32_MIN);
  for (int corner = 0; corner < 8; ++corner) {
    const Int3 p =
        transform(pose, Int3((corner & 1) != 0 ? containment_.tool_high.x : containment_.tool_low.x,
                             (corner & 2) != 0 ? containment_.tool_high.y : containment_.tool_low.y,
                             (corner & 4) != 0 ? containment_.tool_high.z : containment_.tool_low.z));
    low = glm::min(low, p - 2);
    high = glm::max(high, p + 2);
  }
  return std::none_of(containment_.small_parts.begin(), containment_.small_parts.end(),
                      [&](const auto& part) {
                        return part[0] >= low.x && part[1] >= low.y && part[2] >= low.z &&
                               part[3] <= high.x && part[4] <= high.y && part[5] <= high.z;
                      });
}

Result<bool> Questions::touches(const LatticePose& pose) {
  if (pose.beyond_lattice) return false;
  switch (pairs_.any(pose)) {
    case PairSearch::Found::kMeet:
      return true;
    case PairSearch::Found::kClose:
      return by_frame(pose);
    case PairSearch::Found::kNothing:
      break;
  }
  if (surely_outside(pose)) return false;
  return by_frame(pose);
}

Result<void> Questions::clearance(const LatticePose& pose, std::int32_t within, Clearance& out) {
  out = {};
  if (pose.beyond_lattice) {  // it touches nothing; off the origin it can be measured (LatticePose)
    if (pose.translation != Int3(0)) out = pairs_.nearest(pose, within);
    return {};
  }
  if (pairs_.any(pose) == PairSearch::Found::kMeet) {  // what meets may be deep in, with much to look at
                                                       // before the smallest distance is 0
    out.kind = Clearance::Kind::kTouching;
    return {};
  }
  out = pairs_.nearest(pose, within);
  if (out.kind == Clearance::Kind::kTouching) return {};
  const bool close = out.kind == Clearance::Kind::kApart && out.steps <= PairSearch::kCloseSteps;
  if (!close && surely_outside(pose)) return {};
  const Result<bool> touching = by_frame(pose);
  if (!touching) return touching.error();
  if (*touching) out = {.kind = Clearance::Kind::kTouching};
  return {};
}

}  // namespace palpate::native
