#include <algorithm>
#include <array>
#include <bit>

#include "tests/compute/module_test.h"

namespace palpate {
namespace {

using LabyrinthModules = ModuleTest;
using labyrinth_cases::Labyrinth;

TEST_F(LabyrinthModules, BricksOfItemsAreMarked) {
  each("brick_mark", spirv::brick_mark, [](const ModuleRun& run, std::vector<Words>& want, auto&) {
    for (std::uint32_t item = 0; item < run.push[0]; ++item) want[1][run.buffers[0][item]] = 1;
  });
}

TEST_F(LabyrinthModules, MarkedBricksGetSlotsInOrder) {
  each("brick_assign", spirv::brick_assign, [](const ModuleRun& run, std::vector<Words>& want, auto&) {
    std::uint32_t slot = 0;
    for (std::uint32_t b = 0; b < run.push[0]; ++b) {
      const bool mixed = run.buffers[0][b + 1] != run.buffers[0][b];
      want[1][b] = mixed ? slot : gpu::kBrickExternal;
      if (mixed) want[2][slot++] = b;
    }
  });
}

bool bit_of(const std::uint32_t (&words)[16], unsigned bit) {
  return (words[bit >> 5] >> (bit & 31) & 1) != 0;
}

TEST_F(LabyrinthModules, BoundaryVoxelsAreCounted) {
  each("brick_count", spirv::brick_count, [](const ModuleRun& run, std::vector<Words>& want, auto&) {
    const auto bricks = values_of<gpu::Brick>(run.buffers[0]);
    for (std::uint32_t s = 0; s < run.push[0]; ++s) {
      want[1][s] = 0;
      for (unsigned bit = 0; bit < 512; ++bit) want[1][s] += bit_of(bricks[s].boundary, bit) ? 1u : 0u;
    }
  });
}

TEST_F(LabyrinthModules, BoundaryVoxelsAreNumbered) {
  each("brick_number", spirv::brick_number, [](const ModuleRun& run, std::vector<Words>& want, auto&) {
    auto bricks = values_of<gpu::Brick>(run.buffers[0]);
    for (std::uint32_t s = 0; s < run.push[0]; ++s) {
      std::uint32_t next = run.buffers[1][s];
      for (unsigned bit = 0; bit < 512; ++bit) {
        if (bit % 32 == 0) bricks[s].first[bit / 32] = next;
        if (bit_of(bricks[s].boundary, bit)) want[2][next++] = s * 512 + bit;
      }
    }
    want[0] = words_of(bricks);
  });
}

TEST_F(LabyrinthModules, VoxelsOfABrickAreLabelled) {
  each("brick_label", spirv::brick_label, [](const ModuleRun& run, std::vector<Words>& want, auto&) {
    const auto bricks = values_of<gpu::Brick>(run.buffers[0]);
    for (std::uint32_t s = 0; s < run.push[0]; ++s) {
      BrickVoxels boundary;
      for (unsigned bit = 0; bit < 512; ++bit) boundary[bit] = bit_of(bricks[s].boundary, bit);
      int count = 0;
      const auto component = components_of(boundary, count);
      want[2][s] = static_cast<std::uint32_t>(count);
      for (unsigned bit = 0; bit < 512; ++bit)
        for (unsigned plane = 0; plane < 8; ++plane)
          if (component[bit] >= 0 && (component[bit] >> plane & 1) != 0)
            want[1][s * 128 + plane * 16 + bit / 32] |= 1u << bit % 32;
    }
  });
}

TEST_F(LabyrinthModules, ARowsRunsOfUniformBricksGetOneParent) {
  each("row_init", spirv::row_init, [](const ModuleRun& run, std::vector<Words>& want, auto&) {
    const auto push = push_as<gpu::GridPush>(run);
    const auto uniform = [&](std::uint32_t row, int x) {
      return run.buffers[0][row * static_cast<std::uint32_t>(push.bricks.x) +
                            static_cast<std::uint32_t>(x)] >= gpu::kBrickInternal;
    };
    for (std::uint32_t row = 0; row < push.count; ++row)
      for (int x = 0; x < push.bricks.x; ++x) {
        if (!uniform(row, x)) continue;
        int first = x, end = x;
        while (first > 0 && uniform(row, first - 1)) --first;
        while (end < push.bricks.x && uniform(row, end)) ++end;
        const std::uint32_t node = 1 + row * static_cast<std::uint32_t>(push.bricks.x);
        want[1][node + static_cast<std::uint32_t>(x)] =
            first == 0 || end == push.bricks.x ? 0 : node + static_cast<std::uint32_t>(first);
      }
  });
}

TEST_F(LabyrinthModules, ANodeGetsItsRootUnlessTheWayIsTooLong) {
  each("component_root", spirv::component_root, [](const ModuleRun& run, std::vector<Words>& want, auto&) {
    const Words& parent = run.buffers[0];
    for (std::uint32_t node = 0; node < run.push[0]; ++node) {
      if (run.constants[0] != 0) {
        want[0][node] = node;
        continue;
      }
      std::uint32_t root = node, steps = 0;
      for (; parent[root] != root && steps < gpu::kFindSteps + 1; ++steps)
        root = parent[root];  // the first step is no look-up
      want[0][node] = std::min(parent[node], root);
      if (steps == gpu::kFindSteps + 1) want[1][0] = 1;
    }
  });
}

/// A labyrinth as the modules see it.
Labyrinth labyrinth_of(const gpu::GridPush& push, const Words& slot, const Words& bricks, const Words& first,
                       const Words& labels) {
  Labyrinth l;
  l.n = push.bricks;
  l.slot = slot;
  l.bricks = values_of<gpu::Brick>(bricks);
  l.first = first;
  l.labels = labels;
  return l;
}

TEST_F(LabyrinthModules, WhatMeetsAtFacesOrLiesAtTheBorderIsJoined) {
  each("component_join", spirv::component_join, [](const ModuleRun& run, std::vector<Words>& want, auto&) {
    const auto push = push_as<gpu::GridPush>(run);
    const Labyrinth l = labyrinth_of(push, run.buffers[0], run.buffers[1], run.buffers[2], run.buffers[3]);
    labyrinth_cases::Sets sets(0);
    sets.parent = run.buffers[4];
    for (std::uint32_t node = 0; node < sets.parent.size(); ++node) {  // a way of which halves are too long
      std::uint32_t steps = 0;
      for (std::uint32_t at = node; sets.parent[at] != at; at = sets.parent[at]) ++steps;
      if (steps > 2 * gpu::kFindSteps) want[5][0] = 1;
    }
    for (std::uint32_t item = 0; item < push.count; ++item) labyrinth_cases::join_faces(l, item, sets);
    want[4] = sets.parent;
  });
}

TEST_F(LabyrinthModules, BricksWithAComponentOffTheBorderAreTold) {
  each("brick_enclosed", spirv::brick_enclosed, [](const ModuleRun& run, std::vector<Words>& want, auto&) {
    const auto push = push_as<gpu::EnclosedPush>(run);
    for (std::uint32_t s = 0; s < push.count; ++s) {
      const auto nodes = run.buffers[1].begin() + 1 + push.bricks;
      want[2][s] = std::all_of(nodes + run.buffers[0][s], nodes + run.buffers[0][s + 1],
                               [](std::uint32_t parent) { return parent == 0; })
                       ? 0
                       : 1;
    }
  });
}

TEST_F(LabyrinthModules, MixedBricksOfARowAreLinkedFromEitherEnd) {
  each("row_link", spirv::row_link, [](const ModuleRun& run, std::vector<Words>& want, auto&) {
    const auto push = push_as<gpu::GridPush>(run);
    const int axis = static_cast<int>(push.axis), u = (axis + 1) % 3, v = (axis + 2) % 3;
    for (int row = 0; row < static_cast<int>(push.count); ++row) {
      Words mixed;  // from the near end
      for (int k = 0; k < push.bricks[axis]; ++k) {
        Int3 at;
        at[axis] = k;
        at[u] = row % push.bricks[u];
        at[v] = row / push.bricks[u];
        const std::uint32_t slot =
            run.buffers[0][static_cast<std::size_t>(at.x + push.bricks.x * (at.y + push.bricks.y * at.z))];
        if (slot < gpu::kBrickInternal) mixed.push_back(slot);
      }
      if (run.constants[0] != 0) std::reverse(mixed.begin(), mixed.end());
      want[1][static_cast<std::size_t>(row)] = mixed.empty() ? gpu::kNoVoxel : mixed.back();
      for (std::size_t i = 0; i < mixed.size(); ++i)
        want[2][mixed[i]] = i == 0 ? gpu::kNoVoxel : mixed[i - 1];
    }
  });
}

TEST_F(LabyrinthModules, EveryEnclosedVoxelVotesByItsWinding) {
  std::size_t rows_shut_in = 0;  // voxels of uniform bricks with a vote
  each("vote_sweep", spirv::vote_sweep, [&](const ModuleRun& run, std::vector<Words>& want, auto&) {
    struct Push {
      gpu::GridPush grid;
      std::uint32_t first_crossing;
    };
    const auto [push, first_crossing] = push_as<Push>(run);
    Words slot(static_cast<std::size_t>(push.bricks.x * push.bricks.y * push.bricks.z), gpu::kBrickExternal);
    for (std::uint32_t s = 0; s < run.buffers[0].size(); ++s) slot[run.buffers[0][s]] = s;
    const Labyrinth l = labyrinth_of(push, slot, run.buffers[1], run.buffers[2], run.buffers[3]);
    const auto crossings = values_of<std::int32_t>(run.buffers[5]);
    auto votes = values_of<std::int64_t>(run.buffers[6]);
    const int axis = static_cast<int>(push.axis), u = (axis + 1) % 3, v = (axis + 2) % 3;
    for (int row = 0; row < static_cast<int>(push.count); ++row) {
      Int3 at;
      at[u] = row % (8 * l.n[u]);
      at[v] = row / (8 * l.n[u]);
      std::int32_t winding = 0;
      for (at[axis] = 8 * l.n[axis] - 1; at[axis] >= 0; --at[axis]) {
        if (const std::uint32_t node = l.node(at); node != gpu::kNoVoxel) {
          const std::uint32_t root = run.buffers[4][node];
          if (root != 0) votes[root] += winding != 0 ? 1 : -1;
          if (root != 0 && node <= l.count()) ++rows_shut_in;
          continue;
        }
        const gpu::Brick& brick = l.bricks[slot[l.number(at / 8)]];
        const auto bit = static_cast<unsigned>((at.x & 7) | (at.y & 7) << 3 | (at.z & 7) << 6);
        std::uint32_t number = brick.first[bit / 32];
        for (unsigned before = bit / 32 * 32; before < bit; ++before)
          number += bit_of(brick.boundary, before) ? 1u : 0u;
        winding += crossings[first_crossing + number];
      }
    }
    want[6] = words_of(votes);
  });
  EXPECT_GT(rows_shut_in, 10'000u);
}

/// A voxel of the grid.
struct Place {
  std::uint32_t slot = gpu::kBrickExternal;
  std::size_t number = 0;  ///< of a boundary voxel
  bool boundary = false, internal = false;
};

Place place_of(const Words& slots, const std::vector<gpu::Brick>& bricks, const Int3& n, const Int3& voxel) {
  const Int3 brick = voxel / 8;
  Place place{slots[static_cast<std::size_t>(brick.x + n.x * (brick.y + n.y * brick.z))], 0, false, false};
  if (place.slot >= gpu::kBrickInternal) {
    place.internal = place.slot == gpu::kBrickInternal;
    return place;
  }
  const gpu::Brick& at = bricks[place.slot];
  const auto bit = static_cast<unsigned>((voxel.x & 7) | (voxel.y & 7) << 3 | (voxel.z & 7) << 6);
  place.boundary = bit_of(at.boundary, bit);
  place.internal = bit_of(at.internal_, bit);
  place.number = at.first[bit / 32];
  for (unsigned before = bit / 32 * 32; before < bit; ++before)
    place.number += bit_of(at.boundary, before) ? 1u : 0u;
  return place;
}

TEST_F(LabyrinthModules, TheLeastThatWalksSayIsKept) {
  constexpr std::int32_t kFar = 1 << 30;  // added to what a walk says that ends beyond eight voxels
  std::size_t into_uniform = 0;           // walks that end in a uniform V_int brick
  std::size_t far = 0;                    // walks so long
  each("shell_sweep", spirv::shell_sweep, [&](const ModuleRun& run, std::vector<Words>& want, auto&) {
    const auto push = push_as<gpu::GridPush>(run);
    const Int3 n = push.bricks;
    const auto bricks = values_of<gpu::Brick>(run.buffers[2]);
    const auto halves = values_of<std::int32_t>(run.buffers[3]);
    auto shells = values_of<std::int32_t>(run.buffers[6]);
    const int axis = static_cast<int>(push.axis), u = (axis + 1) % 3, v = (axis + 2) % 3,
              step = run.constants[0] != 0 ? 1 : -1;
    const auto look = [&](const Int3& voxel) { return place_of(run.buffers[0], bricks, n, voxel); };
    for (int row = 0; row < static_cast<int>(push.count); ++row)
      for (int k = 0; k < 8 * n[axis]; ++k) {
        Int3 from;
        from[axis] = k;
        from[u] = row % (8 * n[u]);
        from[v] = row / (8 * n[u]);
        const Place home = look(from);
        if (!home.boundary) continue;
        // The half beyond the middle, then both halves of each voxel up to one that is not boundary.
        std::int32_t said = step * halves[2 * home.number + (step > 0 ? 1 : 0)];
        Int3 at = from;
        for (at[axis] += step; at[axis] >= 0 && at[axis] < 8 * n[axis]; at[axis] += step) {
          const Place place = look(at);
          if (place.boundary) {
            said += step * (halves[2 * place.number] + halves[2 * place.number + 1]);
            continue;
          }
          if (place.internal) ++said;
          if (place.slot == gpu::kBrickInternal) ++into_uniform;
          break;
        }
        const bool long_way = std::abs(at[axis] - k) > 8;
        std::int32_t& least = shells[home.number];
        least = std::min(least, long_way ? said + kFar : said);
        far += long_way ? 1 : 0;
        if (run.constants[1] != 0 && least >= kFar / 2) least -= kFar;
      }
    want[6] = words_of(shells);
  });
  EXPECT_GT(into_uniform, 100u);
  EXPECT_GT(far, 100u);
}

TEST_F(LabyrinthModules, NeighboursSayLessOrMore) {
  std::size_t bits = 0;  // set
  each("shell_doubt", spirv::shell_doubt, [&](const ModuleRun& run, std::vector<Words>& want, auto&) {
    const Int3 n = push_as<gpu::GridPush>(run).bricks;
    const auto bricks = values_of<gpu::Brick>(run.buffers[2]);
    auto shells = values_of<std::int32_t>(run.buffers[7]);
    const std::size_t voxels = run.buffers[3].size();
    std::array<std::vector<std::int32_t>, 3> halves_along;
    for (std::size_t k = 0; k < 3; ++k) halves_along[k] = values_of<std::int32_t>(run.buffers[4 + k]);
    const auto look = [&](const Int3& voxel) {
      for (int k = 0; k < 3; ++k)
        if (voxel[k] < 0 || voxel[k] >= 8 * n[k]) return Place{};
      return place_of(run.buffers[0], bricks, n, voxel);
    };
    const auto said = [&](const Int3& voxel) {
      const Place place = look(voxel);
      return place.boundary ? shells[place.number] : place.internal ? 1 : 0;
    };
    // From a voxel's middle to that of the next one up an axis.
    const auto up = [&](const Int3& voxel, int axis) {
      Int3 next = voxel;
      ++next[axis];
      const std::vector<std::int32_t>& halves = halves_along[static_cast<std::size_t>(axis)];
      const Place from = look(voxel), to = look(next);
      return (from.boundary ? halves[2 * from.number + 1] : 0) + (to.boundary ? halves[2 * to.number] : 0);
    };
    std::vector<std::uint32_t> less(voxels, 0), more(voxels, 0);
    Int3 a;
    for (a.z = -1; a.z <= 8 * n.z; ++a.z)
      for (a.y = -1; a.y <= 8 * n.y; ++a.y)
        for (a.x = -1; a.x <= 8 * n.x; ++a.x)
          for (unsigned bit = 14; bit < 27; ++bit) {  // each pair once, from the first in the grid
            const int place = static_cast<int>(bit);
            const Int3 to(place % 3 - 1, place / 3 % 3 - 1, place / 9 - 1), b = a + to;
            const Place one = look(a), other = look(b);
            if (!one.boundary && !other.boundary) continue;
            int seen = said(b) - said(a);  // how many more the other says
            Int3 at = a;
            for (int axis = 0; axis < 3; ++axis) {
              if (to[axis] < 0) --at[axis];
              if (to[axis] != 0) seen += to[axis] * up(at, axis);
              if (to[axis] > 0) ++at[axis];
            }
            if (seen == 0) continue;
            if (one.boundary) (seen < 0 ? less : more)[one.number] |= 1u << bit;
            if (other.boundary) (seen > 0 ? less : more)[other.number] |= 1u << (26 - bit);
          }
    for (std::size_t v = 0; v < voxels; ++v) {
      shells[voxels + 2 * v] = static_cast<std::int32_t>(less[v]);
      shells[voxels + 2 * v + 1] = static_cast<std::int32_t>(more[v]);
      want[8][1] += (less[v] | more[v]) != 0 ? 1u : 0u;
      bits += static_cast<std::size_t>(std::popcount(less[v]) + std::popcount(more[v]));
    }
    want[7] = words_of(shells);
    want[8][0] += static_cast<std::uint32_t>(std::count_if(
        shells.begin(), shells.begin() + static_cast<std::ptrdiff_t>(voxels), [](int s) { return s > 0; }));
  });
  EXPECT_GT(bits, 10'000u);
}

TEST_F(LabyrinthModules, AComponentOffTheBorderWithMoreVotesForIsInternal) {
  each("brick_classify", spirv::brick_classify, [](const ModuleRun& run, std::vector<Words>& want, auto&) {
    const std::uint32_t count = run.push[0];
    auto bricks = values_of<gpu::Brick>(run.buffers[1]);
    const auto votes = values_of<std::int64_t>(run.buffers[5]);
    const auto internal = [&](std::uint32_t node) {
      return run.buffers[4][node] != 0 && votes[run.buffers[4][node]] > 0;
    };
    for (std::uint32_t b = 0; b < count; ++b) {
      const std::uint32_t slot = run.buffers[0][b];
      if (slot >= gpu::kBrickInternal) {
        want[0][b] = internal(1 + b) ? gpu::kBrickInternal : gpu::kBrickExternal;
        if (internal(1 + b)) want[6][0] = 1;
        continue;
      }
      for (unsigned bit = 0; bit < 512; ++bit) {
        if (bit_of(bricks[slot].boundary, bit)) continue;
        std::uint32_t component = 0;
        for (unsigned plane = 0; plane < 8; ++plane)
          component |= (run.buffers[3][slot * 128 + plane * 16 + bit / 32] >> bit % 32 & 1) << plane;
        if (!internal(1 + count + run.buffers[2][slot] + component)) continue;
        bricks[slot].internal_[bit / 32] |= 1u << bit % 32;
        want[6][0] = 1;
      }
    }
    want[1] = words_of(bricks);
  });
}

}  // namespace
}  // namespace palpate
