#pragma once
#include <array>
#include <vector>

#include "model/lattice/vector.h"
#include "shaders/shared/prepare.h"
#include "shaders/shared/scene.h"
#include "tests/compute/brick_floods.h"
#include "tests/compute/module_run.h"

/// Runs of the modules that number bricks, join what is not boundary and count its votes, on made-up
/// labyrinths. Unlike a mesh's, they reach the grid's border anywhere, and have bricks that are V_int before
/// they are classified: the modules' rules, and nothing that prepared scenes happen to have in common. In
/// each, buffers go on behind `count`, and so do invocations.
namespace palpate::labyrinth_cases {

inline constexpr std::uint32_t kUntouched = 0xA5A5A5A5u;
inline constexpr std::uint32_t kMore = 70;  ///< invocations beyond the last

/// Some bricks, and all that preparation knows of them on its way.
struct Labyrinth {
  Int3 n{0};                       ///< bricks along each axis
  Words slot, mixed;               ///< brick_slot[]; numbers of the mixed ones
  std::vector<gpu::Brick> bricks;  ///< boundary[] and first[]
  std::uint32_t boundary_voxels = 0;
  Words first{0}, labels;  ///< component_first[], labels[]
  Words root;              ///< of every node

  std::uint32_t count() const { return static_cast<std::uint32_t>(slot.size()); }
  std::uint32_t slots() const { return static_cast<std::uint32_t>(bricks.size()); }
  std::uint32_t nodes() const { return static_cast<std::uint32_t>(1 + slot.size() + first.back()); }
  std::uint32_t number(const Int3& brick) const {
    return static_cast<std::uint32_t>(brick.x + n.x * (brick.y + n.y * brick.z));
  }
  Int3 brick(std::uint32_t number) const {
    const int b = static_cast<int>(number);
    return {b % n.x, b / n.x % n.y, b / (n.x * n.y)};
  }
  bool boundary(std::uint32_t s, unsigned bit) const {
    return (bricks[s].boundary[bit >> 5] >> (bit & 31) & 1) != 0;
  }
  /// Node of a voxel of the grid; kNoVoxel for a boundary voxel.
  std::uint32_t node(const Int3& voxel) const {
    const std::uint32_t b = number(voxel / 8), s = slot[b];
    if (s >= gpu::kBrickInternal) return 1 + b;
    const auto bit = static_cast<unsigned>((voxel.x & 7) | (voxel.y & 7) << 3 | (voxel.z & 7) << 6);
    if (boundary(s, bit)) return gpu::kNoVoxel;
    std::uint32_t component = 0;
    for (unsigned plane = 0; plane < 8; ++plane)
      component |= (labels[s * 128 + plane * 16 + (bit >> 5)] >> (bit & 31) & 1) << plane;
    return 1 + count() + first[s] + component;
  }
};

/// Sets of nodes, each named by its smallest.
struct Sets {
  Words parent;
  explicit Sets(std::uint32_t nodes) : parent(nodes) {
    for (std::uint32_t i = 0; i < nodes; ++i) parent[i] = i;
  }
  std::uint32_t root(std::uint32_t node) const {
    while (parent[node] != node) node = parent[node];
    return node;
  }
  void join(std::uint32_t a, std::uint32_t b) {
    a = root(a);
    b = root(b);
    parent[std::max(a, b)] = std::min(a, b);
  }
  Words roots() const {
    Words all(parent.size());
    for (std::uint32_t i = 0; i < all.size(); ++i) all[i] = root(i);
    return all;
  }
};

/// What lies beyond the faces of brick and axis number `item`, as component_join has it.
inline void join_faces(const Labyrinth& l, std::uint32_t item, Sets& sets) {
  const Int3 brick = l.brick(item / 3);
  const int axis = static_cast<int>(item % 3), u = (axis + 1) % 3, v = (axis + 2) % 3;
  for (int i = 0; i < 8; ++i)
    for (int j = 0; j < 8; ++j) {
      Int3 voxel = brick * 8;
      voxel[u] += i;
      voxel[v] += j;
      if (const std::uint32_t node = l.node(voxel); brick[axis] == 0 && node != gpu::kNoVoxel)
        sets.join(node, 0);
      voxel[axis] += 7;
      const std::uint32_t node = l.node(voxel);
      voxel[axis] += 1;
      const std::uint32_t next = brick[axis] == l.n[axis] - 1 ? 0 : l.node(voxel);
      if (node != gpu::kNoVoxel && next != gpu::kNoVoxel) sets.join(node, next);
    }
}

/// `uniform`: per cent of the bricks that are. Mixed ones have any share of boundary voxels, all of them too.
/// `shut`: those at the border have nothing else.
inline Labyrinth labyrinth(Numbers& random, Int3 n, unsigned uniform, bool shut = false) {
  Labyrinth l;
  l.n = n;
  for (int b = 0; b < n.x * n.y * n.z; ++b) {
    const Int3 at(b % n.x, b / n.x % n.y, b / (n.x * n.y));
    const bool wall = shut && (at.x % (n.x - 1) == 0 || at.y % (n.y - 1) == 0 || at.z % (n.z - 1) == 0);
    if (!wall && random() % 100 < uniform) {
      l.slot.push_back(random() % 4 == 0 ? gpu::kBrickInternal : gpu::kBrickExternal);
      continue;
    }
    constexpr std::array<unsigned, 8> kShares{20, 60, 75, 92, 100, 100, 100, 100};
    const unsigned share = wall ? 100 : kShares[random() % kShares.size()];
    gpu::Brick brick{};
    BrickVoxels boundary;
    for (unsigned bit = 0; bit < 512; ++bit) boundary[bit] = random() % 100 < share;
    for (unsigned w = 0; w < 16; ++w) {
      brick.first[w] = l.boundary_voxels;
      for (unsigned bit = 0; bit < 32; ++bit)
        if (boundary[w * 32 + bit]) brick.boundary[w] |= 1u << bit, ++l.boundary_voxels;
    }
    int components = 0;
    const auto component = components_of(boundary, components);
    l.labels.resize(l.labels.size() + 128, 0);
    for (unsigned bit = 0; bit < 512; ++bit)
      for (unsigned plane = 0; plane < 8; ++plane)
        if (component[bit] >= 0 && (component[bit] >> plane & 1) != 0)
          l.labels[l.bricks.size() * 128 + plane * 16 + (bit >> 5)] |= 1u << (bit & 31);
    l.first.push_back(l.first.back() + static_cast<std::uint32_t>(components));
    l.slot.push_back(l.slots());
    l.mixed.push_back(static_cast<std::uint32_t>(b));
    l.bricks.push_back(brick);
  }
  if (l.bricks.empty()) return labyrinth(random, n, uniform, shut);
  Sets sets(l.nodes());
  for (std::uint32_t item = 0; item < 3 * l.count(); ++item) join_faces(l, item, sets);
  l.root = sets.roots();
  return l;
}

inline const std::vector<Labyrinth>& labyrinths() {
  static const std::vector<Labyrinth> all = [] {
    Numbers random(31);
    std::vector<Labyrinth> made;
    for (int i = 0; i < 12; ++i) {
      const auto along = [&] { return 1 + static_cast<int>(random() % 6); };
      const Int3 n{along(), along(), along()};
      made.push_back(labyrinth(random, n, 15 + 5 * static_cast<unsigned>(i)));
    }
    for (const Int3& n :
         {Int3(9, 5, 5), Int3(5, 9, 5), Int3(5, 5, 9)})  // with rows of uniform bricks that are shut in
      made.push_back(labyrinth(random, n, 45, true));
    return made;
  }();
  return all;
}

inline gpu::GridPush grid_of(const Labyrinth& l, std::uint32_t count, std::uint32_t axis = 0) {
  return {{0, 0, 0}, 16, l.n, count, axis};
}

/// Not all of them: what is behind is left alone.
inline std::uint32_t most_of(std::uint32_t all) { return all - all / 5; }

/// Marks, slots, boundary voxels and their numbers.
inline std::vector<ModuleRun> numbering() {
  Numbers random(32);
  std::vector<ModuleRun> runs;
  for (const Labyrinth& l : labyrinths()) {
    Words cells(3 * l.slots()), sums(l.count() + 1, 0);
    for (std::uint32_t& cell : cells) cell = static_cast<std::uint32_t>(random() % l.count());
    runs.push_back({"brick_mark", {cells, Words(l.count(), 0)}, {l.slots()}, l.slots() + kMore});
    for (std::uint32_t b = 0; b < l.count(); ++b)
      sums[b + 1] = sums[b] + (l.slot[b] < gpu::kBrickInternal ? 1 : 0);
    runs.push_back({"brick_assign",
                    {sums, Words(l.count(), kUntouched), Words(l.slots() + 1, kUntouched)},
                    {most_of(l.count())},
                    l.count() + kMore});
    std::vector<gpu::Brick> bricks = l.bricks;
    for (gpu::Brick& brick : bricks)
      for (std::uint32_t& word : brick.internal_) word = random();
    runs.push_back({"brick_count",
                    {words_of(bricks), Words(l.slots(), kUntouched)},
                    {most_of(l.slots())},
                    l.slots() + kMore});
    Words begins;
    for (gpu::Brick& brick : bricks) {
      begins.push_back(brick.first[0]);
      for (std::uint32_t& first : brick.first) first = kUntouched;
    }
    runs.push_back({"brick_number",
                    {words_of(bricks), begins, Words(l.boundary_voxels, kUntouched)},
                    {most_of(l.slots())},
                    l.slots() + kMore});
    runs.push_back({"brick_label",
                    {words_of(bricks), Words(l.labels.size(), 0), Words(l.slots(), kUntouched)},
                    {most_of(l.slots())},
                    l.slots() + kMore});
  }
  return runs;
}

/// Parents after row_init.
inline Words parents_of_rows(const Labyrinth& l, std::uint32_t rows) {
  Sets sets(l.nodes());
  for (std::uint32_t b = 0; b < rows * static_cast<std::uint32_t>(l.n.x); ++b) {
    if (l.slot[b] < gpu::kBrickInternal) continue;
    const int x = l.brick(b).x;
    if (x == 0 || x == l.n.x - 1) sets.join(1 + b, 0);
    if (x > 0 && l.slot[b - 1] >= gpu::kBrickInternal) sets.join(1 + b, b);
  }
  return sets.roots();
}

/// Node i hangs under node i + 1, up to the last. Parents of a labyrinth are smaller than their children, so
/// that a pass shortens long ways before it walks them: only on this one its limit shows, whatever the order.
inline Words chain_up(std::uint32_t nodes) {
  Words parent(nodes);
  for (std::uint32_t i = 0; i < nodes; ++i) parent[i] = std::min(i + 1, nodes - 1);
  return parent;
}

inline std::vector<ModuleRun> joins() {
  Numbers random(33);
  std::vector<ModuleRun> runs;
  runs.push_back({"component_root", {Words(200, kUntouched), {0}}, {130}, 200 + kMore, {1}});
  for (const std::uint32_t nodes : {100u, gpu::kFindSteps, gpu::kFindSteps + 1, gpu::kFindSteps + 2, 600u})
    runs.push_back({"component_root", {chain_up(nodes), {0}}, {nodes}, nodes, {0}});
  Words forest(500);
  for (std::uint32_t i = 1; i < 500; ++i) forest[i] = static_cast<std::uint32_t>(random() % (i + 1));
  runs.push_back({"component_root", {forest, {0}}, {433}, 500 + kMore, {0}});
  for (const Labyrinth& l : labyrinths()) {
    const std::uint32_t rows = l.count() / static_cast<std::uint32_t>(l.n.x), items = 3 * l.count();
    for (const std::uint32_t count : {rows, most_of(rows)}) {
      const Sets alone(l.nodes());
      runs.push_back({"row_init", {l.slot, alone.parent}, push_of(grid_of(l, count)), rows + kMore});
    }
    for (const std::uint32_t count : {items, most_of(items), items / 2})
      runs.push_back({"component_join",
                      {l.slot, words_of(l.bricks), l.first, l.labels, parents_of_rows(l, rows), {0}},
                      push_of(grid_of(l, count)),
                      items + kMore,
                      {},
                      1,
                      4});
  }
  // Two bricks side by side along y, in the middle, all others full; one hangs under more nodes than a walk
  // follows.
  Labyrinth l;
  l.n = {3, 4, 60};
  l.slot.assign(static_cast<std::size_t>(l.n.x * l.n.y * l.n.z), 0);
  l.bricks.resize(1);
  for (std::uint32_t& word : l.bricks[0].boundary) word = ~0u;
  l.labels.assign(128, 0);
  l.first = {0, 0};
  const std::uint32_t a = l.number({1, 1, 57}), b = l.number({1, 2, 57});
  l.slot[a] = l.slot[b] = gpu::kBrickExternal;
  Words parent(l.nodes());
  for (std::uint32_t i = 1; i < parent.size(); ++i) parent[i] = i <= 1 + a ? i - 1 : i;
  runs.push_back({"component_join",
                  {l.slot, words_of(l.bricks), l.first, l.labels, parent, {0}},
                  push_of(grid_of(l, 3 * l.count())),
                  3 * l.count(),
                  {},
                  1,
                  4});
  return runs;
}

inline std::vector<ModuleRun> votes() {
  Numbers random(34);
  std::vector<ModuleRun> runs;
  for (const Labyrinth& l : labyrinths()) {
    Words some = l.root;  // of each brick some components reach the border, some don't
    for (std::uint32_t& root : some)
      root = static_cast<std::uint32_t>(random() % 3 == 0 ? random() % some.size() : 0);
    runs.push_back({"brick_enclosed",
                    {l.first, some, Words(l.slots(), kUntouched)},
                    push_of(gpu::EnclosedPush{most_of(l.slots()), l.count()}),
                    l.slots() + kMore});
    Words enclosed(l.slots(), 0);
    for (std::uint32_t s = 0; s < l.slots(); ++s)
      for (std::uint32_t c = l.first[s]; c < l.first[s + 1]; ++c)
        if (l.root[1 + l.count() + c] != 0) enclosed[s] = 1;
    std::vector<std::int32_t> crossings(std::size_t{3} * l.boundary_voxels);
    for (std::int32_t& crossing : crossings) crossing = static_cast<std::int32_t>(random() % 3) - 1;
    for (std::uint32_t axis = 0; axis < 3; ++axis) {
      const int u = static_cast<int>(axis + 1) % 3, v = static_cast<int>(axis + 2) % 3;
      const auto rows = static_cast<std::uint32_t>(l.n[u] * l.n[v]);
      Words head(rows, gpu::kNoVoxel), link(l.slots(), gpu::kNoVoxel);
      for (std::uint32_t s = 0; s < l.slots();
           ++s) {  // ascending, so along any axis too: each goes before those met
        const Int3 at = l.brick(l.mixed[s]);
        std::uint32_t& first = head[static_cast<std::size_t>(at[u] + l.n[u] * at[v])];
        link[s] = first;
        first = s;
      }
      for (const std::uint32_t from_near : {0u, 1u})
        runs.push_back({"row_link",
                        {l.slot, Words(rows, kUntouched), Words(l.slots(), kUntouched)},
                        push_of(grid_of(l, most_of(rows), axis)),
                        rows + kMore,
                        {from_near}});
      const struct {
        gpu::GridPush grid;
        std::uint32_t first_crossing;
      } push{grid_of(l, most_of(64 * rows), axis), axis * l.boundary_voxels};
      std::vector<std::int64_t> before(l.nodes());
      for (std::int64_t& count : before) count = static_cast<std::int64_t>(random() % 100) - 50;
      runs.push_back({"vote_sweep",
                      {l.mixed, words_of(l.bricks), l.first, l.labels, l.root, words_of(crossings),
                       words_of(before), head, link, enclosed},
                      push_of(push),
                      64 * rows + kMore});
    }
    for (const int most : {0, 2}) {
      std::vector<std::int64_t> counted(l.nodes());
      for (std::int64_t& count : counted) count = static_cast<std::int64_t>(random() % 4) - 4 + most;
      runs.push_back({"brick_classify",
                      {l.slot, words_of(l.bricks), l.first, l.labels, some, words_of(counted), {0}},
                      {most_of(l.count())},
                      l.count() + kMore});
    }
  }
  return runs;
}

/// What walks along each axis say, both ways: their ends may be V_int anywhere.
inline std::vector<ModuleRun> shells() {
  Numbers random(37);
  std::vector<ModuleRun> runs;
  for (const unsigned uniform : {0u, 50u, 90u}) {
    Labyrinth l = labyrinth(random, {3, 2, 4}, uniform);
    for (gpu::Brick& brick : l.bricks)
      for (unsigned w = 0; w < 16; ++w) brick.internal_[w] = random() & ~brick.boundary[w];
    std::vector<std::int32_t> halves(std::size_t{2} * l.boundary_voxels), least;
    for (std::int32_t& crossings : halves) crossings = static_cast<std::int32_t>(random() % 5) - 2;
    for (std::uint32_t i = 0; i < 3 * l.boundary_voxels; ++i)  // by rank
      least.push_back(4 * static_cast<std::int32_t>(i / l.boundary_voxels) - 6 +
                      static_cast<std::int32_t>(random() % 4));
    for (std::uint32_t axis = 0; axis < 3; ++axis)
      for (const std::uint32_t up : {0u, 1u}) {
        const int u = static_cast<int>(axis + 1) % 3, v = static_cast<int>(axis + 2) % 3;
        const auto rows = static_cast<std::uint32_t>(l.n[u] * l.n[v]);
        Words head(rows, gpu::kNoVoxel), link(l.slots(), gpu::kNoVoxel);
        for (std::uint32_t i = 0; i < l.slots(); ++i) {  // each goes before those met
          const std::uint32_t s = up != 0 ? i : l.slots() - 1 - i;
          const Int3 at = l.brick(l.mixed[s]);
          std::uint32_t& first = head[static_cast<std::size_t>(at[u] + l.n[u] * at[v])];
          link[s] = first;
          first = s;
        }
        const struct {
          gpu::GridPush grid;
          std::uint32_t voxels;
        } push{grid_of(l, 64 * rows - 9, axis), l.boundary_voxels};
        runs.push_back({"shell_sweep",
                        {l.slot, l.mixed, words_of(l.bricks), words_of(halves), head, link, words_of(least)},
                        push_of(push),
                        64 * rows + kMore,
                        {up}});
      }
  }
  return runs;
}

/// What neighbours say of each other's middles.
inline std::vector<ModuleRun> doubts() {
  Numbers random(41);
  std::vector<ModuleRun> runs;
  for (const unsigned uniform : {0u, 60u}) {
    Labyrinth l = labyrinth(random, {2, 3, 2}, uniform);
    for (gpu::Brick& brick : l.bricks)
      for (unsigned w = 0; w < 16; ++w) brick.internal_[w] = random() & ~brick.boundary[w];
    Words place;
    for (std::uint32_t s = 0; s < l.slots(); ++s)
      for (unsigned bit = 0; bit < 512; ++bit)
        if (l.boundary(s, bit)) place.push_back(512 * s + bit);
    std::array<std::vector<std::int32_t>, 3> halves;
    for (auto& of_axis : halves)
      for (std::uint32_t i = 0; i < 2 * l.boundary_voxels; ++i)
        of_axis.push_back(static_cast<std::int32_t>(random() % 8) / 7 -
                          static_cast<std::int32_t>(random() % 8) / 7);
    std::vector<std::int32_t> shells(std::size_t{3} * l.boundary_voxels + 7, -77);
    for (std::uint32_t i = 0; i < l.boundary_voxels; ++i) shells[i] = static_cast<std::int32_t>(random() % 3);
    runs.push_back({"shell_doubt",
                    {l.slot, l.mixed, words_of(l.bricks), place, words_of(halves[0]), words_of(halves[1]),
                     words_of(halves[2]), words_of(shells), Words{5, 7}},
                    push_of(grid_of(l, l.boundary_voxels)),
                    l.boundary_voxels + kMore});
  }
  return runs;
}

}  // namespace palpate::labyrinth_cases
