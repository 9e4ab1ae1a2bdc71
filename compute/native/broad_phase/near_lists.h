#pragma once
#include <cstdint>
#include <span>

#include "shaders/shared/frame.h"

namespace palpate {

/// A tool triangle that comes near a voxel that is V_bnd or V_int.
struct TouchCandidate {
  std::uint32_t place;     ///< in the order of clusters
  std::uint32_t boundary;  ///< number of the V_bnd voxel; gpu::kNoVoxel: V_int
  std::int32_t xy;         ///< voxel x + 2^16 · voxel y
  std::int32_t z;  ///< with kWholeBrick: the voxel is the first one of a brick that is all V_int, and stands
                   ///< for it
};
inline constexpr std::int32_t kWholeBrick = 1 << 30;

/// Two triangles whose boxes meet.
struct PairCandidate {
  std::uint32_t static_id;
  std::uint32_t place;  ///< of the tool triangle, in the order of clusters
};

/// The lists of NearLists, by number.
inline constexpr std::uint32_t kNearTouch = 0, kNearPairs = 1, kNearChunks = 2, kNearInside = 3,
                               kNearOpen = 4;

/// A list that the search fills for one frame, in memory of the engine's.
template <class T>
struct HostList {
  std::span<T> room;
  std::uint32_t count = 0;
  /// False: there is no room.
  bool push(const T& item) {
    if (count == room.size()) return false;
    room[count++] = item;
    return true;
  }
};

/// What the search finds near at a pose: all that the engine then decides exactly. Errs only towards "may
/// meet".
struct NearLists {
  HostList<TouchCandidate> touch;
  HostList<PairCandidate> pairs;
  HostList<gpu::SampleChunk> samples;  ///< where samples are not listed
  HostList<gpu::FrameSample> inside,
      open;  ///< where they are: what the tool's fine partition has inside, and what it leaves open
  std::uint32_t full = gpu::kNone;  ///< the kNear… that had no room; the search ended there

  /// As HostList::push; notes `list` as full.
  template <class T>
  bool push(HostList<T>& to, std::uint32_t list, const T& item) {
    if (to.push(item)) return true;
    full = list;
    return false;
  }
};

}  // namespace palpate
