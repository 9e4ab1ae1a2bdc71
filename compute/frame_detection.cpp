#include "compute/frame_detection.h"

#include <algorithm>
#include <bit>

#include "compute/tool_order.h"
#include "shaders/code.h"

namespace palpate {
namespace {

using namespace gpu;   // names of shaders/shared/frame.h

constexpr std::uint32_t kMostBinsBits = 9;

}  // namespace

Result<std::unique_ptr<FrameDetection>> FrameDetection::create(VulkanDevice& device, const PreparedScene& scene) {
  std::unique_ptr<FrameDetection> out(new FrameDetection);
  out->refined_ = scene.constants.refined != 0;
  out->inside_ = out->refined_ && (scene.constants.tool.closed != 0 || scene.constants.tool.has_internal != 0);
  out->tool_vertices_ = scene.constants.tool.vertices;
  out->tool_clusters_ = (scene.constants.tool.triangles + kClusterSize - 1) / kClusterSize;
  // About a bin a triangle.
  while (out->bins_bits_ < kMostBinsBits && (1u << 2 * out->bins_bits_) < scene.constants.tool.triangles) ++out->bins_bits_;
  if (auto r = out->make_shaders(device); !r) return r.error();
  return out;
}

Result<void> FrameDetection::make_buffers(VulkanDevice& device, const SceneGeometry& geometry, const PreparedScene& scene,
                                          const FrameCapacity& capacity, FrameBuffers& buffers) const {
  const BodyConstants& mockup = scene.constants.mockup;
  const BodyConstants& tool = scene.constants.tool;
  const std::uint64_t voxels = mockup.grid.boundary_voxels, statics = capacity.lists[kListContactStatics];

  struct List {
    std::uint32_t list;
    std::int32_t binding;
    std::size_t item_bytes;
    BufferKind kind = BufferKind::kDevice;
  };
  const List lists[] = {
      {kListClusterBricks, kBindClusterBricks, sizeof(ClusterBrick)},
      {kListTriangleBricks, kBindTriangleBricks, sizeof(TriangleBrick)},
      {kListTouchCandidates, kBindTouchCandidates, sizeof(TouchCandidate)},
      {kListTouchedVoxels, kBindTouchedVoxels, sizeof(FrameVoxel)},
      {kListVoxelChunks, kBindVoxelChunks, sizeof(VoxelChunk)},
      {kListPairChunks, kBindPairChunks, sizeof(PairChunk)},
      {kListPairCandidates, kBindPairCandidates, sizeof(PairCandidate)},
      {kListPairs, kBindPairs, sizeof(ContactPair)},
      {kListContactStatics, kBindContactStatics, sizeof(std::uint32_t)},
      {kListContactMobiles, kBindContactMobiles, sizeof(std::uint32_t)},
      {kListSampleBricks, kBindSampleBricks, sizeof(std::uint32_t)},
      {kListSampleChunks, kBindSampleChunks, sizeof(SampleChunk)},
      {kListOpenSamples, kBindOpenSamples, sizeof(FrameSample)},
      {kListSamples, kBindSamples, sizeof(FrameSample)},
      {kListMembers, kBindResultMembers, sizeof(AreaMember), BufferKind::kReadback},
      {kListPierces, kBindResultPierces, sizeof(AreaPierce), BufferKind::kReadback},
  };
  for (const List& l : lists)
    if (auto r = buffers.make(device, l.binding, list_name(l.list), capacity.lists[l.list] * std::uint64_t{l.item_bytes}, l.kind); !r) return r;

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
      {kBindBinEntries, "entries of bins", 4 * std::uint64_t{capacity.bin_entries}},
      {kBindWideTriangles, "wide triangles", 4 * std::uint64_t{inside_ ? tool.triangles : 1}},
      {kBindBinState, "state of bins", sizeof(BinState)},
      {kBindMobileState, "states of the tool's triangles", 4 * std::uint64_t{tool.triangles}},
      {kBindStaticSlot, "slots of the mock-up's triangles", 4 * std::uint64_t{mockup.triangles}},
      {kBindToolOrder, "order of the tool's triangles", 4 * std::uint64_t{tool.triangles}},
      {kBindHeldStatics, "held triangles", sizeof(HeldStatic) * statics, BufferKind::kUpload},
      {kBindHeldAreas, "held areas", sizeof(HeldDirection) * kMaxFrameAreas, BufferKind::kUpload},
      {kBindResult, "frame result", sizeof(FrameResult), BufferKind::kReadback},
      {kBindResultStatics, "results of the mock-up's triangles", sizeof(StaticResult) * statics, BufferKind::kReadback},
      {kBindResultMobiles, "results of the tool's triangles", sizeof(MobileResult) * std::uint64_t{capacity.lists[kListContactMobiles]}, BufferKind::kReadback},
  };
  for (const Plain& p : plain)
    if (auto r = buffers.make(device, p.binding, p.what, p.bytes, p.kind); !r) return r;

  if (auto r = buffers.make_table(device, kBindPairTable, "pair table", 8 * std::bit_ceil(std::uint64_t{capacity.pair_table})); !r) return r;
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
