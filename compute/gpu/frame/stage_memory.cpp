#include "compute/gpu/frame/stage_memory.h"

#include <algorithm>
#include <iterator>
#include <string_view>

#include "shaders/shared/frame_field.h"
#include "shaders/shared/frame_response.h"

namespace palpate {
namespace {

using namespace gpu;

struct BufferUse {
  std::string_view stage;
  std::initializer_list<std::int32_t> bindings;
};

/// Small buffers of the frame as a whole (input, lists, state) stand with transform, which every frame begins
/// with.
const BufferUse kUses[] = {
    {"transform",
     {kBindScene, kBindToolVertices, kBindToolTriangles, kBindToolInfo, kBindFrameInput, kBindFrameLists,
      kBindFrameState, kBindListsAnew, kBindListedGroups, kBindMembersGroups, kBindPlacedGroups,
      kBindPushedGroups, kBindResultGroups, kBindDispatches, kBindToolRecords, kBindToolCorners,
      kBindClusterBoxes, kBindRunBoxes}},
    {"cull",
     {kBindOccupied, kBindToolBounds, kBindNearGroups, kBindMockupBrickSlot, kBindMockupBricks,
      kBindMockupMixedBrick}},
    {"pairs",
     {kBindMockupVertices,
      kBindMockupTriangles,
      kBindMockupInfo,
      kBindMockupListBegin,
      kBindMockupListTriangles,
      kBindMockupBoundaryPlace,
      kBindMobileState,
      kBindNearRuns,
      kBindPairChunks,
      kBindPairTable,
      kBindPairSlots,
      kBindListBoxes,
      kBindPairs,
      kBindStaticState,
      kBindStaticSlot,
      kBindContactStatics,
      kBindContactMobiles,
      kBindResult,
      kBindResultStatics,
      kBindResultMobiles}},
    {"bst", {kBindVoxelState, kBindTouchedVoxels, kBindPairChunks}},
    {"est",
     {kBindFineBrickSlot, kBindFineBricks, kBindFineListBegin, kBindFineListTriangles, kBindFinePlaces,
      kBindFineExit, kBindFineShells, kBindToolNear, kBindSampleBegin, kBindSamplePoints, kBindSampleIds,
      kBindSampleChunks, kBindOpenSamples, kBindSamples}},
    {"rays", {kBindMockupWeights, kBindMockupPatches, kBindMockupExtras,     kBindToolWeights,
              kBindToolExtras,    kBindFieldWork,     kBindCarrierWork,      kBindFieldTiles,
              kBindMockupPoints,  kBindToolPoints,    kBindIgnored,          kBindIgnoredState,
              kBindResultIgnored, kBindResultField,   kBindResultCarriers,   kBindMockupShells,
              kBindMockupTree,    kBindToolTree,      kBindToolSamplePoints, kBindToolSampleEnds}},
    {"areas",
     {kBindNeighbourBegin, kBindNeighbours, kBindMockupNormals, kBindToolNormals, kBindResultMembers}},
};

/// What the response adds and no line above names belongs to the areas.
std::string_view stage_of(std::int32_t binding) {
  for (const BufferUse& use : kUses)
    if (std::find(use.bindings.begin(), use.bindings.end(), binding) != use.bindings.end()) return use.stage;
  return binding >= kBindResponseFirst ? "areas" : "pairs";
}

/// Largest buffer that only stands where a descriptor needs one.
constexpr std::uint64_t kPlaceholderBytes = 64;

}  // namespace

std::vector<StageMemory> stage_memory(const FrameBuffers& buffers, bool zones) {
  std::vector<StageMemory> memory;
  for (const BufferUse& use : kUses) memory.push_back({std::string(use.stage), 0});
  for (std::int32_t binding = 0; binding < FrameBuffers::kBindings; ++binding) {
    const auto line = std::find_if(memory.begin(), memory.end(),
                                   [&](const StageMemory& m) { return m.stage == stage_of(binding); });
    if (buffers.bytes(binding) > kPlaceholderBytes) line->bytes += buffers.bytes(binding);
  }
  // Areas and zones are joined in halves of one buffer.
  if (const std::uint64_t half = buffers.bytes(kBindParents) / 2; zones && half > kPlaceholderBytes) {
    std::find_if(memory.begin(), memory.end(), [](const StageMemory& m) {
      return m.stage == "areas";
    })->bytes -= half;
    memory.push_back({"zones", half});
  }
  return memory;
}

}  // namespace palpate
