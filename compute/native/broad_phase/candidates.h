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

/// The lists of Candidates, by number.
inline constexpr std::uint32_t kCandidateTouch = 0, kCandidatePairs = 1, kCandidateSwallowed = 2,
                               kCandidateChunks = 3, kCandidateInside = 4, kCandidateOpen = 5;

/// A list that the search fills for one frame, in memory of the engine's.
template <class T>
struct WorkList {
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
struct Candidates {
  WorkList<TouchCandidate> touch;
  WorkList<PairCandidate> pairs;
  WorkList<std::uint32_t> swallowed;   ///< runs of tool triangles that lie in V_int voxels alone
  WorkList<gpu::SampleChunk> samples;  ///< where samples are not listed
  WorkList<gpu::FrameSample> inside,
      open;  ///< where they are: what the tool's fine partition has inside, and what it leaves open
  std::uint32_t full = gpu::kNone;  ///< the kCandidate… that had no room; the search ended there

  /// As WorkList::push; notes `list` as full.
  template <class T>
  bool push(WorkList<T>& to, std::uint32_t list, const T& item) {
    if (to.push(item)) return true;
    full = list;
    return false;
  }
};

}  // namespace palpate
