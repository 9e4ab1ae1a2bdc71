#include "compute/gpu/frame/field.h"

#include <algorithm>
#include <cstring>

#include "compute/gpu/frame/plan.h"
#include "shaders/code.h"
#include "shaders/shared/frame_batch.h"

namespace palpate {

using namespace gpu;  // names of shaders/shared/frame_field.h

namespace {

constexpr std::uint32_t kCarriersId = 8;  // of the constant CARRIERS: somebody looks at triangles
constexpr std::uint32_t kFieldId = 9;     // of the constant FIELD of field_result

WideSum wide(std::int64_t low, std::int64_t high) { return {low, high}; }

FieldBin bin_of(const FieldBinWork& from) {
  FieldBin out;
  out.samples = static_cast<std::uint32_t>(from.samples);
  for (std::size_t k = 0; k < 3; ++k) {
    out.push[k] = wide(from.push_low[k], from.push_high[k]);
    out.turn[k] = wide(from.turn_low[k], from.turn_high[k]);
    out.give_at[k] = from.give_at[k];
  }
  out.give = from.give;
  std::copy(std::begin(from.give_spread), std::end(from.give_spread), out.give_spread.begin());
  return out;
}

CarrierSums carrier_of(std::uint32_t id, const CarrierWork& from) {
  CarrierSums out;
  out.id = id;
  out.samples = static_cast<std::uint32_t>(from.samples);
  out.max_depth = static_cast<std::uint32_t>(from.max_depth);
  out.weight_sum = from.weight_sum;
  out.depth_sum = from.depth_sum;
  for (std::size_t k = 0; k < 3; ++k) {
    out.push[k] = wide(from.push_low[k], from.push_high[k]);
    out.moment[k] = wide(from.moment_low[k], from.moment_high[k]);
  }
  return out;
}

}  // namespace

Result<FrameField> FrameField::create(VulkanDevice& device, const SceneGeometry& geometry,
                                      const PreparedScene& scene, const Plan& plan, bool batch) {
  FrameField out;
  out.geometry_ = &geometry;
  out.plan_ = plan;
  const BodyConstants &mockup = scene.constants.mockup, &tool = scene.constants.tool;
  out.inside_ = scene.constants.tool_has_inside != 0;
  const std::uint32_t inside = out.inside_ ? 1 : 0, mockup_inside = scene.constants.mockup_has_inside,
                      listed = scene.tool_sample_points ? 1 : 0;
  const auto has_sheets = [](const LatticeMesh& mesh) {
    return std::ranges::any_of(mesh.flags, [](std::uint8_t flags) { return (flags & kTriangleSheet) != 0; });
  };
  const std::uint32_t mockup_sheets = mockup_inside == 0 || has_sheets(geometry.mockup) ? 1 : 0,
                      tool_sheets = !out.inside_ || has_sheets(geometry.tool) ? 1 : 0;
  struct ShaderPlan {
    FrameShader& shader;
    const ShaderCode& code;
    std::vector<SpecConstant> constants = {};
    bool kept = true;
  };
  for (const ShaderPlan& made_for : std::initializer_list<ShaderPlan>{
           {out.members_, spirv::field_members, {{0, inside}, {1, listed}}},
           {out.points_, spirv::field_points, {{0, mockup.closed}, {1, listed}}},
           {out.from_mockup_,
            spirv::field_from_mockup,
            {{0, tool.closed}, {1, mockup_sheets}, {2, mockup_inside}},
            out.inside_},
           {out.from_tool_, spirv::field_from_tool, {{0, mockup.closed}, {1, inside}, {2, tool_sheets}}},
           {out.result_, spirv::field_result},
           {out.touch_result_, spirv::field_result, {{kFieldId, 0u}}, batch},
       }) {
    if (!made_for.kept) continue;
    std::vector<SpecConstant> constants = plan_constants(plan);
    if (!plan.telemetry || &made_for.shader == &out.touch_result_) constants.push_back({kCarriersId, 0u});
    if (batch) constants.push_back({kBatchConstant, 1u});
    add_constants(work_cut(device, batch), constants);
    constants.insert(constants.end(), made_for.constants.begin(), made_for.constants.end());
    auto made = make_frame_shader(device, made_for.code, 0, constants);
    if (!made) return made.error();
    made_for.shader = std::move(*made);
  }
  return out;
}

Result<void> FrameField::make_buffers(VulkanDevice& device, const FrameCapacity& capacity,
                                      FrameBuffers& buffers) {
  struct BufferPlan {
    std::int32_t binding;
    const char* what;
    std::uint64_t bytes;
    BufferKind kind = BufferKind::kDevice;
  };
  const auto& lists = capacity.lists;
  const std::uint64_t carriers =
      (plan_.telemetry ? lists[kListContactStatics] : 1) * std::uint64_t{sizeof(CarrierWork)};
  const std::uint64_t field = sizeof(FieldWork) * std::max<std::uint64_t>(capacity.poses, 1);
  const std::uint64_t patches = (geometry_->mockup.patch_count + 31) / 32 * std::uint64_t{4};
  for (const BufferPlan& plan : std::initializer_list<BufferPlan>{
           {kBindCarrierWork, "what contact triangles carry", carriers},
           {kBindFieldTiles, "tiles of tool samples",
            lists[kListFieldTiles] * std::uint64_t{sizeof(FieldTile)}},
           {kBindMockupPoints, "extra samples", lists[kListMockupPoints] * std::uint64_t{sizeof(FieldPoint)}},
           {kBindToolPoints, "samples of the tool",
            lists[kListToolPoints] * std::uint64_t{sizeof(FieldPoint)}},
           {kBindIgnored, "ignored patches", patches, BufferKind::kUpload},
           {kBindResultIgnored, "ignored patches that are touched", lists[kListIgnored] * std::uint64_t{4},
            BufferKind::kReadback},
           {kBindResultField, "result of the pressure field", field, BufferKind::kReadback},
           {kBindResultCarriers, "result of what contact triangles carry", carriers, BufferKind::kReadback},
       }) {
    const bool there = buffers.bytes(plan.binding) >= std::max<std::uint64_t>(plan.bytes, 4);
    if (auto made = buffers.make(device, plan.binding, plan.what, plan.bytes, plan.kind); !made)
      return made.error();
    if (plan.binding == kBindIgnored && !there) {
      ignored_bits_.assign(buffers[kBindIgnored].bytes() / 4, 0);
      buffers[kBindIgnored].write(0, ignored_bits_.data(), buffers[kBindIgnored].bytes());
      ignored_.clear();
    }
  }
  for (const std::int32_t binding : {kBindFineExit, kBindMockupShells, kBindFineShells})
    if (buffers.bytes(binding) == 0)  // whether a body is closed says what of them anybody reads
      if (auto made = buffers.make(device, binding, "unused", 4); !made) return made.error();
  for (const std::int32_t binding : {kBindToolSamplePoints, kBindToolSampleEnds})
    if (buffers.bytes(binding) == 0)  // samples that are not listed
      if (auto made = buffers.make(device, binding, "unused", 16, BufferKind::kTexels); !made)
        return made.error();
  if (auto made = buffers.make_table(device, kBindFieldWork, "pressure field", field); !made)
    return made.error();
  return buffers.make_table(device, kBindIgnoredState, "states of ignored patches", patches);
}

void FrameField::record(FrameRecorder& recorder) const {
  recorder.stage("sets");
  recorder.run_stage(members_, kBindMembersGroups);
  recorder.barrier();
  recorder.stage("samples");
  recorder.run_stage(points_, kBindPlacedGroups);
  recorder.barrier();
  recorder.stage("field");
  recorder.run_stage(from_tool_, kBindPushedGroups, kGroupsToolPush);
  if (inside_) recorder.run_stage(from_mockup_, kBindPushedGroups, kGroupsMockupPush);
  recorder.barrier();
  recorder.stage("reset");
  recorder.run_stage(result_, kBindResultGroups);
}

void FrameField::record_touch(FrameRecorder& recorder) const {
  recorder.stage("reset");
  recorder.run_stage(touch_result_, kBindResultGroups);
}

bool FrameField::ignore(const Ignored* ignored, const FrameBuffers& buffers) {
  static const std::vector<std::uint32_t> none;
  const std::vector<std::uint32_t>& wanted = ignored != nullptr ? ignored->patches : none;
  if (wanted == ignored_) return !wanted.empty();
  const std::uint32_t patches = geometry_->mockup.patch_count;
  for (const bool on : {false, true})
    for (const std::uint32_t patch : on ? wanted : ignored_) {
      if (patch >= patches) continue;
      std::uint32_t& word = ignored_bits_[patch / 32];
      word = on ? word | 1u << patch % 32 : 0;  // no other patch of the word stays ignored but by `wanted`
      buffers[kBindIgnored].write(patch / 32 * sizeof word, &word, sizeof word);
    }
  ignored_ = wanted;
  return !wanted.empty();
}

void decode_field(const FieldWork& work, Contacts& out) {
  FieldSums& field = out.field;
  bool pushes = false;
  for (std::size_t i = 0; i < kFieldBins; ++i) {
    field.bins[i] = bin_of(work.bins[i]);
    pushes |= field.bins[i].samples != 0;
  }
  field.max_depth = static_cast<std::uint32_t>(work.deepest_static >> 32);
  field.deepest_static = field.max_depth != 0 ? ~static_cast<std::uint32_t>(work.deepest_static) : 0;
  field.deepest_mobile = field.max_depth != 0 ? ~static_cast<std::uint32_t>(work.deepest_mobile) : 0;
  if (work.sheet != 0) out.flags |= kFlagSheet;
  if (!pushes) out.flags |= kFlagNoDirection;
}

void add_carrier(const StaticResult& of, const CarrierWork& work, Contacts& out) {
  if ((of.state & (kStaticHit | kStaticSampled)) != 0) out.carriers.push_back(carrier_of(of.id, work));
}

void order_carriers(Contacts& out) {
  std::sort(out.carriers.begin(), out.carriers.end(),
            [](const CarrierSums& a, const CarrierSums& b) { return a.id < b.id; });
}

void FrameField::decode(const FrameBuffers& buffers, const FrameResult& result, Contacts& out) {
  decode_field(*buffers[kBindResultField].as<FieldWork>(), out);
  const auto* touched = buffers[kBindResultIgnored].as<std::uint32_t>();
  out.ignored_touched.assign(touched, touched + result.ignored_count);
  std::sort(out.ignored_touched.begin(), out.ignored_touched.end());

  if (!out.lists) return;
  const auto* statics = buffers[kBindResultStatics].as<StaticResult>();
  const auto* carriers = buffers[kBindResultCarriers].as<CarrierWork>();
  for (std::uint32_t slot = 0; slot < result.static_count; ++slot)
    add_carrier(statics[slot], carriers[slot], out);
  order_carriers(out);
}

static_assert(kFieldBins == kFieldBinCount);

}  // namespace palpate
