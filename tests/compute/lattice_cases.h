#pragma once
#include <algorithm>
#include <array>
#include <vector>

#include "model/lattice/vector.h"
#include "shaders/shared/prepare.h"
#include "shaders/shared/scene.h"
#include "tests/compute/module_run.h"

/// Runs of the modules that put triangles into bricks and voxels, on handfuls of triangles whose corners lie
/// where voxels' faces, centres and tenths do. In each, buffers go on behind `count`, and so do invocations.
namespace palpate::lattice_cases {

inline constexpr std::uint32_t kUntouched = 0xA5A5A5A5u;
inline constexpr std::uint32_t kMore = 70;  ///< invocations beyond the last

struct Soup {
  std::vector<Int3> vertices;
  std::vector<gpu::uvec3> triangles;
  std::uint32_t count() const { return static_cast<std::uint32_t>(triangles.size()); }
  void add(const Int3& a, const Int3& b, const Int3& c) {
    const auto first = static_cast<std::uint32_t>(vertices.size());
    vertices.insert(vertices.end(), {a, b, c});
    triangles.emplace_back(first, first + 1, first + 2);
  }
};

inline Long3 normal_of(const Int3& a, const Int3& b, const Int3& c) {
  const Long3 u = Long3(b) - Long3(a), v = Long3(c) - Long3(a);
  return {u.y * v.z - u.z * v.y, u.z * v.x - u.x * v.z, u.x * v.y - u.y * v.x};
}

inline int within(Numbers& random, int least, int most) {
  return least + static_cast<int>(random() % static_cast<unsigned>(most - least + 1));
}

/// Three points of a box, with an area, on every `step` lattice points from `base` or one off.
inline std::array<Int3, 3> triangle_in(Numbers& random, const Int3& base, const Int3& low, const Int3& high,
                                       int step) {
  std::array<Int3, 3> corner{};
  do
    for (Int3& p : corner)
      for (int k = 0; k < 3; ++k)
        p[k] = std::clamp(base[k] +
                              within(random, (low[k] - base[k]) / step, (high[k] - base[k]) / step) * step +
                              (random() % 3 == 0 ? within(random, -1, 1) : 0),
                          low[k], high[k]);
  while (normal_of(corner[0], corner[1], corner[2]) == Long3(0));
  return corner;
}

/// Triangles to bricks, by each way and both times: counted, and listed, each item from a place of its own
/// on.
inline std::vector<ModuleRun> expansions() {
  Numbers random(41);
  std::vector<ModuleRun> runs;
  const Int3 origin{-4096, 640, -1280}, bricks{18, 12, 9};
  constexpr std::int32_t kSize = 16, kSide = 8 * kSize;
  Soup soup;
  Words info;
  for (int i = 0; i < 260; ++i) {
    // In boxes of about as many bricks as are tested at once, and of far more and fewer.
    const Int3 padding(2 * kSize), low = origin + padding, high = origin + bricks * kSide - padding;
    constexpr std::array<std::array<int, 3>, 6> kSpans{
        {{4, 4, 4}, {5, 13, 1}, {8, 8, 1}, {1, 1, 1}, {17, 11, 8}, {2, 4, 8}}};
    std::array<int, 3> span = kSpans[random() % kSpans.size()];
    std::shuffle(span.begin(), span.end(), random);
    Int3 from, to;
    for (int k = 0; k < 3; ++k) {
      span[static_cast<std::size_t>(k)] = std::min(span[static_cast<std::size_t>(k)], bricks[k] - 1);
      const int first = within(random, 0, bricks[k] - 1 - span[static_cast<std::size_t>(k)]);
      from[k] = std::max(low[k], origin[k] + first * kSide + kSize / 2);
      to[k] = std::min(high[k], origin[k] + (first + span[static_cast<std::size_t>(k)]) * kSide - kSize / 2);
    }
    auto corner = triangle_in(random, origin, from, to, kSize / 2);
    if (i % 4 != 0) {  // it spans the box
      const Int3 other{to.x, from.y, i % 8 == 1 ? from.z : to.z};
      if (normal_of(from, to, other) != Long3(0)) corner = {from, to, other};
    }
    soup.add(corner[0], corner[1], corner[2]);
    info.push_back((i % 9 == 0 ? gpu::kInfoCollapsed : 0u) | (i % 5 == 0 ? gpu::kInfoSheet : 0u) |
                   static_cast<std::uint32_t>(i % 3) << gpu::kInfoAxisShift);
  }
  const Int3 groups = (bricks + 7) / 8;
  Words item_triangle, item_cell;
  for (int i = 0; i < 150; ++i) {
    item_triangle.push_back(static_cast<std::uint32_t>(random() % soup.count()));
    item_cell.push_back(
        static_cast<std::uint32_t>(random() % static_cast<unsigned>(groups.x * groups.y * groups.z)));
  }
  for (const std::uint32_t source : {gpu::kSourceSmall, gpu::kSourceLarge, gpu::kSourceItems})
    for (const std::int32_t growth : {0, 3})
      for (const std::uint32_t emit : {0u, 1u}) {
        const bool large = source == gpu::kSourceLarge, items = source == gpu::kSourceItems;
        const std::uint32_t all = items ? static_cast<std::uint32_t>(item_cell.size()) : soup.count(),
                            room = items ? 512 : 64;
        gpu::ExpandPush push{origin,
                             large ? 8 * kSide : kSide,
                             large ? groups : bricks,
                             growth,
                             groups,
                             all - 20,
                             bricks,
                             kSide,
                             source,
                             emit};
        Words counts(all, kUntouched);
        for (std::uint32_t i = 0; i < all && emit != 0; ++i) counts[i] = i * room;
        const Words out(emit != 0 ? all * room : 1, kUntouched);
        runs.push_back({"triangle_expand",
                        {words_of(soup.vertices), words_of(soup.triangles), info, item_triangle, item_cell,
                         counts, out, out},
                        push_of(push),
                        all + kMore});
      }
  return runs;
}

/// A grid of a few bricks, some of them mixed, and entries (triangle, boundary voxel) of no particular mesh:
/// triangles lie about their voxel.
struct Entries {
  Int3 origin, bricks{3, 2, 4};
  std::int32_t size = 0;
  Soup soup;
  Words mixed, place,
      voxel;  ///< mixed_brick[], boundary_place[]; of each entry, whose triangle has its number
  Int3 low(std::uint32_t boundary) const {
    const int brick = static_cast<int>(mixed[place[boundary] >> 9]),
              bit = static_cast<int>(place[boundary] & 511);
    const Int3 at = Int3(brick % bricks.x, brick / bricks.x % bricks.y, brick / (bricks.x * bricks.y)) * 8 +
                    Int3(bit & 7, bit >> 3 & 7, bit >> 6);
    return origin + size * at;
  }
  Words list() const {
    Words ids(voxel.size());
    for (std::uint32_t i = 0; i < ids.size(); ++i) ids[i] = i;
    return ids;
  }
};

/// `reach`: eighths of a voxel's side by which triangles reach beyond its faces; corners lie on every `step`
/// lattice points about the voxel's centre.
inline Entries entries(Numbers& random, std::uint32_t count, std::int32_t size, int reach, int step) {
  Entries e;
  e.origin = {-7 * size, 3 * size, -40 * size};
  e.size = size;
  for (std::uint32_t b = 0; b < 24; ++b)
    if (random() % 3 != 0) e.mixed.push_back(b);
  for (int i = 0; i < 150; ++i)
    e.place.push_back(static_cast<std::uint32_t>(random() % (512 * e.mixed.size())));
  for (std::uint32_t i = 0; i < count; ++i) {
    e.voxel.push_back(static_cast<std::uint32_t>(random() % e.place.size()));
    const Int3 low = e.low(e.voxel.back()), more(size / 8 * reach);
    const auto corner = triangle_in(random, low + Int3(size / 2), low - more, low + Int3(size) + more, step);
    e.soup.add(corner[0], corner[1], corner[2]);
  }
  return e;
}

/// Lines through voxels' centres, which most edges are in line with.
inline std::vector<ModuleRun> crossings() {
  Numbers random(42);
  std::vector<ModuleRun> runs;
  const Entries e = entries(random, 3000, 64, 12, 32);
  const auto voxels = static_cast<std::uint32_t>(e.place.size()),
             count = static_cast<std::uint32_t>(e.voxel.size());
  for (std::uint32_t i = 0; i < 12; ++i) {
    const struct {
      gpu::GridPush grid;
      std::uint32_t voxels;
    } push{{e.origin, e.size, e.bricks, count - 100 - i, i == 0 ? 1u : 3u}, voxels};
    runs.push_back({"row_cross",
                    {words_of(e.soup.vertices), words_of(e.soup.triangles), e.list(), e.voxel, e.place,
                     e.mixed, Words(3 * voxels, 0)},
                    push_of(push),
                    count + kMore});
  }
  return runs;
}

/// The same lines on both sides of the centres; some triangles bound nothing.
inline std::vector<ModuleRun> half_crossings() {
  Numbers random(46);
  std::vector<ModuleRun> runs;
  const Entries e = entries(random, 3000, 64, 12, 32);
  const auto voxels = static_cast<std::uint32_t>(e.place.size()),
             count = static_cast<std::uint32_t>(e.voxel.size());
  Words info(count, 0);
  for (std::uint32_t& flags : info)
    flags = random() % 2 << gpu::kInfoAxisShift | (random() % 8 == 0 ? gpu::kInfoSheet : 0u) |
            (random() % 8 == 0 ? gpu::kInfoCollapsed : 0u);
  for (std::uint32_t axis = 0; axis < 3; ++axis) {
    const gpu::GridPush push{e.origin, e.size, e.bricks, count - 100 - axis, axis};
    runs.push_back({"half_cross",
                    {words_of(e.soup.vertices), words_of(e.soup.triangles), info, e.list(), e.voxel, e.place,
                     e.mixed, Words(2 * voxels, 0)},
                    push_of(push),
                    count + kMore});
  }
  return runs;
}

/// Bricks to voxels: marked and counted, and listed.
inline std::vector<ModuleRun> voxels() {
  Numbers random(43);
  std::vector<ModuleRun> runs;
  const Entries e = entries(random, 160, 16, 40, 4);
  const auto items = static_cast<std::uint32_t>(e.voxel.size()),
             slots = static_cast<std::uint32_t>(e.mixed.size());
  constexpr std::uint32_t kBase = 5;
  Words cell, slot(24, gpu::kBrickExternal), begin;
  for (std::uint32_t s = 0; s < slots; ++s) slot[e.mixed[s]] = s;
  for (std::uint32_t i = 0; i < items; ++i) {
    cell.push_back(e.mixed[e.place[e.voxel[i]] >> 9]);
    begin.push_back(512 * i);
  }
  for (const std::int32_t growth : {0, 3})
    for (const std::uint32_t emit : {0u, 1u}) {
      std::vector<gpu::Brick> bricks(slots);
      for (std::uint32_t s = 0; s < slots && emit != 0; ++s)
        for (std::uint32_t w = 0; w < 16; ++w)
          bricks[s].boundary[w] = ~0u, bricks[s].first[w] = s * 512 + w * 32;
      const gpu::VoxelPush push{e.origin, e.size, e.bricks, growth, items - 30, kBase, emit};
      const Words out(emit != 0 ? 512 * items + kBase : 1, kUntouched);
      runs.push_back(
          {"voxel_list",
           {words_of(e.soup.vertices), words_of(e.soup.triangles), e.list(), cell, slot, words_of(bricks),
            emit != 0 ? begin : Words(items, kUntouched), out, out, Words(512 * slots, 0)},
           push_of(push),
           items + kMore});
    }
  return runs;
}

/// Samples of triangles about their voxel, from an entry on, in both forms.
inline std::vector<ModuleRun> samples() {
  Numbers random(44);
  std::vector<ModuleRun> runs;
  const Entries e = entries(random, 700, 64, 5, 8);
  const auto all = static_cast<std::uint32_t>(e.voxel.size());
  constexpr std::uint32_t kFirst = 150, kRoom = 25, kBase = 1000;
  Words info;
  for (std::uint32_t t = 0; t < e.soup.count(); ++t) {
    const gpu::uvec3& corner = e.soup.triangles[t];
    const Long3 n =
        glm::abs(normal_of(e.soup.vertices[corner.x], e.soup.vertices[corner.y], e.soup.vertices[corner.z]));
    info.push_back((n.x >= n.y && n.x >= n.z ? 0u
                    : n.y >= n.z             ? 1u
                                             : 2u)
                       << gpu::kInfoAxisShift |
                   random() % 4);
  }
  for (const std::uint32_t emit : {0u, 1u})
    for (const std::uint32_t wide : {0u, 1u}) {
      // A part of the voxel's side, as usual; and a number that its last lattice point may be a multiple of.
      const gpu::SampleListPush push{e.origin,          e.size, e.bricks, wide == 0 ? 16 : 21,
                                     all - kFirst - 60, kFirst, kBase,    wide};
      Words begins(all, kUntouched);
      for (std::uint32_t i = kFirst; i < all && emit != 0; ++i) begins[i] = kBase + kRoom * (i - kFirst);
      runs.push_back({"sample_list",
                      {words_of(e.soup.vertices), words_of(e.soup.triangles), info, e.voxel, e.list(),
                       e.place, e.mixed, begins, Words(emit != 0 ? (1 + wide) * kRoom * all : 1, kUntouched)},
                      push_of(push),
                      all + kMore,
                      {emit}});
    }
  return runs;
}

}  // namespace palpate::lattice_cases
