#include "model/edges.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <numeric>

#include "model/triangle.h"

namespace palpate {
namespace {

/// Most entries of the neighbour lists together (chosen: 4 GiB of them).
constexpr std::uint64_t kMaxNeighbours = std::uint64_t{1} << 30;

std::uint32_t third_vertex(const LatticeMesh& mesh, std::uint32_t triangle, std::uint32_t low, std::uint32_t high) {
  for (const std::uint32_t v : mesh.triangles[triangle])
    if (v != low && v != high) return v;
  return low;   // not reached: a triangle with an edge has three distinct vertices
}

/// Triangles on an edge that repeat another's three vertices. Counted on one of the three edges only: the one between
/// the two lowest vertices.
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

/// Boundary edges gathered into loops: edges that share a vertex belong together.
class Gaps {
 public:
  void add(std::uint32_t low, std::uint32_t high) { edges_.push_back({low, high}); }

  /// The largest diagonal of a loop's bounding box, in steps.
  double largest(const LatticeMesh& mesh) const {
    if (edges_.empty()) return 0;
    std::vector<std::uint32_t> parent(mesh.vertices.size());
    std::iota(parent.begin(), parent.end(), 0u);
    const auto root = [&](std::uint32_t v) {
      while (parent[v] != v) v = parent[v] = parent[parent[v]];
      return v;
    };
    for (const auto& [low, high] : edges_) parent[root(low)] = root(high);
    std::vector<Int3> box_min(mesh.vertices.size(), Int3(std::numeric_limits<std::int32_t>::max()));
    std::vector<Int3> box_max(mesh.vertices.size(), Int3(std::numeric_limits<std::int32_t>::min()));
    double largest = 0;
    for (const auto& edge : edges_) {
      const std::uint32_t loop = root(edge[0]);
      for (const std::uint32_t v : edge) {
        box_min[loop] = glm::min(box_min[loop], mesh.vertices[v]);
        box_max[loop] = glm::max(box_max[loop], mesh.vertices[v]);
      }
      const Vec3 size = Vec3(box_max[loop]) - Vec3(box_min[loop]);
      largest = std::max(largest, std::sqrt(size.x * size.x + size.y * size.y + size.z * size.z));
    }
    return largest;
  }

 private:
  std::vector<std::array<std::uint32_t, 2>> edges_;
};

}  // namespace

EdgeTable::EdgeTable(const LatticeMesh& mesh) : begin_(mesh.vertices.size() + 1, 0) {
  const auto each_edge = [&](auto visit) {
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
      if (mesh.collapsed(t)) continue;
      const auto& v = mesh.triangles[t];
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
    std::sort(uses_.begin() + begin_[v], uses_.begin() + begin_[v + 1], [](const EdgeUse& a, const EdgeUse& b) {
      return a.high_vertex != b.high_vertex ? a.high_vertex < b.high_vertex : a.triangle < b.triangle;
    });
}

int edge_direction(const LatticeMesh& mesh, std::uint32_t triangle, std::uint32_t low, std::uint32_t high) {
  const auto& v = mesh.triangles[triangle];
  return (v[0] == low && v[1] == high) || (v[1] == low && v[2] == high) || (v[2] == low && v[0] == high) ? 1 : -1;
}

Result<void> find_neighbours(const EdgeTable& edges, const SmoothAngle& angle, LatticeMesh& mesh) {
  const std::size_t count = mesh.triangles.size();
  std::vector<std::uint32_t> length(count, 0);
  std::uint64_t total = 0;
  std::size_t most = 0;
  Int3 most_at(0);
  edges.for_each([&](std::uint32_t low, std::span<const EdgeUse> uses) {
    if (uses.size() > most) {
      most = uses.size();
      most_at = mesh.vertices[low];
    }
    total += uses.size() * (uses.size() - 1);
    if (uses.size() <= kMaxTrianglesOnEdge)
      for (const EdgeUse& use : uses) length[use.triangle] += static_cast<std::uint32_t>(uses.size()) - 1;
  });
  if (most > kMaxTrianglesOnEdge)
    return bad_value(fmt::format("an edge at lattice point ({}, {}, {}) carries {} triangles, the limit is {}", most_at.x, most_at.y,
                                 most_at.z, most, kMaxTrianglesOnEdge));
  if (total > kMaxNeighbours)
    return bad_value(fmt::format("{} pairs of triangles share an edge, the limit is {}", total / 2, kMaxNeighbours / 2));

  mesh.neighbour_begin.assign(count + 1, 0);
  std::partial_sum(length.begin(), length.end(), mesh.neighbour_begin.begin() + 1);
  mesh.neighbours.resize(total);
  std::vector<std::uint32_t>& next = length;   // reused: where each triangle's next neighbour goes
  std::copy(mesh.neighbour_begin.begin(), mesh.neighbour_begin.end() - 1, next.begin());
  std::vector<Long3> normals;
  edges.for_each([&](std::uint32_t, std::span<const EdgeUse> uses) {
    if (uses.size() < 2) return;
    normals.clear();
    for (const EdgeUse& use : uses) normals.push_back(raw_normal(mesh, use.triangle));
    for (std::size_t i = 0; i < uses.size(); ++i)
      for (std::size_t j = i + 1; j < uses.size(); ++j) {
        const std::uint32_t bit = smooth(normals[i], normals[j], angle) ? 1 : 0;
        mesh.neighbours[next[uses[i].triangle]++] = uses[j].triangle * 2 + bit;
        mesh.neighbours[next[uses[j].triangle]++] = uses[i].triangle * 2 + bit;
      }
  });

  // Ascending, and each neighbour once: two triangles may share two or three edges. The smooth entry sorts last and stays.
  std::uint32_t kept = 0;
  for (std::size_t t = 0; t < count; ++t) {
    const std::uint32_t begin = mesh.neighbour_begin[t], end = mesh.neighbour_begin[t + 1];
    std::sort(mesh.neighbours.begin() + begin, mesh.neighbours.begin() + end);
    mesh.neighbour_begin[t] = kept;
    for (std::uint32_t i = begin; i < end; ++i)
      if (i + 1 == end || mesh.neighbours[i] / 2 != mesh.neighbours[i + 1] / 2) mesh.neighbours[kept++] = mesh.neighbours[i];
  }
  mesh.neighbour_begin[count] = kept;
  mesh.neighbours.resize(kept);
  return {};
}

void examine_edges(const EdgeTable& edges, double step_m, std::span<const std::uint32_t> part_of, LatticeMesh& mesh,
                   MeshReport& report) {
  mesh.closed = true;
  for (auto& part : report.parts) part.closed = true;
  Gaps gaps;
  std::vector<std::uint32_t> scratch;
  std::vector<std::pair<std::uint32_t, int>> by_part;   // signed incidence of each part on this edge
  edges.for_each([&](std::uint32_t low, std::span<const EdgeUse> uses) {
    const std::uint32_t high = uses.front().high_vertex;
    int incidence = 0;
    by_part.clear();
    for (const EdgeUse& use : uses) {
      const int sign = edge_direction(mesh, use.triangle, low, high);
      incidence += sign;
      by_part.emplace_back(part_of[use.triangle], sign);
    }
    std::sort(by_part.begin(), by_part.end());
    for (std::size_t i = 0; i < by_part.size();) {
      int sum = 0;
      const std::uint32_t part = by_part[i].first;
      for (; i < by_part.size() && by_part[i].first == part; ++i) sum += by_part[i].second;
      if (sum != 0) report.parts[part].closed = false;
    }
    if (incidence != 0) {
      mesh.closed = false;
      gaps.add(low, high);
    }
    if (uses.size() == 1) ++report.open_edges;
    if (uses.size() > 2) ++report.nonmanifold_edges;
    if (uses.size() > 1) report.duplicate += count_duplicates(mesh, low, uses, scratch);
  });
  report.largest_gap_m = gaps.largest(mesh) * step_m;
}

}  // namespace palpate
