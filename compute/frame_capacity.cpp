#include "compute/frame_capacity.h"

#include <algorithm>
#include <bit>

namespace palpate {
namespace {

using namespace gpu;   // names of shaders/shared/frame.h

// Chosen: a frame of 100,000 by 2,000 triangles in deep contact uses a tenth of them; they begin with what a binding of 128 MiB
// holds at most.
constexpr std::uint64_t kSmallList = 1u << 17;
constexpr std::uint64_t kLargeList = 1u << 20;
constexpr std::uint64_t kMostPairs = 1u << 22;
constexpr std::uint64_t kBinEntries = 12;   // a triangle, on average

/// Tables and the bins, which are no lists: their names and the bits that say they are full.
struct Other {
  const char* name;
  std::uint32_t overflow;
  std::uint32_t FrameCapacity::*capacity;
};
constexpr std::array<Other, 2> kOthers = {{{"needle table", kOverflowNeedleTable, &FrameCapacity::needle_table},
                                           {"bins of the tool's shadow", kOverflowBins, &FrameCapacity::bin_entries}}};

constexpr std::array<const char*, 18> kListNames = {
    "bricks of near triangles", "", "voxels to touch", "touched voxels", "samples found inside", "lists of touched voxels",
    "pairs to test", "pairs", "contact triangles of the mock-up", "contact triangles of the tool", "lists with samples",
    "samples near the tool's surface", "samples", "tool triangles of areas", "pierced areas", "",
    "tiles of tool samples", "needle vertices"};
static_assert(kListMobileTiles == 16 && kListNeedleVertices == 17);

std::uint32_t items(std::uint64_t wanted, std::uint64_t most) {
  return static_cast<std::uint32_t>(std::clamp<std::uint64_t>(wanted, 1, most));
}

std::uint32_t doubled(std::uint32_t capacity) {
  return static_cast<std::uint32_t>(std::min<std::uint64_t>(2 * std::uint64_t{capacity}, ~0u));
}

}  // namespace

FrameCapacity FrameCapacity::first(const SceneConstants& scene, const std::map<std::string, std::uint32_t>& wanted) {
  const bool refined = scene.refined != 0;
  const std::uint64_t tool = scene.tool.triangles, voxels = scene.mockup.grid.boundary_voxels, entries = scene.mockup.grid.list_entries;
  const std::uint64_t pairs = std::clamp<std::uint64_t>(32 * tool, 2 * kSmallList, kMostPairs);
  FrameCapacity out;
  auto& l = out.lists;
  l[kListNearTriangles] = items(std::max(kSmallList, 8 * tool), kMostPairs);
  l[kListTouchCandidates] = items(std::max(kLargeList, 32 * tool), kMostPairs);
  l[kListTouchedVoxels] = items(voxels, kLargeList);
  l[kListStaticChunks] = items(voxels + entries / kStaticChunk, kLargeList);
  l[kListPairCandidates] = items(pairs, kMostPairs);
  l[kListPairs] = items(pairs, kMostPairs);
  l[kListContactStatics] = items(scene.mockup.triangles, kLargeList);
  l[kListContactMobiles] = items(tool, ~0u);
  l[kListSampleChunks] = items(refined ? voxels + entries / kSampleChunk : 1, kMostPairs);
  l[kListInsideSamples] = items(refined ? kLargeList : 1, kLargeList);
  l[kListOpenSamples] = items(refined ? kLargeList : 1, kLargeList);
  l[kListSamples] = items(refined ? kLargeList : 1, kLargeList);
  l[kListMembers] = items(std::max(kSmallList, 4 * tool), kMostPairs);
  l[kListPierces] = kMaxFrameAreas * kMaxFrameAreas;
  l[kListMobileTiles] = refined ? 1u << 18 : 1;
  l[kListNeedleVertices] = refined ? 1u << 15 : 1;
  out.bin_entries = items(refined ? std::max(kSmallList, kBinEntries * tool) : 1, ~0u);
  // Half full at most, so that probing stays short.
  out.needle_table = doubled(l[kListNeedleVertices]);
  const auto put = [&](const char* name, std::uint32_t& capacity) {
    if (const auto asked = wanted.find(name); asked != wanted.end()) capacity = std::max(1u, asked->second);
  };
  for (std::uint32_t list = 0; list < kListNames.size(); ++list) put(kListNames[list], l[list]);
  for (const Other& other : kOthers) put(other.name, out.*other.capacity);
  return out;
}

bool FrameCapacity::grow(const FrameState& state, const std::array<std::uint32_t, kListCount>& asked) {
  bool grown = false;
  for (std::uint32_t list = 0; list < kListCount; ++list) {
    if ((state.overflow >> list & 1u) == 0) continue;
    lists[list] = std::max(doubled(lists[list]), asked[list]);
    grown = true;
  }
  for (const Other& other : kOthers) {
    if ((state.overflow_other & other.overflow) == 0) continue;
    this->*other.capacity = doubled(this->*other.capacity);
    grown = true;
  }
  needle_table = std::max(needle_table, doubled(lists[kListNeedleVertices]));
  return grown;
}

const char* overflow_name(const FrameState& state) {
  const auto first = static_cast<std::uint32_t>(std::countr_zero(state.overflow));   // 32 when none
  if (const char* name = list_name(first)) return name;
  for (const Other& other : kOthers)
    if ((state.overflow_other & other.overflow) != 0) return other.name;
  if ((state.overflow_other & kOverflowAreas) != 0) return "areas";
  if ((state.overflow_other & kOverflowLoop) != 0) return "steps of one invocation";
  return state.overflow == 0 && state.overflow_other == 0 ? "" : "an unnamed list";
}

std::string fixed_limit(const FrameState& state) {
  if ((state.overflow_other & kOverflowAreas) != 0) return "a frame has more than " + std::to_string(kMaxFrameAreas) + " contact areas, the most there can be";
  if ((state.overflow_other & kOverflowLoop) != 0)
    return "a frame needs more than " + std::to_string(kLoopBudget) + " steps of one invocation, the most that every device takes";
  return "the last frame ran out of nothing";
}

const char* list_name(std::uint32_t list) { return list < kListNames.size() ? kListNames[list] : nullptr; }

}  // namespace palpate
