#include "service/server/scenes/drawing.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>
#include <unordered_map>
#include <unordered_set>

namespace palpate {
namespace {

struct TripleHash {
  std::size_t operator()(const std::array<std::uint32_t, 3>& t) const {
    std::uint64_t h = 0x9E3779B97F4A7C15ull;
    for (const std::uint32_t v : t) h = (h ^ v) * 0xBF58476D1CE4E5B9ull, h ^= h >> 29;
    return static_cast<std::size_t>(h);
  }
};

/// `point`: where a vertex is.
template <class AnyMesh, class Point>
DrawnMesh clustered(const AnyMesh& mesh, const Point& point_of, const Vec3& low, double cell) {
  DrawnMesh out;
  std::unordered_map<std::uint64_t, std::uint32_t> of_cell;
  std::vector<std::uint32_t> of_vertex(mesh.vertices.size(), UINT32_MAX);
  std::unordered_set<std::array<std::uint32_t, 3>, TripleHash> seen;
  const auto representative = [&](std::uint32_t v) {
    if (of_vertex[v] != UINT32_MAX) return of_vertex[v];
    const Vec3 point = point_of(v);
    std::uint64_t key = 0;
    for (int k = 0; k < 3; ++k)
      key = key << 21 | static_cast<std::uint64_t>(std::clamp((point[k] - low[k]) / cell, 0.0, 2'000'000.0));
    const auto [place, fresh] = of_cell.emplace(key, static_cast<std::uint32_t>(out.vertices.size()));
    if (fresh) out.vertices.push_back(point);
    return of_vertex[v] = place->second;
  };
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    std::array<std::uint32_t, 3> t{};
    for (std::size_t k = 0; k < 3; ++k) t[k] = representative(mesh.triangles[i][k]);
    if (t[0] == t[1] || t[1] == t[2] || t[0] == t[2]) continue;
    auto sorted = t;
    std::sort(sorted.begin(), sorted.end());
    if (!seen.insert(sorted).second) continue;
    out.triangles.push_back(t);
    out.ids.push_back(static_cast<std::uint32_t>(i));
  }
  return out;
}

template <class AnyMesh, class Point>
DrawnMesh reduced_mesh(const AnyMesh& mesh, const Point& point_of, std::size_t most) {
  Vec3 low(INFINITY), high(-INFINITY);
  for (const auto& triangle : mesh.triangles)
    for (const std::uint32_t v : triangle) {
      low = glm::min(low, point_of(v));
      high = glm::max(high, point_of(v));
    }
  const Vec3 size = high - low;
  double cell = std::max({size.x, size.y, size.z}) /
                (2 * std::sqrt(static_cast<double>(std::max<std::size_t>(most, 1))) + 1);
  for (;;) {
    DrawnMesh out = clustered(mesh, point_of, low, cell);
    if (out.triangles.size() <= most || !(cell > 0)) return out;
    cell *= 1.25;
  }
}

}  // namespace

DrawnMesh reduced(const BodyView& body, std::size_t most) {
  return reduced_mesh(
      body.mesh, [&](std::size_t v) { return body.point(v); }, most);
}

DrawnMesh reduced(const Mesh& mesh, std::size_t most) {
  return reduced_mesh(
      mesh, [&](std::size_t v) { return mesh.vertices[v]; }, most);
}

std::optional<std::vector<std::uint32_t>> parse_ids(std::string_view text, std::size_t count,
                                                    std::size_t most) {
  std::vector<std::uint32_t> ids;
  const char* at = text.data();
  const char* end = at + text.size();
  while (at != end) {
    std::uint32_t first = 0, last = 0;
    auto [stop, error] = std::from_chars(at, end, first);
    if (error != std::errc()) return std::nullopt;
    last = first;
    if (stop != end && *stop == '-') {
      const auto [range_stop, range_error] = std::from_chars(stop + 1, end, last);
      if (range_error != std::errc() || last < first) return std::nullopt;
      stop = range_stop;
    }
    if (last >= count || ids.size() + (last - first) >= most) return std::nullopt;
    for (std::uint32_t id = first; id <= last; ++id) ids.push_back(id);
    if (stop == end) return ids;
    if (*stop != ',' || stop + 1 == end) return std::nullopt;
    at = stop + 1;
  }
  return ids;
}

std::optional<std::string> voxel_bytes(const VoxelPartition& partition, VoxelClass wanted, bool tool,
                                       const Vec3& origin_m, double step_m, std::uint32_t most) {
  const Int3 counts = partition.grid.voxels();
  if (partition.classes.size() > UINT32_MAX) return std::nullopt;
  const auto n = std::count(partition.classes.begin(), partition.classes.end(), wanted);
  if (n > most) return std::nullopt;
  std::string out = "PVOX";
  const auto put = [&out](const auto& value) {
    out.append(reinterpret_cast<const char*>(&value), sizeof value);
  };
  put(std::uint32_t{1});
  put(static_cast<std::uint32_t>(wanted));
  put(std::uint32_t{tool ? 1u : 0u});
  for (int k = 0; k < 3; ++k) put(origin_m[k] + step_m * partition.grid.origin[k]);
  put(step_m * partition.grid.size);
  for (int k = 0; k < 3; ++k) put(static_cast<std::uint32_t>(counts[k]));
  put(std::uint32_t{0});
  put(static_cast<std::uint64_t>(n));
  for (std::size_t i = 0; i < partition.classes.size(); ++i)
    if (partition.classes[i] == wanted) put(static_cast<std::uint32_t>(i));
  return out;
}

}  // namespace palpate
