#include "compute/gpu/frame/capacity.h"

#include <algorithm>
#include <bit>
#include <utility>

#include "shaders/shared/frame_batch.h"

namespace palpate {
namespace {

using namespace gpu;  // names of shaders/shared/frame.h

// Chosen: a frame of 100,000 by 2,000 triangles in deep contact uses a tenth of it.
constexpr std::uint64_t kUsual = 1u << 18, kPerTriangle = 16, kLookedAt = 4;
constexpr std::uint64_t kMostItems =
    1u << 22;  // to begin with; a binding of 128 MiB holds that many of 32 bytes

constexpr std::array<const char*, 20> kListNames = {"",
                                                    "",
                                                    "near parts of the tool",
                                                    "touched voxels",
                                                    "",
                                                    "lists of touched voxels",
                                                    "pairs to test",
                                                    "pairs",
                                                    "contact triangles of the mock-up",
                                                    "contact triangles of the tool",
                                                    "lists with samples",
                                                    "samples near the tool's surface",
                                                    "samples",
                                                    "tool triangles of areas",
                                                    "",
                                                    "",
                                                    "tiles of tool samples",
                                                    "samples that weigh something",
                                                    "samples of the tool",
                                                    "ignored patches"};
static_assert(kListFieldTiles == 16 && kListIgnored == 19);

std::uint32_t items(std::uint64_t wanted, std::uint64_t most) {
  return static_cast<std::uint32_t>(std::clamp<std::uint64_t>(wanted, 1, most));
}

std::uint32_t doubled(std::uint32_t capacity) {
  return static_cast<std::uint32_t>(std::min<std::uint64_t>(2 * std::uint64_t{capacity}, ~0u));
}

void override_lists(std::array<std::uint32_t, kListCount>& lists,
                    const std::map<std::string, std::uint32_t>& wanted) {
  for (std::uint32_t list = 0; list < kListNames.size(); ++list)
    if (const auto asked = wanted.find(kListNames[list]); *kListNames[list] != 0 && asked != wanted.end())
      lists[list] = std::max(1u, asked->second);
}

}  // namespace

FrameCapacity FrameCapacity::first(const FrameDemand& demand,
                                   const std::map<std::string, std::uint32_t>& wanted) {
  const SceneConstants& scene = demand.scene;
  const bool refined = scene.refined != 0;
  const std::uint64_t tool = scene.tool.triangles, mockup = scene.mockup.triangles,
                      voxels = scene.mockup.grid.boundary_voxels;
  const std::uint64_t entries = scene.mockup.grid.list_entries;
  // Of every list: what is usual, more for a large tool, and never more than there is.
  const auto room = [&](std::uint64_t a_tool_triangle, std::uint64_t most) {
    return items(std::min(std::max(kUsual, a_tool_triangle * tool), most), kMostItems);
  };
  // Samples and first corners.
  const std::uint64_t samples = !refined ? 1 : demand.samples ? *demand.samples + mockup : kMostItems;
  FrameCapacity out;
  auto& l = out.lists;
  l[kListNearRuns] = room(1, ~0u);
  l[kListTouchedVoxels] = room(kPerTriangle, voxels);
  l[kListPairChunks] = room(kLookedAt, tool * (voxels + entries / demand.cut.pair_chunk));  // both below 2^32
  l[kListPairCandidates] = room(kLookedAt, tool * mockup);
  l[kListPairs] = room(kPerTriangle, tool * mockup);
  l[kListContactStatics] = room(0, mockup);
  l[kListContactMobiles] = items(tool, ~0u);
  l[kListSampleChunks] = room(
      kLookedAt,
      !refined ? 1 : voxels + (demand.samples ? samples / demand.cut.listed_chunk : entries / kSampleChunk));
  l[kListOpenSamples] = l[kListSamples] = room(0, samples);
  l[kListMembers] = room(2, tool * kMaxFrameAreas);
  l[kListFieldTiles] = refined ? room(2, ~0u) : 1;
  l[kListMockupPoints] = room(0, samples + scene.mockup_extras);
  l[kListToolPoints] = refined ? room(0, ~0u) : 1;
  l[kListIgnored] = room(0, refined ? mockup : 1);
  override_lists(l, wanted);
  return out;
}

FrameCapacity FrameCapacity::first_of_batch(std::uint32_t poses,
                                            const std::map<std::string, std::uint32_t>& wanted) {
  // Items of a pose on an average (chosen: as a hand's contacts have; what many poses do not need a few may,
  // and what is too little grows).
  constexpr std::pair<std::uint32_t, std::uint32_t> kOfAPose[] = {
      {kListNearRuns, 64},        {kListTouchedVoxels, 256},  {kListPairChunks, 512},
      {kListPairCandidates, 512}, {kListContactStatics, 256}, {kListContactMobiles, 128},
      {kListSampleChunks, 256},   {kListOpenSamples, 256},    {kListSamples, 512},
      {kListFieldTiles, 128},     {kListMockupPoints, 256},   {kListToolPoints, 256}};
  FrameCapacity out;
  out.poses = poses;
  out.lists.fill(1);
  for (const auto& [list, items_of_a_pose] : kOfAPose)
    out.lists[list] = items(std::uint64_t{items_of_a_pose} * poses, kMostItems);
  override_lists(out.lists, wanted);
  out.lists[kListPoses] = poses;
  return out;
}

bool FrameCapacity::grow(const FrameState& state, const std::array<std::uint32_t, kListCount>& asked) {
  bool grown = false;
  for (std::uint32_t list = 0; list < kListCount; ++list) {
    if ((state.overflow >> list & 1u) == 0) continue;
    lists[list] = std::max(doubled(lists[list]), asked[list]);
    grown = true;
  }
  return grown;
}

const char* overflow_name(const FrameState& state) {
  const auto first = static_cast<std::uint32_t>(std::countr_zero(state.overflow));  // 32 when none
  if (const char* name = list_name(first)) return name;
  if ((state.overflow_other & kOverflowAreas) != 0) return "areas";
  if ((state.overflow_other & kOverflowLoop) != 0) return "steps of one invocation";
  return state.overflow == 0 && state.overflow_other == 0 ? "" : "an unnamed list";
}

std::string fixed_limit(const FrameState& state) {
  if ((state.overflow_other & kOverflowAreas) != 0)
    return "a frame has more than " + std::to_string(kMaxFrameAreas) +
           " contact areas, the most there can be";
  if ((state.overflow_other & kOverflowLoop) != 0)
    return "a frame needs more than " + std::to_string(kLoopBudget) +
           " steps of one invocation, the most that every device takes";
  return "the last frame ran out of nothing";
}

const char* list_name(std::uint32_t list) { return list < kListNames.size() ? kListNames[list] : nullptr; }

}  // namespace palpate
