// Boundary voxels and their triangles: each triangle's voxels row by row, then gathered brick by brick and
// sorted there.
#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "compute/native/prepare/partition_build.h"
#include "compute/native/prepare/touched_voxels.h"
#include "compute/scene/exact.h"
#include "compute/scene/shares.h"
#include "shaders/shared/prepare.h"

namespace palpate::native {
namespace {

constexpr std::uint32_t kTrianglesAShare = 1u << 13, kBricksAShare = 256;  // chosen: milliseconds
constexpr std::uint64_t kMostBricks = std::uint64_t{1} << 26;              // chosen: 256 MiB of slots
constexpr std::int32_t kFewVoxels = 8;  // of a box, all of which are asked (chosen)

/// A triangle in a boundary voxel.
struct Entry {
  std::uint32_t brick, triangle;
  std::uint16_t bit;
};

/// Finds the voxels that a triangle touches.
class Voxels {
 public:
  Voxels(const VoxelGrid& grid, std::int32_t growth)
      : grid_(grid), growth_(growth), per_voxel_(1.0 / grid.size) {}

  template <class Take>
  void of(const exact::Corners& t, Take&& take) const {
    const exact::Box box = exact::box_of(t);
    Int3 first, last;
    for (int k = 0; k < 3; ++k) {
      first[k] = first_reaching(k, box.low[k]);
      last[k] = last_reaching(k, box.high[k]);
    }
    const Int3 n = last - first + 1;
    if (std::int64_t{n.x} * n.y * n.z > kFewVoxels) return rows_of(t, box, first, last, take);
    Int3 v;
    for (v.z = first.z; v.z <= last.z; ++v.z)
      for (v.y = first.y; v.y <= last.y; ++v.y)
        for (v.x = first.x; v.x <= last.x; ++v.x) ask(t, box, v, take);
  }

 private:
  template <class Take>
  void ask(const exact::Corners& t, const exact::Box& box, const Int3& v, Take& take) const {
    if (exact::triangle_touches_cube(t, box, grid_.origin + grid_.size * v - growth_,
                                     grid_.size + 2 * growth_))
      take(v);
  }
  /// floor(steps / size): the quotient plus half a step of it is half a step from every integer, which is far
  /// more than a double rounds.
  std::int32_t floor_voxel(double steps) const {
    return static_cast<std::int32_t>(std::floor((steps + 0.5) * per_voxel_));
  }
  /// The first and last voxels along an axis whose grown, closed cubes hold a coordinate.
  std::int32_t first_reaching(int axis, double at) const {
    return floor_voxel(at - growth_ - grid_.origin[axis] - 1);
  }
  std::int32_t last_reaching(int axis, double at) const {
    return floor_voxel(at + growth_ - grid_.origin[axis]);
  }

  /// Of a triangle with many voxels in its box: seen along its normal's largest component k, the columns that
  /// it covers row by row, and in each the voxels that its plane passes. Doubles only leave out: coordinates
  /// are within 2^29, quotients of normals within 1, so all is off by less than 2^-20 steps, and a step is
  /// spared.
  template <class Take>
  void rows_of(const exact::Corners& t, const exact::Box& box, const Int3& first, const Int3& last,
               Take& take) const {
    const exact::Normal n = exact::raw_normal(t);
    const double normal[3] = {static_cast<double>(n.x), static_cast<double>(n.y), static_cast<double>(n.z)};
    const int k = std::abs(normal[2]) > std::max(std::abs(normal[0]), std::abs(normal[1])) ? 2
                  : std::abs(normal[1]) > std::abs(normal[0])                              ? 1
                                                                                           : 0;
    const int u = (k + 1) % 3, v = (k + 2) % 3;
    const double slope_u = normal[u] / normal[k], slope_v = normal[v] / normal[k];
    const double half = 0.5 * grid_.size + growth_,
                 spread = (std::abs(slope_u) + std::abs(slope_v)) * half + 1;
    Int3 at;
    for (at[v] = first[v]; at[v] <= last[v]; ++at[v]) {
      const double low = grid_.origin[v] + double(grid_.size) * at[v] - growth_,
                   high = low + grid_.size + 2 * growth_;
      double least = std::numeric_limits<double>::infinity(), most = -least;
      for (std::size_t e = 0; e < 3; ++e) {
        const Int3 &p = t[e], &q = t[(e + 1) % 3];
        if (p[v] >= low && p[v] <= high) {
          least = std::min<double>(least, p[u]);
          most = std::max<double>(most, p[u]);
        }
        for (const double line : {low, high}) {
          if ((p[v] < line) == (q[v] < line)) continue;
          const double cut = p[u] + (double(q[u]) - p[u]) * ((line - p[v]) / (double(q[v]) - p[v]));
          least = std::min(least, cut);
          most = std::max(most, cut);
        }
      }
      if (least > most) continue;
      const std::int32_t end = std::min(last[u], last_reaching(u, std::floor(most) + 2));
      for (at[u] = std::max(first[u], first_reaching(u, std::floor(least) - 1)); at[u] <= end; ++at[u]) {
        const double cu = grid_.origin[u] + double(grid_.size) * at[u] + 0.5 * grid_.size, cv = low + half;
        const double height = t[0][k] - slope_u * (cu - t[0][u]) - slope_v * (cv - t[0][v]);
        const std::int32_t top = std::min(last[k], last_reaching(k, std::floor(height + spread) + 1));
        for (at[k] = std::max(first[k], first_reaching(k, std::floor(height - spread))); at[k] <= top;
             ++at[k])
          ask(t, box, at, take);
      }
    }
  }

  const VoxelGrid& grid_;
  std::int32_t growth_;
  double per_voxel_;
};

Result<void> check_grid(const VoxelGrid& grid, const std::string& name) {
  const Int3 b = grid.bricks;
  if (std::max({b.x, b.y, b.z}) > gpu::kMostBricksAlong)
    return bad_value("the " + name + "'s grid has " +
                     std::to_string(std::int64_t{std::max({b.x, b.y, b.z})} * kBrickSide) +
                     " voxels along an axis, at most " + std::to_string(gpu::kMostBricksAlong * kBrickSide) +
                     " are possible: choose a larger voxel");
  if (brick_count(b) > kMostBricks)
    return bad_value("the " + name + "'s grid has " + std::to_string(brick_count(b)) +
                     " bricks of 512 voxels, at most " + std::to_string(kMostBricks) +
                     " are possible: choose a larger voxel");
  return {};
}

std::size_t number_of(const Int3& brick, const Int3& bricks) {
  return static_cast<std::size_t>(brick.x) +
         static_cast<std::size_t>(bricks.x) *
             (static_cast<std::size_t>(brick.y) +
              static_cast<std::size_t>(bricks.y) * static_cast<std::size_t>(brick.z));
}

/// Calls `take` with every triangle that did not collapse, on all cores.
template <class Take>
void for_triangles(const LatticeMesh& mesh, const Take& take) {
  const auto triangles = static_cast<std::uint32_t>(mesh.triangles.size());
  const auto serve = [&](std::uint32_t share) {
    for (std::uint32_t id = share * kTrianglesAShare;
         id < std::min((share + 1) * kTrianglesAShare, triangles); ++id)
      if (!mesh.collapsed(id))
        take(exact::Corners{mesh.corner(id, 0), mesh.corner(id, 1), mesh.corner(id, 2)});
  };
  in_shares((triangles + kTrianglesAShare - 1) / kTrianglesAShare, serve, [](std::uint32_t) { return true; });
}

/// Replaces each number by the sum of those before it, and puts the total behind them.
std::uint64_t sum_up(std::vector<std::uint32_t>& values) {
  std::uint64_t sum = 0;
  for (std::uint32_t& value : values) {
    const std::uint32_t own = value;
    value = static_cast<std::uint32_t>(sum);
    sum += own;
  }
  values.push_back(static_cast<std::uint32_t>(sum));
  return sum;
}

}  // namespace

std::vector<std::uint32_t> touched_bricks(const LatticeMesh& mesh, const VoxelGrid& grid) {
  VoxelGrid coarse = grid;  // a brick as a voxel
  coarse.size = kBrickSide * grid.size;
  const Voxels voxels(coarse, 0);
  std::vector<std::uint32_t> out(brick_count(grid.bricks));
  for_triangles(mesh, [&](const exact::Corners& t) {
    voxels.of(t, [&](const Int3& b) {
      std::atomic_ref(out[number_of(b, grid.bricks)]).store(1, std::memory_order_relaxed);
    });
  });
  return out;
}

std::vector<BrickBits> touched_voxels(const LatticeMesh& mesh, const VoxelGrid& grid,
                                      const std::vector<std::int32_t>& place, std::size_t count) {
  const Voxels voxels(grid, 0);
  std::vector<BrickBits> out(count);
  for_triangles(mesh, [&](const exact::Corners& t) {
    voxels.of(t, [&](const Int3& v) {
      const std::int32_t bit = (v.x & 7) | (v.y & 7) << 3 | (v.z & 7) << 6;
      std::uint32_t& word = out[static_cast<std::size_t>(place[number_of(v >> 3, grid.bricks)])]
                               [static_cast<std::size_t>(bit >> 5)];
      std::atomic_ref(word).fetch_or(1u << (bit & 31), std::memory_order_relaxed);
    });
  });
  return out;
}

Error cancelled() { return Error{ErrorCode::kInternal, "preparation was cancelled"}; }

Result<Partition> list_voxels(const LatticeMesh& mesh, const VoxelGrid& grid, std::int32_t growth,
                              const char* name, const GoOn& go_on) {
  if (auto r = check_grid(grid, name); !r) return r.error();
  Partition out;
  out.grid.origin = grid.origin;
  out.grid.size = grid.size;
  out.grid.bricks = grid.bricks;
  const auto asked = [&](std::uint32_t) { return go_on(); };

  // Each triangle's voxels, and how many entries a brick gets.
  const auto triangles = static_cast<std::uint32_t>(mesh.triangles.size());
  const std::uint32_t shares = (triangles + kTrianglesAShare - 1) / kTrianglesAShare;
  std::vector<std::vector<Entry>> found(shares);
  std::vector<std::uint32_t> slots(brick_count(grid.bricks));
  const Voxels voxels(grid, growth);
  const auto find = [&](std::uint32_t share) {
    std::vector<Entry>& entries = found[share];
    entries.reserve(2 * kTrianglesAShare);
    for (std::uint32_t id = share * kTrianglesAShare;
         id < std::min((share + 1) * kTrianglesAShare, triangles); ++id) {
      if (mesh.collapsed(id)) continue;
      voxels.of({mesh.corner(id, 0), mesh.corner(id, 1), mesh.corner(id, 2)}, [&](const Int3& v) {
        const Int3 b = v >> 3;
        const auto brick = static_cast<std::uint32_t>(b.x + grid.bricks.x * (b.y + grid.bricks.y * b.z));
        entries.push_back(
            {brick, id, static_cast<std::uint16_t>((v.x & 7) | (v.y & 7) << 3 | (v.z & 7) << 6)});
        std::atomic_ref(slots[brick]).fetch_add(1, std::memory_order_relaxed);
      });
    }
  };
  if (!in_shares(shares, find, asked)) return cancelled();

  // Slots in the order of bricks, and room for each one's entries.
  std::vector<std::uint32_t> cursor;  // by slot
  std::uint64_t entries = 0;
  for (std::uint32_t brick = 0; brick < slots.size(); ++brick) {
    const std::uint32_t count = std::exchange(slots[brick], gpu::kBrickExternal);
    if (count == 0) continue;
    slots[brick] = static_cast<std::uint32_t>(cursor.size());
    cursor.push_back(static_cast<std::uint32_t>(entries));
    out.mixed_brick.push_back(brick);
    entries += count;
  }
  out.brick_slot = std::move(slots);
  const auto mixed = static_cast<std::uint32_t>(cursor.size());
  if (entries >= std::numeric_limits<std::uint32_t>::max())
    return bad_value("more than 4294967294 pairs of triangle and voxel: choose a larger voxel");
  if (mixed >= gpu::kMostMixedBricks)
    return bad_value("the " + std::string(name) + "'s surface lies in " + std::to_string(mixed) +
                     " bricks, at most " + std::to_string(gpu::kMostMixedBricks - 1) +
                     " are possible: choose a larger voxel");
  std::vector<std::uint64_t> gathered(entries);  // bit, then triangle
  const auto gather = [&](std::uint32_t share) {
    for (const Entry& entry : found[share])
      gathered[std::atomic_ref(cursor[out.brick_slot[entry.brick]]).fetch_add(1, std::memory_order_relaxed)] =
          std::uint64_t{entry.bit} << 32 | entry.triangle;
    found[share] = {};
  };
  if (!in_shares(shares, gather, asked)) return cancelled();

  // Brick by brick into the order of voxels, then of triangles. A cursor stands at its brick's end now. What
  // was gathered gives way to the lists' lengths.
  out.list_triangles.resize(entries);
  out.bricks.resize(mixed);
  std::vector<std::uint32_t> boundary(mixed);  // voxels of each brick
  const std::uint32_t brick_shares = (mixed + kBricksAShare - 1) / kBricksAShare;
  const auto begin_of = [&](std::uint32_t slot) { return slot == 0 ? 0 : cursor[slot - 1]; };
  const auto sort = [&](std::uint32_t share) {
    for (std::uint32_t slot = share * kBricksAShare; slot < std::min((share + 1) * kBricksAShare, mixed);
         ++slot) {
      const std::uint32_t begin = begin_of(slot), end = cursor[slot];
      std::array<std::uint32_t, 512> place{};
      for (std::uint32_t i = begin; i < end; ++i) ++place[gathered[i] >> 32];
      std::uint32_t at = begin;
      for (std::uint32_t& p : place) at += std::exchange(p, at);
      for (std::uint32_t i = begin; i < end; ++i)
        out.list_triangles[place[gathered[i] >> 32]++] = static_cast<std::uint32_t>(gathered[i]);
      at = begin;
      for (std::uint32_t bit = 0; bit < 512; ++bit) {
        const std::uint32_t length = place[bit] - at;
        if (length == 0) continue;
        std::sort(out.list_triangles.begin() + at, out.list_triangles.begin() + place[bit]);
        out.bricks[slot].boundary[bit >> 5] |= 1u << (bit & 31);
        gathered[begin + boundary[slot]++] = length;
        at = place[bit];
      }
    }
  };
  if (!in_shares(brick_shares, sort, asked)) return cancelled();

  // Numbers of the boundary voxels.
  const auto count = static_cast<std::uint32_t>(sum_up(boundary));
  out.boundary_place.resize(count);
  out.list_begin.resize(std::size_t{count} + 1);
  const auto number = [&](std::uint32_t share) {
    for (std::uint32_t slot = share * kBricksAShare; slot < std::min((share + 1) * kBricksAShare, mixed);
         ++slot) {
      std::uint32_t at = begin_of(slot), voxel = boundary[slot];
      const std::uint64_t* length = gathered.data() + at;
      gpu::Brick& brick = out.bricks[slot];
      for (std::uint32_t word = 0; word < 16; ++word) {
        brick.first[word] = voxel;
        for (std::uint32_t rest = brick.boundary[word]; rest != 0; rest &= rest - 1) {
          out.boundary_place[voxel] =
              slot << 9 | word << 5 | static_cast<std::uint32_t>(std::countr_zero(rest));
          out.list_begin[voxel++] = at;
          at += static_cast<std::uint32_t>(*length++);
        }
      }
    }
  };
  if (!in_shares(brick_shares, number, asked)) return cancelled();
  out.list_begin[count] = static_cast<std::uint32_t>(entries);
  out.grid.mixed_bricks = mixed;
  out.grid.boundary_voxels = count;
  out.grid.list_entries = static_cast<std::uint32_t>(entries);
  out.mixed_brick.shrink_to_fit();
  return out;
}

Result<Partition> make_partition(const LatticeMesh& mesh, const VoxelGrid& grid, std::int32_t growth,
                                 const char* name, const GoOn& go_on) {
  auto out = list_voxels(mesh, grid, growth, name, go_on);
  if (out && !classify(mesh, go_on, *out)) return cancelled();
  return out;
}

}  // namespace palpate::native
