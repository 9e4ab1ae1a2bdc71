#include "compute/frame_detection.h"

#include <algorithm>
#include <bit>

#include "compute/tool_order.h"
#include "shaders/code.h"

namespace palpate {
namespace {

using namespace gpu;   // names of shaders/shared/frame.h

// Capacities, chosen: a frame of 100,000 by 2,000 triangles in deep contact uses a tenth of them; they grow with the bodies up to
// what a binding of 128 MiB holds.
constexpr std::uint64_t kSmallList = 1u << 17;
constexpr std::uint64_t kLargeList = 1u << 20;
constexpr std::uint64_t kMostPairs = 1u << 22;
constexpr std::uint32_t kMostBinsBits = 9;
constexpr std::uint64_t kBinEntries = 12;   // a triangle, on average

std::uint32_t capacity(std::uint64_t wanted, std::uint64_t most) {
  return static_cast<std::uint32_t>(std::clamp<std::uint64_t>(wanted, 1, most));
}

}  // namespace

Result<std::unique_ptr<FrameDetection>> FrameDetection::create(VulkanDevice& device, const SceneGeometry& geometry,
                                                               const PreparedScene& scene, FrameBuffers& buffers) {
  std::unique_ptr<FrameDetection> out(new FrameDetection);
  out->refined_ = scene.constants.refined != 0;
  out->inside_ = out->refined_ && (scene.constants.tool.closed != 0 || scene.constants.tool.has_internal != 0);
  out->tool_vertices_ = scene.constants.tool.vertices;
  out->tool_clusters_ = (scene.constants.tool.triangles + kClusterSize - 1) / kClusterSize;
  // About a bin a triangle.
  while (out->bins_bits_ < kMostBinsBits && (1u << 2 * out->bins_bits_) < scene.constants.tool.triangles) ++out->bins_bits_;
  if (auto r = out->make_buffers(device, geometry, scene, buffers); !r) return r.error();
  if (auto r = out->make_shaders(device); !r) return r.error();
  return out;
}

Result<void> FrameDetection::make_buffers(VulkanDevice& device, const SceneGeometry& geometry, const PreparedScene& scene,
                                          FrameBuffers& buffers) {
  const BodyConstants& mockup = scene.constants.mockup;
  const BodyConstants& tool = scene.constants.tool;
  const std::uint64_t voxels = mockup.grid.boundary_voxels, entries = mockup.grid.list_entries;
  const std::uint64_t pairs = std::clamp<std::uint64_t>(32 * std::uint64_t{tool.triangles}, 2 * kSmallList, kMostPairs);

  struct List {
    std::uint32_t list;
    std::int32_t binding;
    const char* what;
    std::uint32_t capacity;
    std::size_t item_bytes;
    BufferKind kind = BufferKind::kDevice;
  };
  const std::uint32_t statics = capacity(mockup.triangles, kLargeList);
  const List lists[] = {
      {kListClusterBricks, kBindClusterBricks, "bricks of clusters", capacity(std::max(kSmallList, 4 * std::uint64_t{tool.triangles}), kLargeList), sizeof(ClusterBrick)},
      {kListTriangleBricks, kBindTriangleBricks, "bricks of triangles", capacity(std::max(kSmallList, 8 * std::uint64_t{tool.triangles}), kMostPairs), sizeof(TriangleBrick)},
      {kListTouchCandidates, kBindTouchCandidates, "voxels to touch", capacity(std::max(kLargeList, 32 * std::uint64_t{tool.triangles}), kMostPairs), sizeof(TouchCandidate)},
      {kListTouchedVoxels, kBindTouchedVoxels, "touched voxels", capacity(voxels, kLargeList), sizeof(FrameVoxel)},
      {kListVoxelChunks, kBindVoxelChunks, "lists of touched voxels", capacity(voxels + entries / kVoxelChunk, kLargeList), sizeof(VoxelChunk)},
      {kListPairChunks, kBindPairChunks, "lists to pair", capacity(std::max(kLargeList, 16 * std::uint64_t{tool.triangles}), kMostPairs), sizeof(PairChunk)},
      {kListPairCandidates, kBindPairCandidates, "pairs to test", capacity(pairs, kMostPairs), sizeof(PairCandidate)},
      {kListPairs, kBindPairs, "pairs", capacity(pairs, kMostPairs), sizeof(ContactPair)},
      {kListContactStatics, kBindContactStatics, "contact triangles of the mock-up", statics, sizeof(std::uint32_t)},
      {kListContactMobiles, kBindContactMobiles, "contact triangles of the tool", capacity(tool.triangles, ~0u), sizeof(std::uint32_t)},
      {kListSampleBricks, kBindSampleBricks, "bricks with samples", capacity(refined_ ? mockup.grid.mixed_bricks : 1, ~0u), sizeof(std::uint32_t)},
      {kListSampleChunks, kBindSampleChunks, "lists with samples", capacity(refined_ ? voxels + entries / kSampleChunk : 1, kMostPairs), sizeof(SampleChunk)},
      {kListOpenSamples, kBindOpenSamples, "samples near the tool's surface", capacity(refined_ ? kLargeList : 1, kLargeList), sizeof(FrameSample)},
      {kListSamples, kBindSamples, "samples", capacity(refined_ ? kLargeList : 1, kLargeList), sizeof(FrameSample)},
      {kListMembers, kBindResultMembers, "tool triangles of areas", capacity(std::max(kSmallList, 4 * std::uint64_t{tool.triangles}), kMostPairs), sizeof(AreaMember), BufferKind::kReadback},
      {kListPierces, kBindResultPierces, "pierced areas", kMaxFrameAreas * kMaxFrameAreas, sizeof(AreaPierce), BufferKind::kReadback},
  };
  for (const List& l : lists) {
    if (auto r = buffers.make(device, l.binding, l.what, l.capacity * l.item_bytes, l.kind); !r) return r;
    capacities_[l.list] = l.capacity;
  }

  struct Plain {
    std::int32_t binding;
    const char* what;
    std::uint64_t bytes;
    BufferKind kind = BufferKind::kDevice;
  };
  const Plain plain[] = {
      {kBindFrameInput, "frame input", sizeof(FrameInput), BufferKind::kUpload},
      {kBindFrameLists, "frame lists", sizeof(FrameList) * kListCount},
      {kBindFrameState, "frame state", sizeof(FrameState)},
      {kBindDispatches, "group counts", sizeof(DispatchArguments) * kDispatchCount},
      {kBindToolWorld, "transformed tool", sizeof(ivec3) * std::uint64_t{tool.vertices}},
      {kBindClusterBoxes, "boxes of clusters", sizeof(LatticeBox) * std::uint64_t{tool_clusters_}},
      {kBindRunBoxes, "boxes of runs", sizeof(LatticeBox) * std::uint64_t{tool_clusters_} * (kClusterSize / kRunSize)},
      {kBindToolCorners, "corners of the transformed tool", sizeof(ToolCorners) * std::uint64_t{tool.triangles}},
      {kBindToolBins, "bins of the tool's shadow", sizeof(ToolBin) << (inside_ ? 2 * bins_bits_ : 0)},
      {kBindBinEntries, "entries of bins", 4 * (inside_ ? std::max(kSmallList, kBinEntries * tool.triangles) : 1)},
      {kBindWideTriangles, "wide triangles", 4 * std::uint64_t{inside_ ? tool.triangles : 1}},
      {kBindBinState, "state of bins", sizeof(BinState)},
      {kBindMobileState, "states of the tool's triangles", 4 * std::uint64_t{tool.triangles}},
      {kBindStaticSlot, "slots of the mock-up's triangles", 4 * std::uint64_t{mockup.triangles}},
      {kBindToolOrder, "order of the tool's triangles", 4 * std::uint64_t{tool.triangles}},
      {kBindHeldStatics, "held triangles", sizeof(HeldStatic) * std::uint64_t{statics}, BufferKind::kUpload},
      {kBindHeldAreas, "held areas", sizeof(HeldDirection) * kMaxFrameAreas, BufferKind::kUpload},
      {kBindResult, "frame result", sizeof(FrameResult), BufferKind::kReadback},
      {kBindResultStatics, "results of the mock-up's triangles", sizeof(StaticResult) * std::uint64_t{statics}, BufferKind::kReadback},
      {kBindResultMobiles, "results of the tool's triangles", sizeof(MobileResult) * std::uint64_t{tool.triangles}, BufferKind::kReadback},
  };
  for (const Plain& p : plain)
    if (auto r = buffers.make(device, p.binding, p.what, p.bytes, p.kind); !r) return r;

  // Half full at most, so that probing stays short.
  if (auto r = buffers.make_table(device, kBindPairTable, "pair table", 8 * std::bit_ceil(2 * pairs)); !r) return r;
  if (auto r = buffers.make_table(device, kBindVoxelState, "states of boundary voxels", 4 * voxels); !r) return r;
  if (auto r = buffers.make_table(device, kBindStaticState, "states of the mock-up's triangles", 4 * std::uint64_t{mockup.triangles}); !r)
    return r;

  const std::vector<std::uint32_t> order = order_in_space(geometry.tool);
  return upload(device, buffers[kBindToolOrder], order.data(), order.size() * sizeof order[0]);
}

Result<void> FrameDetection::make_shaders(VulkanDevice& device) {
  const SpecConstant no_inside[] = {{0, inside_ ? 0u : 1u}};
  const SpecConstant counting[] = {{0, 1}, {1, bins_bits_}}, filling[] = {{0, 0}, {1, bins_bits_}};
  struct Made {
    FrameShader* shader;
    const ShaderCode* code;
    bool wanted = true;
    std::uint32_t push_bytes = 0;
    std::span<const SpecConstant> constants = {};
  };
  const Made all[] = {
      {&list_close_, &spirv::list_close, true, 4},
      {&frame_begin_, &spirv::frame_begin},
      {&tool_transform_, &spirv::tool_transform},
      {&tool_clusters_find_, &spirv::tool_clusters},
      {&brick_triangles_, &spirv::brick_triangles},
      {&brick_voxels_, &spirv::brick_voxels},
      {&voxel_touch_, &spirv::voxel_touch},
      {&pair_collect_, &spirv::pair_collect},
      {&pair_test_, &spirv::pair_test},
      {&voxel_statics_, &spirv::voxel_statics},
      {&sample_bricks_, &spirv::sample_bricks, inside_},
      {&sample_voxels_, &spirv::sample_voxels, inside_},
      {&sample_touched_, &spirv::sample_touched, refined_ && !inside_},
      {&sample_scan_, &spirv::sample_scan, refined_, 0, no_inside},
      {&bins_begin_, &spirv::bins_begin, inside_},
      {&bins_clear_, &spirv::bins_clear, inside_},
      {&bins_count_, &spirv::bins_fill, inside_, 0, counting},
      {&bins_place_, &spirv::bins_place, inside_},
      {&bins_fill_, &spirv::bins_fill, inside_, 0, filling},
      {&sample_winding_, &spirv::sample_winding, inside_, 0, filling},
      {&set_statics_, &spirv::set_statics},
      {&set_mobiles_, &spirv::set_mobiles},
      {&set_decide_, &spirv::set_decide},
      {&frame_end_, &spirv::frame_end},
      {&frame_reset_, &spirv::frame_reset},
  };
  for (const Made& m : all) {
    if (!m.wanted) continue;
    auto shader = make_frame_shader(device, *m.code, m.push_bytes, m.constants);
    if (!shader) return shader.error();
    *m.shader = std::move(*shader);
  }
  return {};
}

void FrameDetection::record(FrameRecorder& recorder) const {
  // The tool at its pose, and which bricks its clusters meet.
  recorder.stage("transform");
  recorder.run(frame_begin_, 1);
  recorder.run(tool_transform_, (tool_vertices_ + kGroupSize - 1) / kGroupSize);
  recorder.barrier();
  recorder.run(tool_clusters_find_, tool_clusters_);
  recorder.close({kListClusterBricks});

  // Triangles and bricks, then voxels in their boxes.
  recorder.stage("cull");
  recorder.run_groups(brick_triangles_, kListClusterBricks);
  recorder.close({kListTriangleBricks});
  recorder.run_items(brick_voxels_, kListTriangleBricks);
  recorder.close({kListTouchCandidates});

  // Which voxels the triangles touch: IMT and BMT; and what is listed there.
  recorder.stage("imt");
  recorder.run_items(voxel_touch_, kListTouchCandidates);
  recorder.close({kListTouchedVoxels, kListVoxelChunks, kListPairChunks});

  recorder.stage("pairs");
  recorder.run_items(pair_collect_, kListPairChunks);
  recorder.close({kListPairCandidates});
  recorder.run_items(pair_test_, kListPairCandidates);
  recorder.barrier();

  recorder.stage("bst");
  recorder.run_items(voxel_statics_, kListVoxelChunks);
  if (refined_) {
    recorder.barrier();
    record_samples(recorder);
  }

  recorder.stage("sets");
  recorder.close({kListPairs, kListContactStatics, kListContactMobiles, kListSamples});
  recorder.run_items(set_statics_, kListContactStatics);
  recorder.run_items(set_mobiles_, kListContactMobiles);
  recorder.barrier();
  recorder.run(set_decide_, 1);
  recorder.barrier();
}

void FrameDetection::record_samples(FrameRecorder& recorder) const {
  recorder.stage("est");
  if (!inside_) {
    recorder.run_items(sample_touched_, kListTouchedVoxels);
    recorder.close({kListSampleChunks});
    recorder.run_items(sample_scan_, kListSampleChunks);
    return;
  }
  const std::uint32_t bin_groups = ((1u << 2 * bins_bits_) + kGroupSize - 1) / kGroupSize;
  recorder.run_dispatch(sample_bricks_, kDispatchBricks);
  recorder.run(bins_clear_, bin_groups);
  recorder.close({kListSampleBricks});
  recorder.run_groups(sample_voxels_, kListSampleBricks);
  recorder.close({kListSampleChunks});
  recorder.run_items(sample_scan_, kListSampleChunks);
  recorder.close({kListOpenSamples});

  // Samples that the tool's partition leaves open.
  recorder.run(bins_begin_, 1);
  recorder.barrier();
  recorder.run_dispatch(bins_count_, kDispatchBinTriangles);
  recorder.barrier();
  recorder.run(bins_place_, bin_groups);
  recorder.barrier();
  recorder.run_dispatch(bins_fill_, kDispatchBinTriangles);
  recorder.barrier();
  recorder.run_items(sample_winding_, kListOpenSamples);
}

void FrameDetection::record_end(FrameRecorder& recorder) const {
  recorder.stage("reset");
  recorder.run(frame_end_, 1);
  recorder.run_dispatch(frame_reset_, kDispatchReset);
}

}  // namespace palpate
