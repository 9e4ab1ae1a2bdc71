#include "model/generate/solids.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <numeric>
#include <tuple>
#include <utility>

#include "model/generate/turn.h"

namespace palpate::solids {
namespace {

std::uint32_t index_of(std::size_t i) { return static_cast<std::uint32_t>(i); }

void one_part(Mesh& mesh) { mesh.parts = {{"", 0, index_of(mesh.triangles.size())}}; }

Vec3 mean_of(const Loop& loop) {
  Vec3 sum(0);
  for (const Vec3& p : loop) sum += p;
  return sum / static_cast<double>(loop.size());
}

/// The point i of n on the way from `from` to `to`; bit-equal to the ends at the ends.
double between(double from, double to, std::uint32_t i, std::uint32_t n) {
  if (i == n) return to;
  return from + (to - from) * (static_cast<double>(i) / static_cast<double>(n));
}

}  // namespace

Mesh loft(const std::vector<Loop>& loops, Ends ends) {
  Mesh mesh;
  const std::size_t size = loops.front().size();
  const std::size_t strips = ends == Ends::kJoined ? loops.size() : loops.size() - 1;
  mesh.vertices.reserve(loops.size() * size + 2);
  mesh.triangles.reserve(2 * size * (strips + 1));
  for (const Loop& loop : loops) mesh.vertices.insert(mesh.vertices.end(), loop.begin(), loop.end());

  for (std::size_t i = 0; i < strips; ++i) {
    const std::size_t here = i * size;
    const std::size_t there = (i + 1) % loops.size() * size;
    for (std::size_t j = 0; j < size; ++j) {
      const std::size_t next = (j + 1) % size;
      const std::uint32_t a = index_of(here + j), b = index_of(here + next);
      const std::uint32_t c = index_of(there + next), d = index_of(there + j);
      mesh.triangles.push_back({a, b, c});
      mesh.triangles.push_back({a, c, d});
    }
  }
  if (ends == Ends::kPoints) {
    const std::uint32_t first = index_of(mesh.vertices.size());
    mesh.vertices.push_back(mean_of(loops.front()));
    mesh.vertices.push_back(mean_of(loops.back()));
    const std::size_t last = (loops.size() - 1) * size;
    for (std::size_t j = 0; j < size; ++j)
      mesh.triangles.push_back({first, index_of((j + 1) % size), index_of(j)});
    for (std::size_t j = 0; j < size; ++j)
      mesh.triangles.push_back({first + 1, index_of(last + j), index_of(last + (j + 1) % size)});
  }
  one_part(mesh);
  return mesh;
}

Mesh box(const Vec3& min, const Vec3& max, const Int3& cells) {
  Mesh mesh;
  std::uint32_t n[3];
  for (int k = 0; k < 3; ++k) n[k] = static_cast<std::uint32_t>(std::max(1, cells[k]));
  for (int axis = 0; axis < 3; ++axis) {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    for (int side = 0; side < 2; ++side) {
      const std::uint32_t first = index_of(mesh.vertices.size());
      for (std::uint32_t j = 0; j <= n[v]; ++j)
        for (std::uint32_t i = 0; i <= n[u]; ++i) {
          Vec3 p;
          p[axis] = side == 0 ? min[axis] : max[axis];
          p[u] = between(min[u], max[u], i, n[u]);
          p[v] = between(min[v], max[v], j, n[v]);
          mesh.vertices.push_back(p);
        }
      for (std::uint32_t j = 0; j < n[v]; ++j)
        for (std::uint32_t i = 0; i < n[u]; ++i) {
          const std::uint32_t a = first + j * (n[u] + 1) + i, b = a + 1, d = a + n[u] + 1, c = d + 1;
          if (side == 1) {
            mesh.triangles.push_back({a, b, c});
            mesh.triangles.push_back({a, c, d});
          } else {
            mesh.triangles.push_back({a, c, b});
            mesh.triangles.push_back({a, d, c});
          }
        }
    }
  }
  one_part(mesh);
  return mesh;
}

Mesh revolve(const std::vector<std::pair<double, double>>& profile, std::uint32_t segments, Ends ends) {
  segments = std::max(3u, segments);
  std::vector<Turn> turns;
  for (std::uint32_t j = 0; j < segments; ++j) turns.push_back(turn_by(static_cast<double>(j) / segments));
  std::vector<Loop> loops;
  loops.reserve(profile.size());
  for (const auto& [r, z] : profile) {
    Loop loop;
    loop.reserve(segments);
    for (const Turn& t : turns) loop.emplace_back(r * t.cos, r * t.sin, z);
    loops.push_back(std::move(loop));
  }
  Mesh mesh = loft(loops, ends);
  if (ends ==
      Ends::kPoints) {  // the fans' centres lie on the axis, whatever the mean of the cosines rounds to
    mesh.vertices[mesh.vertices.size() - 2] = {0, 0, profile.front().second};
    mesh.vertices.back() = {0, 0, profile.back().second};
  }
  return mesh;
}

Mesh sphere(double radius, std::uint32_t segments, std::uint32_t rings) {
  rings = std::max(2u, rings);
  std::vector<std::pair<double, double>> profile;
  for (std::uint32_t i = 1; i < rings; ++i) {
    const Turn t = turn_by(-0.25 + 0.5 * i / rings);
    profile.emplace_back(radius * t.cos, radius * t.sin);
  }
  Mesh mesh = revolve(profile, segments, Ends::kPoints);
  mesh.vertices[mesh.vertices.size() - 2] = {0, 0, -radius};
  mesh.vertices.back() = {0, 0, radius};
  return mesh;
}

Mesh sphere_of(double radius, std::uint64_t triangles) {
  // segments = 2·rings makes the cells near the equator square: 4·r² − 4·r triangles.
  const double rings = 0.5 + std::sqrt(0.25 + static_cast<double>(triangles) / 4);
  const auto r = std::max(2u, static_cast<std::uint32_t>(std::lround(rings)));
  return sphere(radius, 2 * r, r);
}

Mesh cylinder(double radius, double height, std::uint32_t segments, std::uint32_t rows,
              std::uint32_t cap_rings) {
  rows = std::max(1u, rows);
  cap_rings = std::max(1u, cap_rings);
  std::vector<std::pair<double, double>> profile;
  for (std::uint32_t i = 1; i < cap_rings; ++i) profile.emplace_back(between(0, radius, i, cap_rings), 0);
  for (std::uint32_t i = 0; i <= rows; ++i) profile.emplace_back(radius, between(0, height, i, rows));
  for (std::uint32_t i = cap_rings - 1; i >= 1; --i)
    profile.emplace_back(between(0, radius, i, cap_rings), height);
  return revolve(profile, segments, Ends::kPoints);
}

Mesh cone(double radius, double height, std::uint32_t segments) {
  Mesh out;
  out.vertices = {Vec3(0), Vec3(0, 0, height)};
  for (std::uint32_t i = 0; i < segments; ++i) {
    const double angle = 2 * std::numbers::pi * i / segments;
    out.vertices.emplace_back(radius * std::cos(angle), radius * std::sin(angle), height);
  }
  for (std::uint32_t i = 0; i < segments; ++i) {
    const std::uint32_t here = 2 + i, next = 2 + (i + 1) % segments;
    out.triangles.push_back({0, next, here});
    out.triangles.push_back({1, here, next});
  }
  out.parts = {{"cone", 0, 2 * segments}};
  return out;
}

Mesh ring(double inner_radius, double outer_radius, double height, std::uint32_t segments, std::uint32_t rows,
          std::uint32_t steps) {
  rows = std::max(1u, rows);
  steps = std::max(1u, steps);
  std::vector<std::pair<double, double>> profile;  // counter-clockwise in (r, z)
  for (std::uint32_t i = 0; i < steps; ++i)
    profile.emplace_back(between(inner_radius, outer_radius, i, steps), 0);
  for (std::uint32_t i = 0; i < rows; ++i) profile.emplace_back(outer_radius, between(0, height, i, rows));
  for (std::uint32_t i = steps; i > 0; --i)
    profile.emplace_back(between(inner_radius, outer_radius, i, steps), height);
  for (std::uint32_t i = rows; i > 0; --i) profile.emplace_back(inner_radius, between(0, height, i, rows));
  return revolve(profile, segments, Ends::kJoined);
}

Mesh torus(double ring_radius, double tube_radius, std::uint32_t segments, std::uint32_t sides) {
  sides = std::max(3u, sides);
  std::vector<std::pair<double, double>> profile;
  for (std::uint32_t i = 0; i < sides; ++i) {
    const Turn t = turn_by(static_cast<double>(i) / sides);
    profile.emplace_back(ring_radius + tube_radius * t.cos, tube_radius * t.sin);
  }
  return revolve(profile, segments, Ends::kJoined);
}

void append(Mesh& into, const Mesh& part, const std::string& name) {
  const std::uint32_t offset = index_of(into.vertices.size());
  const std::uint32_t first = index_of(into.triangles.size());
  into.vertices.insert(into.vertices.end(), part.vertices.begin(), part.vertices.end());
  for (const auto& [a, b, c] : part.triangles) into.triangles.push_back({a + offset, b + offset, c + offset});
  into.parts.push_back({name, first, index_of(part.triangles.size())});
}

Mesh moved(Mesh mesh, const Pose& pose) {
  for (Vec3& v : mesh.vertices) v = pose.rotation * v + pose.position;
  return mesh;
}

Mesh split(const Mesh& mesh, double share) {
  const std::size_t count = mesh.triangles.size();
  const auto corner = [&](std::size_t t, std::size_t k) { return mesh.vertices[mesh.triangles[t][k % 3]]; };
  std::vector<std::size_t> face(count);
  std::iota(face.begin(), face.end(), std::size_t{0});
  const auto face_of = [&](std::size_t t) {
    while (face[t] != t) t = face[t] = face[face[t]];
    return t;
  };
  // Joined over edges, by their ends' bits, that are no sharper than 45°.
  std::vector<Vec3> normals(count);
  std::map<std::array<double, 6>, std::size_t> seen;
  for (std::size_t t = 0; t < count; ++t) {
    normals[t] = glm::normalize(glm::cross(corner(t, 1) - corner(t, 0), corner(t, 2) - corner(t, 0)));
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 a = corner(t, k), b = corner(t, k + 1);
      if (const auto there = seen.find({b.x, b.y, b.z, a.x, a.y, a.z}); there == seen.end())
        seen.insert({{a.x, a.y, a.z, b.x, b.y, b.z}, t});
      else if (glm::dot(normals[t], normals[there->second]) > std::sqrt(0.5))
        face[face_of(t)] = face_of(there->second);
    }
  }
  std::vector<Vec3> middle(count, Vec3(0));
  std::vector<double> corners(count, 0);
  for (std::size_t t = 0; t < count; ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      middle[face_of(t)] += corner(t, k);
      corners[face_of(t)] += 1;
    }
  Mesh out;
  out.parts = mesh.parts;
  for (std::size_t t = 0; t < count; ++t) {
    const std::size_t of = face_of(t);
    const auto first = static_cast<std::uint32_t>(out.vertices.size());
    for (std::size_t k = 0; k < 3; ++k)
      out.vertices.push_back(corner(t, k) + share * (middle[of] / corners[of] - corner(t, k)));
    out.triangles.push_back({first, first + 1, first + 2});
  }
  return out;
}

Mesh turned_inside_out(Mesh mesh) {
  for (auto& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
  return mesh;
}

double volume(const Mesh& mesh) {
  double six_times = 0;
  for (const auto& [a, b, c] : mesh.triangles)
    six_times += glm::dot(mesh.vertices[a], glm::cross(mesh.vertices[b], mesh.vertices[c]));
  return six_times / 6;
}

std::uint64_t open_edges(const Mesh& mesh) {
  // Equal points get one number: their rank among all points in order.
  std::vector<std::uint32_t> order(mesh.vertices.size()), number(mesh.vertices.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = index_of(i);
  const auto key = [&](std::uint32_t i) {
    const Vec3& v = mesh.vertices[i];
    return std::make_tuple(v.x, v.y, v.z);
  };
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return key(a) < key(b); });
  for (std::size_t i = 0; i < order.size(); ++i)
    number[order[i]] = i > 0 && key(order[i]) == key(order[i - 1]) ? number[order[i - 1]] : index_of(i);

  struct Edge {
    std::uint32_t low, high;
    int sign;
  };
  std::vector<Edge> edges;
  edges.reserve(3 * mesh.triangles.size());
  for (const auto& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = number[t[k]], b = number[t[(k + 1) % 3]];
      if (a != b) edges.push_back({std::min(a, b), std::max(a, b), a < b ? 1 : -1});
    }
  std::sort(edges.begin(), edges.end(),
            [](const Edge& a, const Edge& b) { return std::tie(a.low, a.high) < std::tie(b.low, b.high); });
  std::uint64_t open = 0;
  for (std::size_t i = 0; i < edges.size();) {
    std::size_t j = i;
    int sum = 0;
    for (; j < edges.size() && edges[j].low == edges[i].low && edges[j].high == edges[i].high; ++j)
      sum += edges[j].sign;
    open += sum != 0;
    i = j;
  }
  return open;
}

}  // namespace palpate::solids
