#include "compute/gpu/frame/detection.h"

#include <algorithm>
#include <bit>
#include <cstddef>

#include "compute/gpu/frame/plan.h"
#include "compute/scene/tool_order.h"
#include "shaders/code.h"
#include "shaders/shared/frame_batch.h"
#include "shaders/shared/frame_field.h"

namespace palpate {

using namespace gpu;  // names of shaders/shared/frame.h

std::unique_ptr<FrameDetection> FrameDetection::make(const SceneGeometry& geometry,
                                                     const PreparedScene& scene, const Plan& plan,
                                                     bool batch) {
  std::unique_ptr<FrameDetection> out(new FrameDetection);
  out->batch_ = batch;
  out->plan_ = plan;
  out->order_ = order_in_space(geometry.tool);
  out->refined_ = scene.constants.refined != 0;
  out->inside_ = out->refined_ && scene.constants.tool_has_inside != 0;
  out->closed_ = out->refined_ && scene.constants.tool.closed != 0;
  out->listed_ = static_cast<bool>(scene.sample_points);
  out->wide_ = scene.constants.mockup.grid.size > kNarrowVoxel;
  out->has_near_ = static_cast<bool>(scene.tool_near);
  return out;
}

bool FrameDetection::keys_fit(const SceneConstants& scene, std::uint32_t poses) {
  return std::bit_width(scene.mockup.triangles) + std::bit_width(scene.tool.triangles) +
             std::bit_width(poses + 1) <=
         64;
}

Result<void> FrameDetection::make_buffers(VulkanDevice& device, const SceneGeometry& geometry,
                                          const PreparedScene& scene, const FrameCapacity& capacity,
                                          FrameBuffers& buffers) const {
  const BodyConstants& mockup = scene.constants.mockup;
  const BodyConstants& tool = scene.constants.tool;
  const std::uint64_t statics = capacity.lists[kListContactStatics];
  // Of what is kept by number, or in a batch by key: at most half full.
  const std::uint64_t poses = capacity.poses;
  const auto entries = [&](std::uint32_t list, std::uint64_t numbers) {
    return poses == 0 ? numbers : std::bit_ceil(2 * std::uint64_t{capacity.lists[list]});
  };
  const std::uint64_t by_voxel = entries(kListTouchedVoxels, mockup.grid.boundary_voxels),
                      by_static = entries(kListContactStatics, mockup.triangles),
                      by_mobile = entries(kListContactMobiles, tool.triangles);
  const std::uint64_t clusters = (tool.triangles + kClusterSize - 1) / kClusterSize,
                      runs = (tool.triangles + kRunSize - 1) / kRunSize;

  struct List {
    std::uint32_t list;
    std::int32_t binding;
    std::size_t item_bytes;
    BufferKind kind = BufferKind::kDevice;
  };
  const List lists[] = {
      {kListNearRuns, kBindNearRuns, sizeof(NearRun)},
      {kListTouchedVoxels, kBindTouchedVoxels, sizeof(FrameVoxel)},
      {kListPairChunks, kBindPairChunks, sizeof(PairChunk)},
      {kListPairCandidates, kBindPairSlots, sizeof(std::uint32_t)},
      {kListPairs, kBindPairs, sizeof(ContactPair)},
      {kListContactStatics, kBindContactStatics, sizeof(std::uint32_t)},
      {kListContactMobiles, kBindContactMobiles, sizeof(std::uint32_t)},
      {kListSampleChunks, kBindSampleChunks, sizeof(SampleChunk)},
      {kListOpenSamples, kBindOpenSamples, sizeof(FrameSample)},
      {kListSamples, kBindSamples, sizeof(FrameSample)},
      {kListMembers, kBindResultMembers, sizeof(AreaMember), BufferKind::kReadback},
  };
  for (const List& l : lists)
    if (auto r = buffers.make(device, l.binding, list_name(l.list),
                              capacity.lists[l.list] * std::uint64_t{l.item_bytes}, l.kind);
        !r)
      return r;

  struct Plain {
    std::int32_t binding;
    const char* what;
    std::uint64_t bytes;
    BufferKind kind = BufferKind::kDevice;
  };
  const Plain plain[] = {
      {kBindFrameInput, "frame input", sizeof(FrameInput), BufferKind::kUpload},
      {kBindFrameLists, "frame lists", sizeof(FrameList) * kListCount},
      {kBindDispatches, "group counts", sizeof(DispatchArguments) * kDispatchCount},
      {kBindListsAnew, "lists of a batch", poses == 0 ? 4 : sizeof(BatchLists), BufferKind::kUpload},
      {kBindBatchInputs, "poses", sizeof(FrameInput) * poses, BufferKind::kUpload},
      {kBindOpenPoses, "poses of samples near the tool's surface",
       poses == 0 ? 4 : 4 * std::uint64_t{capacity.lists[kListOpenSamples]}},
      {kBindResultStates, "frame states", sizeof(FrameState) * poses, BufferKind::kReadback},
      {kBindResultGroups, "group counts", sizeof(DispatchArguments)},
      {kBindToolRecords, "tool triangles", sizeof(ToolRecord) * std::uint64_t{tool.triangles},
       BufferKind::kTexels},
      {kBindToolBounds, "boxes of the tool", sizeof(LatticeBox) * (clusters + runs)},
      {kBindFinePlaces, "lists of the tool's fine voxels",
       closed_ ? 4 * std::uint64_t{scene.constants.fine.list_entries} : 4},
      {kBindClusterBoxes, "boxes of clusters", sizeof(LatticeBox) * clusters},
      {kBindRunBoxes, "boxes of runs", sizeof(LatticeBox) * clusters * (kClusterSize / kRunSize)},
      {kBindToolCorners, "corners of the transformed tool",
       sizeof(ToolCorners) * std::uint64_t{tool.triangles}},
      {kBindStaticSlot, "slots of the mock-up's triangles", 4 * by_static},
      {kBindResult, "frame result", sizeof(FrameResult), BufferKind::kReadback},
      {kBindResultStatics, "results of the mock-up's triangles", sizeof(StaticResult) * statics,
       BufferKind::kReadback},
      {kBindResultMobiles, "results of the tool's triangles",
       sizeof(MobileResult) * std::uint64_t{capacity.lists[kListContactMobiles]}, BufferKind::kReadback},
  };
  for (const Plain& p : plain)
    if (auto r = buffers.make(device, p.binding, p.what, p.bytes, p.kind); !r) return r;

  struct Table {
    std::int32_t binding;
    const char* what;
    std::uint64_t bytes;
  };
  const auto keys = [&](std::uint64_t count) { return poses == 0 ? 4 : 8 * count; };
  const Table tables[] = {
      {kBindFrameState, "frame state", sizeof(FrameState) * std::max<std::uint64_t>(poses, 1)},
      {kBindVoxelState, "states of boundary voxels", 4 * by_voxel},
      {kBindStaticState, "states of the mock-up's triangles", 4 * by_static},
      {kBindMobileState, "states of the tool's triangles", 4 * by_mobile},
      {kBindVoxelKeys, "keys of boundary voxels", keys(by_voxel)},
      {kBindStaticKeys, "keys of the mock-up's triangles", keys(by_static)},
      {kBindMobileKeys, "keys of the tool's triangles", keys(by_mobile)},
      // At most half full.
      {kBindPairTable, "table of pairs",
       8 * std::bit_ceil(2 * std::uint64_t{capacity.lists[kListPairCandidates]})},
  };
  for (const Table& t : tables)
    if (auto r = buffers.make_table(device, t.binding, t.what, t.bytes); !r) return r;
  for (const std::int32_t binding :
       {kBindNearGroups, kBindListedGroups, kBindMembersGroups, kBindPlacedGroups, kBindPushedGroups})
    if (auto r = buffers.make_table(device, binding, "group counts", 2 * sizeof(DispatchArguments)); !r)
      return r;
  for (const std::int32_t binding : {kBindToolNear, kBindSampleBegin})
    if (buffers.bytes(binding) == 0)  // broad_phase asks nobody
      if (auto r = buffers.make(device, binding, "unused", 4); !r) return r;

  if (auto r = upload_records(device, geometry.tool, buffers[kBindToolRecords]); !r) return r;
  if (auto r = upload_bounds(device, geometry.tool, buffers[kBindToolBounds]); !r) return r;
  return closed_ ? upload_places(device, scene, buffers[kBindFinePlaces]) : Result<void>{};
}

Result<void> FrameDetection::upload_places(VulkanDevice& device, const PreparedScene& scene,
                                           const VulkanBuffer& to) const {
  std::vector<std::uint32_t> place(order_.size());
  for (std::uint32_t i = 0; i < order_.size(); ++i) place[order_[i]] = i;
  std::vector<std::uint32_t> entries(scene.constants.fine.list_entries);
  const VulkanBuffer& ids = (scene.fine.brick_slot ? scene.fine : scene.tool.partition).list_triangles;
  if (auto r = download(device, ids, 0, entries.data(), entries.size() * sizeof entries[0]); !r) return r;
  for (std::uint32_t& entry : entries) entry = place[entry];
  return upload(device, to, entries.data(), entries.size() * sizeof entries[0]);
}

Result<void> FrameDetection::upload_records(VulkanDevice& device, const LatticeMesh& tool,
                                            const VulkanBuffer& to) const {
  std::vector<ToolRecord> records;
  records.reserve(order_.size());
  for (const std::uint32_t id : order_)
    records.push_back({tool.corner(id, 0), id, tool.corner(id, 1), tool.flags[id], tool.corner(id, 2), 0});
  return upload(device, to, records.data(), records.size() * sizeof records[0]);
}

Result<void> FrameDetection::upload_bounds(VulkanDevice& device, const LatticeMesh& tool,
                                           const VulkanBuffer& to) const {
  std::vector<LatticeBox> boxes;
  for (const std::size_t each : {std::size_t{kClusterSize}, std::size_t{kRunSize}})
    for (std::size_t begin = 0; begin < order_.size(); begin += each) {
      LatticeBox box{ivec3(INT32_MAX), ivec3(INT32_MIN)};
      for (std::size_t place = begin; place < std::min(begin + each, order_.size()); ++place) {
        if (tool.collapsed(order_[place])) continue;
        for (int corner = 0; corner < 3; ++corner) {
          box.low = glm::min(box.low, tool.corner(order_[place], corner));
          box.high = glm::max(box.high, tool.corner(order_[place], corner));
        }
      }
      boxes.push_back(box);
    }
  return upload(device, to, boxes.data(), boxes.size() * sizeof boxes[0]);
}

Result<void> FrameDetection::make_shaders(VulkanDevice& device) {
  cut_ = work_cut(device, batch_);
  std::vector<SpecConstant> plan = plan_constants(plan_);
  add_constants(cut_, plan);
  if (batch_) plan.push_back({kBatchConstant, 1});
  const SpecConstant of_tool[] = {{0, closed_ ? 1u : 0u}}, of_points[] = {{0, wide_ ? 1u : 0u}},
                     of_search[] = {{0, !inside_  ? 0u
                                        : listed_ ? 2u
                                                  : 1u},
                                    {1, has_near_ ? 1u : 0u},
                                    {2, cut_.brick_groups},
                                    {3, cut_.bricks_at_once},
                                    {4, cut_.clusters}};
  struct Made {
    FrameShader* shader;
    const ShaderCode* code;
    bool wanted = true;
    std::uint32_t push_bytes = 0;
    std::span<const SpecConstant> constants = {};
  };
  const Made all[] = {
      {&tool_clusters_place_, &spirv::tool_clusters, !refined_},
      {&voxel_touch_, &spirv::voxel_touch},
      {&broad_phase_, &spirv::broad_phase, true, 0, of_search},
      {&pair_test_, &spirv::pair_test},
      {&sample_listed_, &spirv::sample_listed, inside_ && listed_, 0, of_points},
      {&sample_walk_, &spirv::sample_walk, inside_, 0, of_tool},
      {&sample_scan_, &spirv::sample_scan, inside_ && !listed_},
      {&set_decide_, &spirv::set_decide, !refined_},
      {&set_name_, &spirv::set_name, !refined_},
      {&frame_result_, &spirv::frame_result, !refined_},
  };
  for (const Made& m : all) {
    if (!m.wanted) continue;
    std::vector<SpecConstant> constants(m.constants.begin(), m.constants.end());
    constants.insert(constants.end(), plan.begin(), plan.end());
    auto shader = make_frame_shader(device, *m.code, m.push_bytes, constants);
    if (!shader) return shader.error();
    *m.shader = std::move(*shader);
  }
  return {};
}

std::uint32_t FrameDetection::cull_groups() const {
  const std::size_t all = std::size_t{kClusterSize} * cut_.clusters;
  return static_cast<std::uint32_t>((order_.size() + all - 1) / all) + (inside_ ? cut_.brick_groups : 0);
}

void FrameDetection::record(FrameRecorder& recorder) const {
  recorder.stage("cull");
  if (batch_)
    recorder.run_indirect(broad_phase_, kBindListsAnew, offsetof(BatchLists, cull));
  else
    recorder.run(broad_phase_, cull_groups());
  recorder.barrier();

  recorder.stage(plan_.imt ? "imt" : "bmt");  // one dispatch decides both
  recorder.run_stage(voxel_touch_, kBindNearGroups, kGroupsTouch);
  if (inside_) {
    recorder.stage("est");
    recorder.run_stage(listed_ ? sample_listed_ : sample_scan_, kBindNearGroups, kGroupsSamples);
  }
  recorder.barrier();

  // Pairs in touched voxels, and what those list; samples that the tool's partition leaves open.
  recorder.stage("pairs");
  recorder.run_stage(pair_test_, kBindListedGroups, kGroupsPairs);
  if (inside_) {
    recorder.stage("open");
    recorder.run_stage(sample_walk_, kBindListedGroups, kGroupsOpen);
  }
}

void FrameDetection::record_names(FrameRecorder& recorder) const {
  recorder.stage("sets");
  recorder.run(set_decide_, 1);
  recorder.run_stage(set_name_, kBindMembersGroups);
  recorder.barrier();
  recorder.stage("transform");
  recorder.run_dispatch(tool_clusters_place_, kDispatchContactClusters);
}

void FrameDetection::record_end(FrameRecorder& recorder) const {
  recorder.stage("reset");
  recorder.run_stage(frame_result_, kBindResultGroups);
}

void FrameDetection::record_anew(FrameRecorder& recorder) {
  for (const std::int32_t binding : {kBindFrameState, kBindNearGroups, kBindListedGroups, kBindMembersGroups,
                                     kBindPlacedGroups, kBindPushedGroups})
    recorder.clear(binding);
  // FrameLists is what BatchLists begins with.
  recorder.copy(kBindListsAnew, offsetof(FrameLists, lists), kBindFrameLists, sizeof FrameLists::lists);
  recorder.copy(kBindListsAnew, offsetof(FrameLists, result), kBindResultGroups, sizeof FrameLists::result);
}

}  // namespace palpate
