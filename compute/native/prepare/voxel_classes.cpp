// Classes of the voxels that are not boundary: bits of a brick flooded eight planes at a time, pieces joined
// over bricks' faces, ballots counted line by line from the far end of the grid.
#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <vector>

#include "compute/native/prepare/partition_build.h"
#include "compute/scene/exact.h"
#include "compute/scene/shares.h"

namespace palpate::native {
namespace {

using Bits = std::array<std::uint64_t, 8>;  // of a brick, by z: bit x + 8y

constexpr std::uint64_t kFirstX = 0x0101010101010101u, kLastX = kFirstX << 7;
constexpr std::uint32_t kBricksAShare = 256, kTrianglesAShare = 1u << 13;  // chosen: milliseconds

Bits boundary_of(const gpu::Brick& brick) {
  Bits out;
  for (std::size_t z = 0; z < 8; ++z)
    out[z] = brick.boundary[2 * z] | std::uint64_t{brick.boundary[2 * z + 1]} << 32;
  return out;
}

/// All of `free` that hangs together through faces with its first bit.
Bits flooded(const Bits& free) {
  Bits out{};
  for (std::size_t z = 0; z < 8; ++z)
    if (free[z] != 0) {
      out[z] = free[z] & (~free[z] + 1);
      break;
    }
  const auto grown = [&](std::size_t z, std::uint64_t from) {
    std::uint64_t m = (out[z] | from) & free[z];
    for (;;) {
      const std::uint64_t more = (m | (m << 1 & ~kFirstX) | (m >> 1 & ~kLastX) | m << 8 | m >> 8) & free[z];
      if (more == m) return m;
      m = more;
    }
  };
  for (bool changed = true; changed;) {  // up and down again
    changed = false;
    const auto take = [&](std::size_t z, std::uint64_t from) {
      const std::uint64_t m = grown(z, from);
      changed = changed || m != out[z];
      out[z] = m;
    };
    for (std::size_t z = 0; z < 8; ++z) take(z, z == 0 ? 0 : out[z - 1]);
    for (std::size_t z = 8; z-- > 0;) take(z, z == 7 ? 0 : out[z + 1]);
  }
  return out;
}

/// Sets that grow by being joined, on all threads; the smallest member stands for its set.
class Joined {
 public:
  explicit Joined(std::size_t count) : parent_(count) {
    for (std::size_t i = 0; i < count; ++i) parent_[i] = static_cast<std::uint32_t>(i);
  }
  std::uint32_t root(std::uint32_t i) {
    for (;;) {
      const std::uint32_t up = at(i).load(std::memory_order_relaxed);
      if (up == i) return i;
      const std::uint32_t above = at(up).load(std::memory_order_relaxed);
      if (above != up) at(i).store(above, std::memory_order_relaxed);  // only ever closer to the root
      i = up;
    }
  }
  void join(std::uint32_t a, std::uint32_t b) {
    for (;;) {
      a = root(a);
      b = root(b);
      if (a == b) return;
      if (a < b) std::swap(a, b);
      std::uint32_t own = a;
      if (at(a).compare_exchange_strong(own, b, std::memory_order_relaxed)) return;
    }
  }

 private:
  std::atomic_ref<std::uint32_t> at(std::uint32_t i) { return std::atomic_ref(parent_[i]); }
  std::vector<std::uint32_t> parent_;
};

class Classifier {
 public:
  Classifier(const LatticeMesh& mesh, const GoOn& go_on, Partition& partition)
      : mesh_(mesh), go_on_(go_on), p_(partition), bricks_(partition.brick_slot.size()) {}

  bool run() { return find_pieces() && join_pieces() && count_ballots() && set_classes(); }

 private:
  bool find_pieces();
  bool join_pieces();
  bool count_ballots();
  bool add_crossings(std::uint32_t axis);
  bool sweep(std::uint32_t axis);
  void sweep_line_of_bricks(std::uint32_t axis, std::size_t line);
  bool set_classes();
  template <class Work>
  bool by_bricks(std::uint32_t count, Work&& work) {
    return in_shares((count + kBricksAShare - 1) / kBricksAShare,
                     [&](std::uint32_t share) {
                       for (std::uint32_t i = share * kBricksAShare;
                            i < std::min((share + 1) * kBricksAShare, count); ++i)
                         work(i);
                     },
                     [&](std::uint32_t) { return go_on_(); });
  }
  std::uint32_t number(const Int3& b) const {
    return static_cast<std::uint32_t>(b.x + p_.grid.bricks.x * (b.y + p_.grid.bricks.y * b.z));
  }
  /// Calls visit(piece of a, piece of b) for pieces of two neighbours along an axis that share a face of
  /// voxels. A brick without boundary is one piece.
  template <class Visit>
  void for_touching(std::uint32_t a, std::uint32_t b, int axis, Visit&& visit) const;

  const LatticeMesh& mesh_;
  const GoOn& go_on_;
  Partition& p_;
  std::size_t bricks_;
  /// Pieces: bricks without boundary by their numbers, then those of mixed bricks, slot by slot.
  std::vector<std::uint32_t> piece_begin_;  ///< by slot in bits_, and one more
  std::vector<Bits> bits_;                  ///< of the pieces of mixed bricks
  std::vector<std::uint32_t> enclosed_;     ///< by piece: 0 V_ext, else 1 + number of its component
  struct Vote {
    std::uint64_t cast = 0, non_zero = 0;
  };
  std::vector<Vote> votes_;              ///< by enclosed component
  std::vector<std::int32_t> crossings_;  ///< by boundary voxel: net sign of what its middle line along the
                                         ///< axis at hand crosses in it
};

/// What hangs together within each mixed brick.
bool Classifier::find_pieces() {
  const auto slots = static_cast<std::uint32_t>(p_.bricks.size());
  const std::uint32_t shares = (slots + kBricksAShare - 1) / kBricksAShare;
  std::vector<std::vector<Bits>> found(shares);
  piece_begin_.assign(std::size_t{slots} + 1, 0);
  const bool done = in_shares(
      shares,
      [&](std::uint32_t share) {
        for (std::uint32_t slot = share * kBricksAShare; slot < std::min((share + 1) * kBricksAShare, slots);
             ++slot) {
          Bits free = boundary_of(p_.bricks[slot]);
          for (std::uint64_t& plane : free) plane = ~plane;
          while (std::any_of(free.begin(), free.end(), [](std::uint64_t plane) { return plane != 0; })) {
            const Bits piece = flooded(free);
            for (std::size_t z = 0; z < 8; ++z) free[z] &= ~piece[z];
            found[share].push_back(piece);
            ++piece_begin_[slot + 1];
          }
        }
      },
      [&](std::uint32_t) { return go_on_(); });
  for (std::size_t slot = 0; slot < slots; ++slot) piece_begin_[slot + 1] += piece_begin_[slot];
  bits_.reserve(piece_begin_.back());
  for (std::vector<Bits>& some : found) {
    bits_.insert(bits_.end(), some.begin(), some.end());
    some = {};
  }
  return done;
}

template <class Visit>
void Classifier::for_touching(std::uint32_t a, std::uint32_t b, int axis, Visit&& visit) const {
  static const Bits all{~0ull, ~0ull, ~0ull, ~0ull, ~0ull, ~0ull, ~0ull, ~0ull};
  const auto touch = [&](const Bits& from, const Bits& to) {
    if (axis == 2) return (from[7] & to[0]) != 0;
    std::uint64_t common = 0;
    for (std::size_t z = 0; z < 8; ++z)
      common |= axis == 0 ? from[z] >> 7 & to[z] & kFirstX : from[z] >> 56 & to[z];
    return common != 0;
  };
  const auto for_pieces = [&](std::uint32_t brick, auto&& take) {
    const std::uint32_t slot = p_.brick_slot[brick];
    if (slot >= gpu::kBrickInternal) return take(brick, all);
    for (std::uint32_t i = piece_begin_[slot]; i < piece_begin_[slot + 1]; ++i)
      take(static_cast<std::uint32_t>(bricks_) + i, bits_[i]);
  };
  for_pieces(a, [&](std::uint32_t piece_a, const Bits& bits_a) {
    for_pieces(b, [&](std::uint32_t piece_b, const Bits& bits_b) {
      if (touch(bits_a, bits_b)) visit(piece_a, piece_b);
    });
  });
}

/// Joins pieces over bricks' faces, and numbers the components that do not reach the border.
bool Classifier::join_pieces() {
  const Int3 n = p_.grid.bricks;
  const std::size_t pieces = bricks_ + bits_.size();
  Joined joined(pieces);
  const auto rows = static_cast<std::uint32_t>(n.y * n.z);
  const bool done = by_bricks(rows, [&](std::uint32_t row) {
    Int3 b(0, static_cast<std::int32_t>(row) % n.y, static_cast<std::int32_t>(row) / n.y);
    for (; b.x < n.x; ++b.x)
      for (int axis = 0; axis < 3; ++axis) {
        Int3 next = b;
        if (++next[axis] < n[axis])
          for_touching(number(b), number(next), axis,
                       [&](std::uint32_t i, std::uint32_t k) { joined.join(i, k); });
      }
  });
  if (!done) return false;
  // The grid's outermost layer has no boundary voxel, so all of it hangs together with the first voxel: its
  // piece is the first of its brick.
  const std::uint32_t slot = p_.brick_slot[0];
  const std::uint32_t outside =
      joined.root(slot >= gpu::kBrickInternal ? 0 : static_cast<std::uint32_t>(bricks_) + piece_begin_[slot]);
  enclosed_.assign(pieces, 0);
  std::uint32_t components = 0;
  for (std::uint32_t i = 0; i < pieces; ++i) {  // a set's smallest member comes first
    if (i < bricks_ && p_.brick_slot[i] < gpu::kBrickInternal) continue;  // in pieces
    const std::uint32_t root = joined.root(i);
    if (root == outside) continue;
    enclosed_[i] = root == i ? ++components : enclosed_[root];
  }
  votes_.assign(components, Vote{});
  return true;
}

/// For each boundary voxel the signs of what its middle line along an axis crosses in it, of the perturbed
/// point (docs/EXACTNESS.md section 1): beside others that lie on the same line, it is the same for all.
bool Classifier::add_crossings(std::uint32_t axis) {
  crossings_.assign(p_.grid.boundary_voxels, 0);
  const gpu::GridConstants& grid = p_.grid;
  const int k = static_cast<int>(axis), iu = (k + 1) % 3, iv = (k + 2) % 3;
  const double per_voxel = 1.0 / grid.size;
  const std::int32_t middle_u = grid.origin[iu] + grid.size / 2, middle_v = grid.origin[iv] + grid.size / 2;
  // Half a step from every integer quotient.
  const auto first_line = [&](std::int32_t from) {
    return static_cast<std::int32_t>(std::ceil((from - 0.5) * per_voxel));
  };
  const auto last_line = [&](std::int32_t to) {
    return static_cast<std::int32_t>(std::floor((to + 0.5) * per_voxel));
  };
  // The side of an edge that a perturbed point on it lies on: of D × (q − p) the first component that is not
  // 0, for D along the axis.
  const auto on_edge = [&](std::int64_t du, std::int64_t dv) {
    return axis == 1 ? (du != 0 ? exact::sign(du) : -exact::sign(dv))
                     : (dv != 0 ? -exact::sign(dv) : exact::sign(du));
  };
  const auto triangles = static_cast<std::uint32_t>(mesh_.triangles.size());
  const auto add = [&](std::uint32_t id) {
    const exact::Corners t{mesh_.corner(id, 0), mesh_.corner(id, 1), mesh_.corner(id, 2)};
    const auto [low_u, high_u] = std::minmax({t[0][iu], t[1][iu], t[2][iu]});
    const auto [low_v, high_v] = std::minmax({t[0][iv], t[1][iv], t[2][iv]});
    const std::int32_t u0 = first_line(low_u - middle_u), u1 = last_line(high_u - middle_u),
                       v0 = first_line(low_v - middle_v), v1 = last_line(high_v - middle_v);
    if (u0 > u1 || v0 > v1) return;
    const exact::Normal n = exact::raw_normal(t);
    const std::int64_t parts[3] = {n.x, n.y, n.z};
    const int facing = exact::sign(parts[k]);
    if (facing == 0) return;
    Int3 voxel;
    for (voxel[iv] = v0; voxel[iv] <= v1; ++voxel[iv])
      for (voxel[iu] = u0; voxel[iu] <= u1; ++voxel[iu]) {
        const std::int64_t u = middle_u + std::int64_t{grid.size} * voxel[iu],
                           v = middle_v + std::int64_t{grid.size} * voxel[iv];
        bool within = true;
        for (std::size_t e = 0; e < 3 && within; ++e) {
          const Int3 &p = t[e], &q = t[(e + 1) % 3];
          const std::int64_t du = std::int64_t{q[iu]} - p[iu], dv = std::int64_t{q[iv]} - p[iv],
                             side = du * (v - p[iv]) - dv * (u - p[iu]);  // within 2^60
          within = (side != 0 ? exact::sign(side) : on_edge(du, dv)) == facing;
        }
        if (!within) continue;
        // The crossing's voxel: its place is a_k − (N_u (u − a_u) + N_v (v − a_v)) / N_k. Doubles know the
        // quotient to less than 2^-20 steps; near a face the division is exact. On a face the voxels on both
        // sides are boundary, and every other one of the line lies on the same side of both.
        const exact::Wide over =
            exact::Wide{parts[iu]} * (u - t[0][iu]) + exact::Wide{parts[iv]} * (v - t[0][iv]);
        const double along =
            (double(t[0][k]) - grid.origin[k] - static_cast<double>(over) / static_cast<double>(parts[k])) *
            per_voxel;
        voxel[k] = static_cast<std::int32_t>(std::floor(along));
        if (std::abs(along - std::round(along)) * grid.size < 0x1p-10) {
          const exact::Wide steps =
                                (exact::Wide{t[0][k]} - grid.origin[k]) * (facing * parts[k]) - facing * over,
                            under = exact::Wide{grid.size} * (facing * parts[k]);
          voxel[k] = static_cast<std::int32_t>(steps / under);  // neither is negative
        }
        const Int3 b = voxel >> 3;
        const auto bit = static_cast<std::uint32_t>((voxel.x & 7) | (voxel.y & 7) << 3 | (voxel.z & 7) << 6);
        const gpu::Brick& brick = p_.bricks[p_.brick_slot[number(b)]];
        const std::uint32_t boundary =
            brick.first[bit >> 5] +
            static_cast<std::uint32_t>(std::popcount(brick.boundary[bit >> 5] & ((1u << (bit & 31)) - 1)));
        std::atomic_ref(crossings_[boundary]).fetch_add(facing, std::memory_order_relaxed);
      }
  };
  return in_shares((triangles + kTrianglesAShare - 1) / kTrianglesAShare,
                   [&](std::uint32_t share) {
                     for (std::uint32_t id = share * kTrianglesAShare;
                          id < std::min((share + 1) * kTrianglesAShare, triangles); ++id)
                       if (!mesh_.collapsed(id)) add(id);
                   },
                   [&](std::uint32_t) { return go_on_(); });
}

/// The ballots of all enclosed voxels along an axis, of 64 lines of voxels at once.
void Classifier::sweep_line_of_bricks(std::uint32_t axis, std::size_t line) {
  const Int3 n = p_.grid.bricks;
  const int k = static_cast<int>(axis), iu = (k + 1) % 3, iv = (k + 2) % 3;
  Int3 b;
  b[iu] = static_cast<std::int32_t>(line % static_cast<std::size_t>(n[iu]));
  b[iv] = static_cast<std::int32_t>(line / static_cast<std::size_t>(n[iu]));
  const auto encloses = [&](std::uint32_t brick) {
    const std::uint32_t slot = p_.brick_slot[brick];
    if (slot >= gpu::kBrickInternal) return enclosed_[brick] != 0;
    return std::any_of(enclosed_.begin() + static_cast<std::ptrdiff_t>(bricks_ + piece_begin_[slot]),
                       enclosed_.begin() + static_cast<std::ptrdiff_t>(bricks_ + piece_begin_[slot + 1]),
                       [](std::uint32_t component) { return component != 0; });
  };
  std::int32_t first = 0;  // behind it nobody asks
  for (b[k] = 0; first < n[k] && !encloses(number(b)); b[k] = ++first) {
  }
  if (first == n[k]) return;

  // A brick's bits in the order of the axis: `place` of a bit is 64 · (along the axis) + line.
  const auto place = [&](std::uint32_t bit) {
    const std::uint32_t c[3] = {bit & 7, bit >> 3 & 7, bit >> 6};
    return c[axis] << 6 | c[(axis + 1) % 3] | c[(axis + 2) % 3] << 3;
  };
  std::array<std::int32_t, 64> winding{};  // of what lies ahead of the brick at hand
  for (b[k] = n[k] - 1; b[k] >= first; --b[k]) {
    const std::uint32_t brick = number(b), slot = p_.brick_slot[brick];
    if (slot >= gpu::kBrickInternal) {
      if (enclosed_[brick] == 0) continue;
      const auto lines = static_cast<std::uint64_t>(
          std::count_if(winding.begin(), winding.end(), [](std::int32_t w) { return w != 0; }));
      std::atomic_ref(votes_[enclosed_[brick] - 1].non_zero).fetch_add(8 * lines, std::memory_order_relaxed);
      continue;
    }
    std::array<std::int32_t, 512> crossed{};
    const gpu::Brick& mixed = p_.bricks[slot];
    for (std::uint32_t word = 0; word < 16; ++word) {
      std::uint32_t boundary = mixed.first[word];
      for (std::uint32_t rest = mixed.boundary[word]; rest != 0; rest &= rest - 1)
        crossed[place(word << 5 | static_cast<std::uint32_t>(std::countr_zero(rest)))] =
            crossings_[boundary++];
    }
    Bits non_zero{};
    for (std::uint32_t at = 8; at-- > 0;)
      for (std::uint32_t l = 0; l < 64; ++l) {
        winding[l] += crossed[at << 6 | l];
        if (winding[l] == 0) continue;
        const std::uint32_t u = l & 7, v = l >> 3;
        const std::uint32_t bit = axis == 0   ? at | u << 3 | v << 6
                                  : axis == 1 ? v | at << 3 | u << 6
                                              : u | v << 3 | at << 6;
        non_zero[bit >> 6] |= std::uint64_t{1} << (bit & 63);
      }
    for (std::uint32_t i = piece_begin_[slot]; i < piece_begin_[slot + 1]; ++i) {
      const std::uint32_t component = enclosed_[bricks_ + i];
      if (component == 0) continue;
      std::uint64_t count = 0;
      for (std::size_t z = 0; z < 8; ++z)
        count += static_cast<std::uint64_t>(std::popcount(bits_[i][z] & non_zero[z]));
      std::atomic_ref(votes_[component - 1].non_zero).fetch_add(count, std::memory_order_relaxed);
    }
  }
}

bool Classifier::sweep(std::uint32_t axis) {
  constexpr std::size_t kLinesAShare = 64;
  const Int3 n = p_.grid.bricks;
  const std::size_t lines = static_cast<std::size_t>(n[static_cast<int>((axis + 1) % 3)]) *
                            static_cast<std::size_t>(n[static_cast<int>((axis + 2) % 3)]);
  return in_shares(
      static_cast<std::uint32_t>((lines + kLinesAShare - 1) / kLinesAShare),
      [&](std::uint32_t share) {
        for (std::size_t line = share * kLinesAShare; line < std::min((share + 1) * kLinesAShare, lines);
             ++line)
          sweep_line_of_bricks(axis, line);
      },
      [&](std::uint32_t) { return go_on_(); });
}

bool Classifier::count_ballots() {
  if (votes_.empty()) return true;
  const std::uint32_t axes = mesh_.closed ? 1 : 3;
  for (std::size_t i = 0; i < enclosed_.size(); ++i) {
    if (enclosed_[i] == 0) continue;
    std::uint64_t voxels = 512;
    if (i >= bricks_) {
      voxels = 0;
      for (const std::uint64_t plane : bits_[i - bricks_])
        voxels += static_cast<std::uint64_t>(std::popcount(plane));
    }
    votes_[enclosed_[i] - 1].cast += axes * voxels;
  }
  for (std::uint32_t axis = 0; axis < axes; ++axis)
    if (!add_crossings(axis) || !sweep(axis)) return false;
  return true;
}

bool Classifier::set_classes() {
  const auto internal = [&](std::size_t piece) {
    const std::uint32_t component = enclosed_[piece];
    return component != 0 &&
           votes_[component - 1].non_zero > votes_[component - 1].cast - votes_[component - 1].non_zero;
  };
  p_.has_internal = false;
  for (std::size_t brick = 0; brick < bricks_; ++brick) {
    const std::uint32_t slot = p_.brick_slot[brick];
    if (slot >= gpu::kBrickInternal) {
      p_.brick_slot[brick] = internal(brick) ? gpu::kBrickInternal : gpu::kBrickExternal;
      p_.has_internal = p_.has_internal || internal(brick);
      continue;
    }
    gpu::Brick& mixed = p_.bricks[slot];
    for (std::uint32_t i = piece_begin_[slot]; i < piece_begin_[slot + 1]; ++i) {
      if (!internal(bricks_ + i)) continue;
      p_.has_internal = true;
      for (std::size_t word = 0; word < 16; ++word)
        mixed.internal_[word] |= static_cast<std::uint32_t>(bits_[i][word >> 1] >> 32 * (word & 1));
    }
  }
  return go_on_();
}

}  // namespace

bool classify(const LatticeMesh& mesh, const GoOn& go_on, Partition& partition) {
  return Classifier(mesh, go_on, partition).run();
}

}  // namespace palpate::native
