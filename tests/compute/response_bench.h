#pragma once
#include <algorithm>
#include <cstdint>
#include <vector>

#include "compute/frame_recorder.h"
#include "compute/frame_response.h"
#include "shaders/code.h"
#include "shaders/shared/scene.h"
#include "tests/compute/gpu_test.h"

namespace palpate {

/// What detection would leave for the response, made up by a test, and everything else empty.
struct ResponseCase {
  std::vector<gpu::ivec3> mockup_vertices, mockup_normals;
  std::vector<gpu::uvec3> mockup_triangles;
  std::vector<std::uint32_t> mockup_info, mockup_weights;
  std::vector<std::vector<std::uint32_t>> neighbours, seams;   ///< by static id; neighbours as id · 2 + smooth
  std::vector<gpu::ivec3> tool_world;                          ///< transformed vertices
  std::vector<gpu::uvec3> tool_triangles;
  std::vector<std::uint32_t> contact_statics, contact_mobiles; ///< C_s in the order of slots, C_m
  std::vector<std::uint32_t> static_state;                     ///< by static id
  std::vector<gpu::FrameSample> samples;
  std::vector<gpu::ContactPair> pairs;
  std::vector<gpu::HeldStatic> held_statics;
  std::vector<gpu::HeldDirection> held_areas;
  bool tool_closed = true;
};

struct ResponseAnswer {
  gpu::FrameState state{};
  std::uint32_t area_count = 0;
  std::vector<gpu::AreaResult> areas;
  std::vector<gpu::StaticResult> statics;
  std::vector<gpu::AreaMember> members;
  std::vector<gpu::AreaPierce> pierces;
};

/// Runs the response alone on such a case. Failures are test failures.
class ResponseTest : public GpuTest {
 protected:
  ResponseAnswer run(const ResponseCase& c) {
    ResponseAnswer answer;
    FrameBuffers buffers;
    fill(buffers, c);
    auto response = FrameResponse::create(device(), true);
    EXPECT_TRUE(response) << response.error().sentence;
    FrameCapacity capacity;
    capacity.lists[gpu::kListContactStatics] = size(c.contact_statics);
    capacity.lists[gpu::kListSamples] = size(c.samples);
    capacity.lists[gpu::kListMobileTiles] = kMostTiles;
    capacity.lists[gpu::kListNeedleVertices] = kMostNeedles;
    capacity.needle_table = 2 * kMostNeedles;
    const auto made = response->make_buffers(device(), size(c.tool_triangles), capacity, buffers);
    EXPECT_TRUE(made) << made.error().sentence;
    EXPECT_TRUE(buffers.clear_tables(device()));
    auto close = make_frame_shader(device(), spirv::list_close, 4);
    EXPECT_TRUE(close);
    auto commands = CommandRecorder::create(device(), 8);
    EXPECT_TRUE(commands);
    commands->begin();
    FrameRecorder recorder(*commands, buffers, *close);
    response->record(recorder);
    auto done = commands->submit_and_wait();
    EXPECT_TRUE(done) << done.error().sentence;

    answer.state = read<gpu::FrameState>(buffers, gpu::kBindFrameState, 1)[0];
    const auto result = read<gpu::FrameResult>(buffers, gpu::kBindResult, 1)[0];
    const auto lists = read<gpu::FrameList>(buffers, gpu::kBindFrameLists, gpu::kListCount);
    answer.area_count = result.area_count;
    answer.areas.assign(result.areas, result.areas + result.area_count);
    answer.statics = read<gpu::StaticResult>(buffers, gpu::kBindResultStatics, c.contact_statics.size());
    answer.members = read<gpu::AreaMember>(buffers, gpu::kBindResultMembers, lists[gpu::kListMembers].count);
    answer.pierces = read<gpu::AreaPierce>(buffers, gpu::kBindResultPierces, lists[gpu::kListPierces].count);
    return answer;
  }

 private:
  static constexpr std::uint32_t kMostTiles = 1u << 16, kMostNeedles = 1u << 12;

  template <class T>
  static std::uint32_t size(const std::vector<T>& v) { return static_cast<std::uint32_t>(v.size()); }

  template <class T>
  void put(FrameBuffers& buffers, std::int32_t binding, const std::vector<T>& data) {
    ASSERT_TRUE(buffers.make(device(), binding, "test data", data.size() * sizeof(T)));
    if (!data.empty()) {
      ASSERT_TRUE(upload(device(), buffers[binding], data.data(), data.size() * sizeof(T)));
    }
  }

  template <class T>
  std::vector<T> read(const FrameBuffers& buffers, std::int32_t binding, std::size_t count) {
    std::vector<T> out(count);
    if (count > 0) {
      EXPECT_TRUE(download(device(), buffers[binding], 0, out.data(), count * sizeof(T)));
    }
    return out;
  }

  void put_lists(FrameBuffers& buffers, std::int32_t begin, std::int32_t entries, const std::vector<std::vector<std::uint32_t>>& lists) {
    std::vector<std::uint32_t> from{0}, all;
    for (const auto& list : lists) {
      all.insert(all.end(), list.begin(), list.end());
      from.push_back(size(all));
    }
    put(buffers, begin, from);
    put(buffers, entries, all);
  }

  void fill(FrameBuffers& buffers, const ResponseCase& c) {
    using namespace gpu;
    for (std::int32_t binding = 0; binding < kBindResponseFirst; ++binding)
      ASSERT_TRUE(buffers.make(device(), binding, "nothing", 64));   // whatever is not said below
    SceneConstants scene{};
    scene.mockup.grid = {ivec3(-1024), 256, ivec3(1), 0, 0, 0};
    scene.mockup.triangles = size(c.mockup_triangles);
    scene.tool.triangles = size(c.tool_triangles);
    scene.tool.closed = c.tool_closed ? 1 : 0;
    scene.sample_spacing = 64;
    scene.refined = 1;
    put(buffers, kBindScene, std::vector{scene});
    put(buffers, kBindMockupBrickSlot, std::vector{kBrickExternal});
    put(buffers, kBindMockupVertices, c.mockup_vertices);
    put(buffers, kBindMockupTriangles, c.mockup_triangles);
    put(buffers, kBindMockupNormals, c.mockup_normals);
    put(buffers, kBindMockupInfo, c.mockup_info);
    put(buffers, kBindMockupWeights, c.mockup_weights);
    put_lists(buffers, kBindNeighbourBegin, kBindNeighbours, c.neighbours);
    put_lists(buffers, kBindSeamBegin, kBindSeams, c.seams);

    put(buffers, kBindToolVertices, c.tool_world);   // the pose is the identity
    put(buffers, kBindToolTriangles, c.tool_triangles);
    const std::size_t tool = c.tool_triangles.size();
    put(buffers, kBindToolInfo, std::vector<std::uint32_t>(tool, 2u << kInfoAxisShift));
    put(buffers, kBindToolNormals, std::vector<ivec3>(tool, ivec3(0, 0, -(1 << 30))));
    put(buffers, kBindToolWeights, std::vector<std::uint32_t>(tool, 1u << 30));
    std::vector<LatticeBox> boxes((tool + kClusterSize - 1) / kClusterSize, LatticeBox{ivec3(INT32_MAX), ivec3(INT32_MIN)});
    for (std::size_t t = 0; t < tool; ++t)
      for (const std::uint32_t v : {c.tool_triangles[t].x, c.tool_triangles[t].y, c.tool_triangles[t].z}) {
        LatticeBox& box = boxes[t / kClusterSize];
        box.low = glm::min(box.low, c.tool_world[v]);
        box.high = glm::max(box.high, c.tool_world[v]);
      }
    put(buffers, kBindClusterBoxes, boxes);
    std::vector<LatticeBox> runs(boxes.size() * kClusterSize / kRunSize, LatticeBox{ivec3(INT32_MAX), ivec3(INT32_MIN)});
    std::vector<ToolCorners> corners;
    for (std::size_t t = 0; t < tool; ++t) {
      const uvec3 v = c.tool_triangles[t];
      corners.push_back({c.tool_world[v.x], c.tool_world[v.y], c.tool_world[v.z]});
      LatticeBox& box = runs[t / kRunSize];
      box.low = glm::min(glm::min(box.low, corners[t].a), glm::min(corners[t].b, corners[t].c));
      box.high = glm::max(glm::max(box.high, corners[t].a), glm::max(corners[t].b, corners[t].c));
    }
    put(buffers, kBindRunBoxes, runs);
    put(buffers, kBindToolCorners, corners);

    put(buffers, kBindContactStatics, c.contact_statics);
    put(buffers, kBindContactMobiles, c.contact_mobiles);
    put(buffers, kBindStaticState, c.static_state);
    std::vector<std::uint32_t> slot(c.static_state.size(), kNone);
    for (std::uint32_t i = 0; i < c.contact_statics.size(); ++i) slot[c.contact_statics[i]] = i;
    put(buffers, kBindStaticSlot, slot);
    put(buffers, kBindSamples, c.samples);
    put(buffers, kBindPairs, c.pairs);
    put(buffers, kBindHeldStatics, c.held_statics);
    put(buffers, kBindHeldAreas, c.held_areas);
    put(buffers, kBindResult, std::vector<FrameResult>(1));
    put(buffers, kBindResultStatics, std::vector<StaticResult>(c.contact_statics.size()));
    const std::uint32_t most_members = size(c.contact_mobiles) * kMaxFrameAreas, most_pierces = kMaxFrameAreas * kMaxFrameAreas;
    put(buffers, kBindResultMembers, std::vector<AreaMember>(most_members));
    put(buffers, kBindResultPierces, std::vector<AreaPierce>(most_pierces));

    FrameInput input{};
    for (const int k : {0, 4, 8}) input.rotation_q30[k] = 1 << 30;
    input.held_areas = size(c.held_areas);
    input.held_statics = size(c.held_statics);
    put(buffers, kBindFrameInput, std::vector{input});
    FrameState state{};
    state.contact = 1;
    put(buffers, kBindFrameState, std::vector{state});

    std::vector<FrameList> lists(kListCount);
    const auto set_list = [&](std::uint32_t list, std::uint32_t count, std::uint32_t capacity) {
      lists[list].count = lists[list].asked = count;
      lists[list].capacity = capacity;
      lists[list].items = groups(count);
      lists[list].groups = {count, 1, 1};
    };
    set_list(kListContactStatics, size(c.contact_statics), size(c.contact_statics));
    set_list(kListContactMobiles, size(c.contact_mobiles), size(c.contact_mobiles));
    set_list(kListSamples, size(c.samples), size(c.samples));
    set_list(kListPairs, size(c.pairs), size(c.pairs));
    set_list(kListMembers, 0, most_members);
    set_list(kListPierces, 0, most_pierces);
    set_list(kListMobileTiles, 0, kMostTiles);
    set_list(kListNeedleVertices, 0, kMostNeedles);
    put(buffers, kBindFrameLists, lists);
    std::vector<DispatchArguments> dispatches(kDispatchCount);
    dispatches[kDispatchContactOne] = {1, 1, 1};
    dispatches[kDispatchContactStatics] = groups(size(c.contact_statics));
    dispatches[kDispatchContactMobiles] = groups(size(c.contact_mobiles));
    dispatches[kDispatchSamples] = groups(size(c.samples));
    dispatches[kDispatchHeightRuns] = groups((size(c.samples) + kHeightRun - 1) / kHeightRun);
    dispatches[kDispatchHeldStatics] = groups(size(c.held_statics));
    put(buffers, kBindDispatches, dispatches);
  }

  static gpu::DispatchArguments groups(std::uint32_t items) { return {(items + gpu::kGroupSize - 1) / gpu::kGroupSize, items > 0 ? 1u : 0u, 1}; }
};

}  // namespace palpate
