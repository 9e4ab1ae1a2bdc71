#include "model/mesh/enclosure.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <utility>
#include <vector>

#include "model/lattice/lattice_build.h"
#include "model/mesh/edges.h"
#include "model/mesh/orientation.h"
#include "model/mesh/weld.h"

namespace palpate {
namespace {

constexpr double kStepsAlong = 1 << 22;  ///< of the body's longest side: fine enough to weld what is one
constexpr double kOff = 0x1p-10;         ///< how far off a triangle its sides are asked, by its size (chosen)

/// Leaves out triangles with the same three corners as an earlier one, which would count twice. By triangle:
/// where it, or that one, stands now.
std::vector<std::uint32_t> leave_out_copies(LatticeMesh& mesh, std::vector<std::uint32_t>& part_of) {
  const auto count = static_cast<std::uint32_t>(mesh.triangles.size());
  std::vector<std::pair<std::array<std::uint32_t, 3>, std::uint32_t>> all(count);
  for (std::uint32_t t = 0; t < count; ++t) {
    all[t] = {{mesh.triangles[t][0], mesh.triangles[t][1], mesh.triangles[t][2]}, t};
    std::sort(all[t].first.begin(), all[t].first.end());
  }
  std::sort(all.begin(), all.end());
  std::vector<std::uint32_t> first(count), place(count);
  for (std::uint32_t i = 0; i < count; ++i)
    first[all[i].second] =
        i > 0 && all[i].first == all[i - 1].first ? first[all[i - 1].second] : all[i].second;
  std::uint32_t kept = 0;
  for (std::uint32_t t = 0; t < count; ++t) {
    place[t] = first[t] == t ? kept : place[first[t]];
    if (first[t] != t) continue;
    mesh.triangles[kept] = mesh.triangles[t];
    mesh.flags[kept] = mesh.flags[t];
    part_of[kept++] = part_of[t];
  }
  mesh.triangles.resize(kept);
  mesh.flags.resize(kept);
  part_of.resize(kept);
  return place;
}

}  // namespace

Enclosure::Enclosure(LatticeMesh mesh, std::vector<std::uint32_t> places)
    : mesh_(std::make_unique<LatticeMesh>(std::move(mesh))), winding_(*mesh_), places_(std::move(places)) {}

Result<Enclosure> Enclosure::of(const Mesh& mesh) {
  const Result<Box> box = bounding_box(mesh, "body");
  if (!box) return box.error();
  const Vec3 size = box->size();
  const double longest = std::max({size.x, size.y, size.z, kSmallestExtent});
  Result<LatticeMesh> welded = snap_and_weld(mesh, {longest / kStepsAlong, box->centre()});
  if (!welded) return welded.error();
  std::vector<std::uint32_t> part_of(mesh.triangles.size(), 0);
  for (std::uint32_t p = 0; p < mesh.parts.size(); ++p)
    std::fill_n(part_of.begin() + mesh.parts[p].first_triangle, mesh.parts[p].triangle_count, p);
  std::vector<std::uint32_t> places = leave_out_copies(*welded, part_of);
  orient(EdgeTable(*welded), part_of, *welded);
  return Enclosure(std::move(*welded), std::move(places));
}

double Enclosure::at(std::uint32_t number) const {
  const std::uint32_t triangle = places_[number];
  if (mesh_->collapsed(triangle) || (mesh_->flags[triangle] & kTriangleSheet) != 0) return 0;
  const Vec3 a(mesh_->corner(triangle, 0)), b(mesh_->corner(triangle, 1)), c(mesh_->corner(triangle, 2)),
      middle = (a + b + c) / 3.0, normal = glm::cross(b - a, c - a);
  const Vec3 off = normal * (kOff / std::sqrt(glm::length(normal)));
  const double winding = (winding_.at(middle + off) + winding_.at(middle - off)) / 2;
  return std::abs(winding - std::round(winding));
}

void Enclosure::take_for_sheets(const std::vector<std::uint32_t>& numbers) {
  if (numbers.empty()) return;
  for (const std::uint32_t number : numbers) mesh_->flags[places_[number]] |= kTriangleSheet;
  winding_ = WindingNumber(*mesh_);
}

double Enclosure::area(std::uint32_t number) const {
  const std::uint32_t triangle = places_[number];
  const Vec3 a(mesh_->corner(triangle, 0));
  return glm::length(glm::cross(Vec3(mesh_->corner(triangle, 1)) - a, Vec3(mesh_->corner(triangle, 2)) - a));
}

}  // namespace palpate
