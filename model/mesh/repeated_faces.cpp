#include "model/mesh/repeated_faces.h"

#include <algorithm>
#include <array>
#include <optional>
#include <vector>

namespace palpate {
namespace {

/// A triangle among those with the same three corners.
struct Copied {
  std::uint32_t part, triangle;
  int way;               ///< +1 as the first of them looks, or −1
  bool is_face = false;  ///< there its part has an inside behind it
};

/// +1 where two triangles have the same three corners and look the same way, −1 the other way, else 0.
int copied_way(const std::array<std::uint32_t, 3>& a, const std::array<std::uint32_t, 3>& b) {
  for (std::size_t k = 0; k < 3; ++k) {
    if (b[k] != a[0]) continue;
    const std::uint32_t second = b[(k + 1) % 3], third = b[(k + 2) % 3];
    if (second == a[1] && third == a[2]) return 1;
    if (second == a[2] && third == a[1]) return -1;
  }
  return 0;
}

/// The first face of each way speaks: two that look at each other are faces of bodies side by side. Where all
/// are sheets, the first.
void choose(std::vector<Copied>& copies, LatticeMesh& mesh) {
  const auto is_sheet = [&](const Copied& copy) { return (mesh.flags[copy.triangle] & kTriangleSheet) != 0; };
  std::sort(copies.begin(), copies.end(), [](const Copied& a, const Copied& b) {
    return a.part != b.part ? a.part < b.part : a.triangle < b.triangle;
  });
  bool any_face = false;
  for (std::size_t first = 0, end = 0; first < copies.size(); first = end) {
    int sum = 0;
    for (end = first; end < copies.size() && copies[end].part == copies[first].part; ++end)
      sum += is_sheet(copies[end]) ? 0 : copies[end].way;
    for (std::size_t i = first; i < end; ++i) {
      copies[i].is_face = !is_sheet(copies[i]) && sum * copies[i].way > 0;
      any_face = any_face || copies[i].is_face;
    }
  }
  const bool all_sheets = std::all_of(copies.begin(), copies.end(), is_sheet);
  std::optional<std::uint32_t> speaks[2];  // that way and the other
  for (const Copied& copy : copies) {
    if (copy.is_face != any_face) continue;
    std::optional<std::uint32_t>& of_way = speaks[copy.way > 0 || all_sheets ? 0 : 1];
    of_way = std::min(of_way.value_or(copy.triangle), copy.triangle);
  }
  for (const Copied& copy : copies)
    if (copy.triangle != speaks[0] && copy.triangle != speaks[1])
      mesh.flags[copy.triangle] |= kTriangleRepeated;
}

}  // namespace

void mark_repeated_faces(std::span<const std::uint32_t> part_of, LatticeMesh& mesh) {
  std::vector<Copied> copies;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    copies.clear();
    bool is_first = true;
    for (std::uint32_t i = mesh.neighbour_begin[t]; is_first && i < mesh.neighbour_begin[t + 1]; ++i) {
      const std::uint32_t other = mesh.neighbours[i] / 2;
      const int way = copied_way(mesh.triangles[t], mesh.triangles[other]);
      if (way == 0) continue;
      is_first = t < other;
      copies.push_back({part_of[other], other, way});
    }
    if (copies.empty() || !is_first) continue;
    copies.push_back({part_of[t], t, 1});
    choose(copies, mesh);
  }
}

}  // namespace palpate
