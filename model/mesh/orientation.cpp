#include "model/mesh/orientation.h"

#include <algorithm>
#include <utility>

namespace palpate {
namespace {

/// Triangles joined into shells; each remembers whether it must be turned to agree with its root.
class Agreement {
 public:
  explicit Agreement(std::size_t count) : parent_(count), differs_(count, 0), contradicts_(count, 0) {
    for (std::uint32_t i = 0; i < count; ++i) parent_[i] = i;
  }

  /// The root of a triangle, and whether the triangle disagrees with it. Halves paths as it goes.
  std::pair<std::uint32_t, bool> find(std::uint32_t t) {
    bool differs = false;
    while (parent_[t] != t) {
      const std::uint32_t up = parent_[t];
      differs_[t] = static_cast<std::uint8_t>(differs_[t] ^ differs_[up]);  // a root's own entry is 0
      parent_[t] = parent_[up];
      differs ^= differs_[t] != 0;
      t = parent_[t];
    }
    return {t, differs};
  }

  void join(std::uint32_t a, std::uint32_t b, bool differ) {
    auto [root_a, a_differs] = find(a);
    auto [root_b, b_differs] = find(b);
    if (root_a == root_b) {
      if ((a_differs != b_differs) != differ) contradicts_[root_a] = 1;
      return;
    }
    if (root_b < root_a) std::swap(root_a, root_b);  // the smallest triangle is the root: it stays as given
    parent_[root_b] = root_a;
    differs_[root_b] = static_cast<std::uint8_t>(a_differs ^ b_differs ^ differ);
    contradicts_[root_a] = static_cast<std::uint8_t>(contradicts_[root_a] | contradicts_[root_b]);
  }

  bool contradicts(std::uint32_t root) const { return contradicts_[root] != 0; }

 private:
  std::vector<std::uint32_t> parent_;
  std::vector<std::uint8_t> differs_, contradicts_;
};

void turn(LatticeMesh& mesh, std::uint32_t triangle) {
  std::swap(mesh.triangles[triangle][1], mesh.triangles[triangle][2]);
  mesh.flags[triangle] ^= kTriangleTurned;
}

/// Gathers the shells and makes each consistent with its first triangle.
Orientation make_shells(const EdgeTable& edges, std::span<const std::uint32_t> part_of, LatticeMesh& mesh) {
  const std::uint32_t count = static_cast<std::uint32_t>(mesh.triangles.size());
  Agreement agreement(count);
  std::vector<std::uint32_t> crowd;  // triangles on an edge of several parts, by part
  edges.for_each([&](std::uint32_t low, std::span<const EdgeUse> uses) {
    const std::uint32_t high = uses[0].high_vertex;
    const auto join = [&](std::uint32_t a, std::uint32_t b) {
      agreement.join(a, b, edge_direction(mesh, a, low, high) == edge_direction(mesh, b, low, high));
    };
    if (uses.size() == 2) join(uses[0].triangle, uses[1].triangle);
    if (uses.size() <= 2) return;
    crowd.clear();
    for (const EdgeUse& use : uses) crowd.push_back(use.triangle);
    std::stable_sort(crowd.begin(), crowd.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return part_of[a] < part_of[b]; });
    for (std::size_t i = 0; i < crowd.size();) {
      std::size_t end = i + 1;
      while (end < crowd.size() && part_of[crowd[end]] == part_of[crowd[i]]) ++end;
      if (end - i == 2) join(crowd[i], crowd[i + 1]);
      i = end;
    }
  });
  Orientation out;
  out.shell_of.assign(count, kNoShell);
  for (std::uint32_t t = 0; t < count; ++t) {
    const auto& v = mesh.triangles[t];
    if (v[0] == v[1] || v[1] == v[2] || v[2] == v[0]) continue;
    const auto [root, differs] = agreement.find(t);
    if (root == t) {  // the smallest triangle of its shell, so it comes first
      out.shell_of[t] = static_cast<std::uint32_t>(out.shells.size());
      out.shells.push_back({.first_triangle = t, .orientable = !agreement.contradicts(t)});
    } else {
      out.shell_of[t] = out.shell_of[root];
    }
    Shell& shell = out.shells[out.shell_of[t]];
    if (!mesh.collapsed(t)) ++shell.triangles;
    if (differs && shell.orientable) {
      turn(mesh, t);
      ++shell.disagreeing;
    }
  }
  return out;
}

struct Votes {
  std::uint32_t right = 0, sheet = 0, inside_out = 0;
};

/// Asks evenly strided triangles of every shell what lies on their two sides.
std::vector<Votes> vote(const Orientation& orientation, const LatticeMesh& mesh) {
  std::vector<std::uint32_t> seen(orientation.shells.size(), 0), voters, shell_of_voter;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const std::uint32_t s = orientation.shell_of[t];
    if (s == kNoShell || mesh.collapsed(t)) continue;
    // Triangle number i of n votes when it is the first with its value of floor(i · rays / n).
    const std::uint64_t n = orientation.shells[s].triangles,
                        rays = std::min<std::uint64_t>(n, kOrientationRays), i = seen[s]++;
    if (i > 0 && i * rays / n == (i - 1) * rays / n) continue;
    voters.push_back(t);
    shell_of_voter.push_back(s);
  }
  const std::vector<SideWinding> windings = side_windings(mesh, voters);
  std::vector<Votes> votes(orientation.shells.size());
  for (std::size_t i = 0; i < voters.size(); ++i) {
    Votes& shell = votes[shell_of_voter[i]];
    const bool outside_in_front = windings[i].normal_side == 0, outside_behind = windings[i].back_side == 0;
    if (outside_in_front && outside_behind) ++shell.sheet;
    if (outside_in_front && !outside_behind) ++shell.right;
    if (!outside_in_front && outside_behind) ++shell.inside_out;
  }
  return votes;
}

}  // namespace

Orientation orient(const EdgeTable& edges, std::span<const std::uint32_t> part_of, LatticeMesh& mesh) {
  Orientation out = make_shells(edges, part_of, mesh);
  const std::vector<Votes> votes = vote(out, mesh);
  for (std::size_t s = 0; s < out.shells.size(); ++s) {
    // Majority; a tie goes to what changes least: right, then sheet, then inside out.
    const Votes& v = votes[s];
    Shell& shell = out.shells[s];
    shell.sheet = v.sheet > v.right && v.sheet >= v.inside_out;
    shell.turned = shell.orientable && v.inside_out > v.right && v.inside_out > v.sheet;
  }
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    if (out.shell_of[t] == kNoShell) continue;
    const Shell& shell = out.shells[out.shell_of[t]];
    if (shell.turned) turn(mesh, t);
    if (shell.sheet) mesh.flags[t] |= kTriangleSheet;
  }
  return out;
}

bool has_faces(const LatticeMesh& mesh) {
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
    if (!mesh.collapsed(t) && (mesh.flags[t] & kTriangleSheet) == 0) return true;
  return false;
}

}  // namespace palpate
