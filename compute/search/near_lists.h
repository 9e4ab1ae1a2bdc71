#pragma once
#include <cstdint>
#include <span>

#include "shaders/shared/frame.h"

namespace palpate {

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
  HostList<gpu::TouchCandidate> touch;
  HostList<gpu::PairCandidate> pairs;
  HostList<gpu::SampleChunk> samples;  ///< where samples are not listed
  HostList<gpu::FrameSample> inside,
      open;  ///< where they are: what the tool's fine partition has inside, and what it leaves open
  std::uint32_t full = gpu::kNone;  ///< the kList… that had no room; the search ended there

  /// As HostList::push; notes `list` as full.
  template <class T>
  bool push(HostList<T>& to, std::uint32_t list, const T& item) {
    if (to.push(item)) return true;
    full = list;
    return false;
  }
};

}  // namespace palpate
