#include "compute/native/narrow_phase/open_shells.h"

#include <algorithm>
#include <atomic>
#include <optional>

#include "compute/scene/shares.h"

namespace palpate {
namespace {

constexpr int kNearWalk = 8;                // voxels (docs/EXACTNESS.md section 4)
constexpr std::size_t kVoxelsAnInside = 8;  // of them one at least is in a shell, …
constexpr std::size_t kVoxelsADoubt = 16;  // … or one at most in doubt, of what bounds an inside (section 4)
constexpr std::uint32_t kVoxelsAShare = 1024;  // chosen

/// Calls take(voxel, boundary) for every V_bnd voxel, on all cores. False: `go_on` said stop.
template <class Take>
bool for_boundary(const PartitionView& view, const OpenShells::GoOn& go_on, Take&& take) {
  const std::uint32_t voxels = view.grid.boundary_voxels;
  return in_shares((voxels + kVoxelsAShare - 1) / kVoxelsAShare,
                   [&](std::uint32_t share) {
                     const std::uint32_t end = std::min(voxels, (share + 1) * kVoxelsAShare);
                     for (std::uint32_t boundary = share * kVoxelsAShare; boundary < end; ++boundary)
                       take(view.boundary_voxel(boundary), boundary);
                   },
                   [&](std::uint32_t) { return go_on(); });
}

/// What is known while shells are counted.
struct Counting {
  const PartitionLookup& partition;
  const std::vector<OpenShells::Halves>& halves;
  const std::vector<std::int32_t>& middle;  ///< once walks have told

  /// What the way from a voxel's middle to its face at the end of an axis crosses.
  std::int32_t half(const PartitionLookup::Voxel& voxel, int axis, bool up) const {
    return voxel.boundary == gpu::kNoVoxel
               ? 0
               : halves[voxel.boundary][static_cast<std::size_t>(2 * axis + (up ? 0 : 1))];
  }

  /// The least that walks from a V_bnd voxel's middle say, the near ones if there are any.
  std::int32_t by_walks(const Int3& voxel, std::uint32_t boundary) const {
    std::optional<std::int32_t> of_near, of_all;
    const auto lower = [](std::optional<std::int32_t>& least, std::int32_t said) {
      least = std::min(least.value_or(said), said);
    };
    for (int axis = 0; axis < 3; ++axis)
      for (const bool up : {true, false}) {
        Int3 at = voxel;
        std::int32_t said = half({gpu::kVoxelBoundary, boundary}, axis, up);
        for (int length = 1;; ++length) {
          at[axis] += up ? 1 : -1;
          const PartitionLookup::Voxel there = partition.at(at);
          if (there.boundary != gpu::kNoVoxel) {
            said += half(there, axis, up) - half(there, axis, !up);
            continue;
          }
          said += there.kind == gpu::kVoxelInternal ? 1 : 0;
          lower(of_all, said);
          if (length <= kNearWalk) lower(of_near, said);
          break;
        }
      }
    return of_near ? *of_near : *of_all;
  }

  std::int32_t shells(const PartitionLookup::Voxel& voxel) const {
    return voxel.boundary != gpu::kNoVoxel     ? middle[voxel.boundary]
           : voxel.kind == gpu::kVoxelInternal ? 1
                                               : 0;
  }

  /// By how much more shells a voxel's middle is in as the next one up an axis sees it than as it sees
  /// itself.
  std::int32_t jump(const PartitionLookup::Voxel& voxel, const PartitionLookup::Voxel& next, int axis) const {
    return shells(next) + half(voxel, axis, true) - half(next, axis, false) - shells(voxel);
  }

  /// Whether anything jumps at one of a V_bnd voxel's upper faces, or at a lower one beyond which no voxel is
  /// asked itself.
  bool jumps(const Int3& voxel) const {
    const PartitionLookup::Voxel here = partition.at(voxel);
    for (int axis = 0; axis < 3; ++axis) {
      Int3 up = voxel, down = voxel;
      ++up[axis];
      --down[axis];
      if (jump(here, partition.at(up), axis) != 0) return true;
      const PartitionLookup::Voxel below = partition.at(down);
      if (below.boundary == gpu::kNoVoxel && jump(below, here, axis) != 0) return true;
    }
    return false;
  }
};

constexpr int kOwn = 13;

/// A voxel's neighbours, and itself, by their bits.
Int3 neighbour(int number) { return {number % 3 - 1, number / 3 % 3 - 1, number / 9 - 1}; }

struct Neighbours {
  const Counting& counting;
  std::array<PartitionLookup::Voxel, 27> at;

  Neighbours(const Counting& known, const Int3& voxel) : counting(known) {
    for (int number = 0; number < 27; ++number)
      at[static_cast<std::size_t>(number)] = counting.partition.at(voxel + neighbour(number));
  }
  /// By how much more shells the voxel's middle is in as a neighbour sees it than as it sees itself: what
  /// jumps along the way between them, from the first of the two in the grid.
  std::int32_t seen(int number) const {
    const bool first = number > kOwn;
    int from = first ? kOwn : number;
    const int end = first ? number : kOwn;
    std::int32_t sum = 0;
    for (int axis = 0, stride = 1; axis < 3; ++axis, stride *= 3) {
      const int step = end / stride % 3 - from / stride % 3, next = from + step * stride;
      if (step != 0)
        sum += step * counting.jump(at[static_cast<std::size_t>(std::min(from, next))],
                                    at[static_cast<std::size_t>(std::max(from, next))], axis);
      from = next;
    }
    return first ? sum : -sum;
  }
};

}  // namespace

bool OpenShells::bounds_inside() const {
  const auto inside = static_cast<std::size_t>(
      std::ranges::count_if(middle_, [](std::int32_t shells) { return shells > 0; }));
  const auto doubted = static_cast<std::size_t>(
      std::ranges::count_if(doubts_, [](const Doubts& of) { return (of.less | of.more) != 0; }));
  return kVoxelsAnInside * inside >= middle_.size() || kVoxelsADoubt * doubted <= middle_.size();
}

std::optional<OpenShells> OpenShells::make(const PartitionView& view, const Ask& ask, const GoOn& go_on) {
  const PartitionLookup partition(view);
  const std::uint32_t voxels = view.grid.boundary_voxels;
  OpenShells out;
  std::vector<Halves> halves(voxels);
  const Counting counting{partition, halves, out.middle_};
  if (!for_boundary(view, go_on, [&](const Int3& voxel, std::uint32_t boundary) {
        halves[boundary] = ask(voxel, boundary);
      }))
    return std::nullopt;
  out.middle_.resize(voxels);
  if (!for_boundary(view, go_on, [&](const Int3& voxel, std::uint32_t boundary) {
        out.middle_[boundary] = counting.by_walks(voxel, boundary);
      }))
    return std::nullopt;
  // What a neighbour sees otherwise jumps at a face on the way to it: few voxels are near such a place.
  std::vector<std::uint8_t> near(voxels, 0);
  if (!for_boundary(view, go_on, [&](const Int3& voxel, std::uint32_t) {
        if (!counting.jumps(voxel)) return;
        for (int number = 0; number < 27; ++number)
          if (const std::uint32_t there = partition.at(voxel + neighbour(number)).boundary;
              there != gpu::kNoVoxel)
            std::atomic_ref(near[there]).store(1, std::memory_order_relaxed);
      }))
    return std::nullopt;
  if (std::ranges::find(near, 1) == near.end()) return out;
  out.doubts_.resize(voxels);
  if (!for_boundary(view, go_on, [&](const Int3& voxel, std::uint32_t boundary) {
        if (near[boundary] == 0) return;
        const Neighbours neighbours(counting, voxel);
        for (int number = 0; number < 27; ++number) {
          const std::int32_t seen = neighbours.seen(number);
          if (seen < 0) out.doubts_[boundary].less |= 1u << number;
          if (seen > 0) out.doubts_[boundary].more |= 1u << number;
        }
      }))
    return std::nullopt;
  return out;
}

}  // namespace palpate
