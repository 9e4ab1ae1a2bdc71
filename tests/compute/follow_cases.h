#pragma once
#include <algorithm>
#include <memory>
#include <vector>

#include "compute/host_follow.h"
#include "tests/compute/probe_cases.h"

/// Made-up contacts, to be asked who pierces whom: a few areas of triangles, and samples whose rays often aim at one of them, at its corners or its
/// edges, or end at the very height of a crossing. The same every time: tests/mutation asks mutants the same.
namespace palpate::follow_cases {

struct Contact {
  SceneGeometry geometry;
  std::vector<gpu::StaticResult> statics;
  std::vector<gpu::AreaWork> areas;
  std::vector<RisenSample> risen;
};

inline void add_triangle(Contact& c, const Int3 (&t)[3], std::uint32_t area) {
  LatticeMesh& mesh = c.geometry.mockup;
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), {t[0], t[1], t[2]});
  c.statics.push_back({static_cast<std::uint32_t>(mesh.triangles.size()), gpu::kStaticHit, area, area});
  mesh.triangles.push_back({first, first + 1, first + 2});
  gpu::AreaWork& of = c.areas[area];
  for (const Int3& corner : t) {
    of.box_low = glm::min(Int3(of.box_low), corner);
    of.box_high = glm::max(Int3(of.box_high), corner);
  }
}

inline std::vector<std::unique_ptr<Contact>> contacts() {
  LatticePoints points(9);
  std::mt19937_64 engine(9);
  const auto below = [&](std::size_t n) { return static_cast<std::size_t>(engine() % n); };
  std::vector<std::unique_ptr<Contact>> cases;
  for (std::size_t i = 0; i < 1500; ++i) {
    auto contact = std::make_unique<Contact>();
    Contact& c = *contact;
    const auto count = static_cast<std::uint32_t>(2 + below(4));
    c.areas.resize(count);
    points.choose();
    for (gpu::AreaWork& area : c.areas) {
      area.box_low = Int3(INT32_MAX);
      area.box_high = Int3(INT32_MIN);
      Int3 d(0);
      while (d == Int3(0)) d = i % 3 == 0 ? Int3(points.within(1), points.within(1), points.within(1)) : points.point() - points.point();
      area.direction = probe_cases::as_direction(d);
    }
    Int3 t[3];
    for (std::size_t k = 0; k < 4 * count; ++k) {   // numbered in turn or as it comes
      points.triangle(t);
      add_triangle(c, t, static_cast<std::uint32_t>(k < count ? k : below(count)));
    }
    for (std::size_t k = 0; k < 8 * count; ++k) {
      const auto area = static_cast<std::uint32_t>(below(count));
      const Int3 d = -c.areas[area].direction;
      const LatticeMesh& mesh = c.geometry.mockup;
      const auto at = static_cast<std::uint32_t>(below(mesh.triangles.size()));
      const Int3 a = mesh.corner(at, 0), b = mesh.corner(at, 1), e = mesh.corner(at, 2);
      const Int3 towards = k % 4 == 0 ? a : k % 4 == 1 ? (a + b) / 2 : k % 4 == 2 ? a / 3 + b / 3 + e / 3 : points.point();
      // So far before it that the ray just comes there at `height`.
      const std::uint32_t height = static_cast<std::uint32_t>(engine() % (std::uint64_t{1} << (1 + below(31))));
      Int3 from;
      for (int x = 0; x < 3; ++x) from[x] = towards[x] - static_cast<std::int32_t>(std::int64_t{d[x]} * height >> 30);
      if (i % 3 == 0 && k % 2 == 0) from = Int3(glm::clamp(Long3(towards) - Long3(static_cast<std::int64_t>(below(5))) * Long3(d) / (std::int64_t{1} << 28), Long3(-(1 << 28)), Long3(1 << 28)));
      from = glm::clamp(from, Int3(-(1 << 28)), Int3(1 << 28));
      std::uint32_t end = height + static_cast<std::uint32_t>(engine() % 3);
      if (const exact::Crossing crossing = exact::ray_crossing(from, d, {a, b, e}); crossing.sign != 0 && k % 3 != 0)
        end = crossing.height + static_cast<std::uint32_t>(k % 3 == 1 ? engine() % 2 : engine() % (1u << 28));
      c.risen.push_back({area, from, std::min(end, 1u << 31)});
    }
    cases.push_back(std::move(contact));
  }
  return cases;
}

/// What the host answers.
inline std::vector<gpu::AreaPierce> pierces(Contact& c) {
  HostFollow follow(c.geometry);
  const ContactLists lists{.mobiles = {}, .samples = {}, .statics = c.statics, .areas = c.areas, .slots = {}, .members = {}};
  std::vector<RisenSample> risen = c.risen;
  std::vector<gpu::AreaPierce> out;
  follow.pierces(lists, static_cast<std::uint32_t>(c.areas.size()), risen, out);
  return out;
}

}  // namespace palpate::follow_cases
