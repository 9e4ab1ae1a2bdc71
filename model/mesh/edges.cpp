#include "model/mesh/edges.h"

#include <fmt/format.h>
#include <algorithm>
#include <numeric>

#include "model/lattice/triangle.h"
#include "model/mesh/boundary.h"

namespace palpate {
namespace {

/// Most entries of the neighbour lists together (chosen: 4 GiB of them).
constexpr std::uint64_t kMaxNeighbours = std::uint64_t{1} << 30;

std::uint32_t third_vertex(const LatticeMesh& mesh, std::uint32_t triangle, std::uint32_t low,
                           std::uint32_t high) {
  for (const std::uint32_t v : mesh.triangles[triangle])
    if (v != low && v != high) return v;
  return low;  // not reached: a triangle with an edge has three distinct vertices
}

/// Triangles on an edge that repeat another's three vertices. Counted on one of the three edges only: the one
/// between the two lowest vertices.
std::uint32_t count_duplicates(const LatticeMesh& mesh, std::uint32_t low, std::span<const EdgeUse> uses,
                               std::vector<std::uint32_t>& scratch) {
  scratch.clear();
  for (const EdgeUse& use : uses) {
    const std::uint32_t third = third_vertex(mesh, use.triangle, low, use.high_vertex);
    if (third > use.high_vertex) scratch.push_back(third);
  }
  std::sort(scratch.begin(), scratch.end());
  const auto distinct = std::unique(scratch.begin(), scratch.end()) - scratch.begin();
  return static_cast<std::uint32_t>(scratch.size()) - static_cast<std::uint32_t>(distinct);
}

}  // namespace

EdgeTable::EdgeTable(const LatticeMesh& mesh) : begin_(mesh.vertices.size() + 1, 0) {
  const auto each_edge = [&](auto visit) {
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
      const auto& v = mesh.triangles[t];
      if (v[0] == v[1] || v[1] == v[2] || v[2] == v[0]) continue;
      for (std::size_t k = 0; k < 3; ++k) visit(std::minmax(v[k], v[(k + 1) % 3]), t);
    }
  };
  // Count, scan, emit, then sort each vertex's few uses: linear but for that.
  each_edge([&](const auto& edge, std::uint32_t) { ++begin_[edge.first + 1]; });
  std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
  uses_.resize(begin_.back());
  std::vector<std::uint32_t> next(begin_.begin(), begin_.end() - 1);
  each_edge([&](const auto& edge, std::uint32_t t) { uses_[next[edge.first]++] = {edge.second, t}; });
  for (std::size_t v = 0; v + 1 < begin_.size(); ++v)
    std::sort(
        uses_.begin() + begin_[v], uses_.begin() + begin_[v + 1], [](const EdgeUse& a, const EdgeUse& b) {
          return a.high_vertex != b.high_vertex ? a.high_vertex < b.high_vertex : a.triangle < b.triangle;
        });
}

int edge_direction(const LatticeMesh& mesh, std::uint32_t triangle, std::uint32_t low, std::uint32_t high) {
  const auto& v = mesh.triangles[triangle];
  return (v[0] == low && v[1] == high) || (v[1] == low && v[2] == high) || (v[2] == low && v[0] == high) ? 1
                                                                                                         : -1;
}

Result<void> check_crowded_edges(const EdgeTable& edges, const LatticeMesh& mesh) {
  std::size_t most = 0;
  Int3 most_at(0);
  edges.for_each([&](std::uint32_t low, std::span<const EdgeUse> uses) {
    if (uses.size() <= most) return;
    const auto solid = static_cast<std::size_t>(std::count_if(
        uses.begin(), uses.end(), [&](const EdgeUse& use) { return !mesh.collapsed(use.triangle); }));
    if (solid <= most) return;
    most = solid;
    most_at = mesh.vertices[low];
  });
  if (most > kMaxTrianglesOnEdge)
    return bad_value(
        fmt::format("an edge at lattice point ({}, {}, {}) carries {} triangles, the limit is {}", most_at.x,
                    most_at.y, most_at.z, most, kMaxTrianglesOnEdge));
  return {};
}

Result<void> find_neighbours(const EdgeTable& edges, const SmoothAngle& angle, LatticeMesh& mesh) {
  const std::size_t count = mesh.triangles.size();
  std::vector<std::uint32_t> length(count, 0);
  std::uint64_t total = 0;
  std::vector<std::uint32_t> solid;  // the triangles on an edge that did not collapse
  const auto gather = [&](std::span<const EdgeUse> uses) {
    solid.clear();
    for (const EdgeUse& use : uses)
      if (!mesh.collapsed(use.triangle)) solid.push_back(use.triangle);
    return solid.size();
  };
  edges.for_each([&](std::uint32_t, std::span<const EdgeUse> uses) {
    const std::size_t n = gather(uses);
    if (n < 2) return;
    total += n * (n - 1);
    for (const std::uint32_t t : solid) length[t] += static_cast<std::uint32_t>(n) - 1;
  });
  if (total > kMaxNeighbours)
    return bad_value(
        fmt::format("{} pairs of triangles share an edge, the limit is {}", total / 2, kMaxNeighbours / 2));

  mesh.neighbour_begin.assign(count + 1, 0);
  std::partial_sum(length.begin(), length.end(), mesh.neighbour_begin.begin() + 1);
  mesh.neighbours.resize(total);
  std::vector<std::uint32_t>& next = length;  // reused: where each triangle's next neighbour goes
  std::copy(mesh.neighbour_begin.begin(), mesh.neighbour_begin.end() - 1, next.begin());
  std::vector<Long3> normals;
  edges.for_each([&](std::uint32_t, std::span<const EdgeUse> uses) {
    if (gather(uses) < 2) return;
    normals.clear();
    for (const std::uint32_t t : solid) normals.push_back(raw_normal(mesh, t));
    for (std::size_t i = 0; i < solid.size(); ++i)
      for (std::size_t j = i + 1; j < solid.size(); ++j) {
        const std::uint32_t bit = smooth(normals[i], normals[j], angle) ? 1 : 0;
        mesh.neighbours[next[solid[i]]++] = solid[j] * 2 + bit;
        mesh.neighbours[next[solid[j]]++] = solid[i] * 2 + bit;
      }
  });

  // Ascending, and each neighbour once: two triangles may share two or three edges. The smooth entry sorts
  // last and stays.
  std::uint32_t kept = 0;
  for (std::size_t t = 0; t < count; ++t) {
    const std::uint32_t begin = mesh.neighbour_begin[t], end = mesh.neighbour_begin[t + 1];
    std::sort(mesh.neighbours.begin() + begin, mesh.neighbours.begin() + end);
    mesh.neighbour_begin[t] = kept;
    for (std::uint32_t i = begin; i < end; ++i)
      if (i + 1 == end || mesh.neighbours[i] / 2 != mesh.neighbours[i + 1] / 2)
        mesh.neighbours[kept++] = mesh.neighbours[i];
  }
  mesh.neighbour_begin[count] = kept;
  mesh.neighbours.resize(kept);
  return {};
}

void examine_edges(const EdgeTable& edges, double step_m, std::span<const std::uint32_t> part_of,
                   LatticeMesh& mesh, MeshReport& report) {
  Boundary whole;
  std::vector<Boundary> of_part(report.parts.size());
  std::vector<std::uint32_t> scratch;
  std::vector<EdgeUse> solid;
  std::vector<std::pair<std::uint32_t, int>> by_part;  // each triangle's part and direction on this edge
  edges.for_each([&](std::uint32_t low, std::span<const EdgeUse> all_uses) {
    const std::uint32_t high = all_uses.front().high_vertex;
    solid.clear();
    by_part.clear();
    int incidence = 0;
    for (const EdgeUse& use : all_uses) {
      if (mesh.collapsed(use.triangle)) continue;
      solid.push_back(use);
      by_part.emplace_back(part_of[use.triangle], edge_direction(mesh, use.triangle, low, high));
      incidence += by_part.back().second;
    }
    if (incidence != 0) whole.add(mesh, low, high, incidence);
    std::sort(by_part.begin(), by_part.end());
    for (std::size_t i = 0; i < by_part.size();) {
      int sum = 0;
      const std::uint32_t part = by_part[i].first;
      for (; i < by_part.size() && by_part[i].first == part; ++i) sum += by_part[i].second;
      if (sum != 0) of_part[part].add(mesh, low, high, sum);
    }
    if (solid.size() == 1) ++report.open_edges;
    if (solid.size() > 2) ++report.nonmanifold_edges;
    if (solid.size() > 1) report.duplicate += count_duplicates(mesh, low, solid, scratch);
  });
  mesh.closed = whole.cancels(mesh);
  report.largest_gap_m = whole.largest_gap() * step_m;
  for (std::size_t p = 0; p < of_part.size(); ++p) report.parts[p].closed = of_part[p].cancels(mesh);
}

}  // namespace palpate
