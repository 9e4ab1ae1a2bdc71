#include "cpu_ref/field.h"

#include <algorithm>
#include <limits>
#include <set>

#include "cpu_ref/depth.h"
#include "cpu_ref/direction.h"
#include "cpu_ref/samples.h"
#include "cpu_ref/sets.h"

namespace palpate::cpu_ref {
namespace {

void add(WideSum& sum, std::int64_t term) {
  sum.low += term & 0xFFFFFFFF;
  sum.high += term >> 32;
}

/// A sample that lies inside the other body.
struct Push {
  Int3 at{0};                  ///< world lattice
  Int3 along{0};               ///< n: the way it pushes the tool, Q30
  Int3 against{0};             ///< u: φ falls as the tool moves along it, Q30
  std::uint32_t depth = 0;     ///< φ, steps
  std::uint32_t weight = 0;    ///< w, Q30: half of the sample's, for the other body's samples say the same once more; all of it where they can't (sheets)
  std::uint32_t whole = 0;     ///< the sample's own
};

/// Which of the bins a direction belongs to: about an eighth of a turn round each axis, edge and corner of a cube.
std::uint32_t bin_of(const Int3& n) {
  constexpr std::int32_t kLeast = 444764242;   // tan 22.5° in Q30
  std::uint32_t bin = 0;
  for (int k = 2; k >= 0; --k) bin = 3 * bin + (n[k] > kLeast ? 2 : n[k] < -kLeast ? 0 : 1);
  return bin;
}

class Summing {
 public:
  Summing(const Frame& frame, Contacts& out) : frame_(frame), out_(out), shift_(lever_shift(frame.scene.geometry->tool_radius)) {}

  void add_push(const Push& push, std::uint32_t static_id, std::uint32_t mobile, CarrierSums* carrier) {
    const Long3 r = difference(push.at, frame_.pose.translation);          // within tool_radius + a few
    const Long3 turned = cross(r, Long3(push.along));                      // within 2^60
    const auto p = static_cast<std::int64_t>((std::uint64_t{push.depth} * push.weight) >> 20);   // below 2^42
    FieldBin& bin = out_.field.bins[bin_of(push.along)];
    bin.samples += 1;
    for (int k = 0; k < 3; ++k) {
      const auto i = static_cast<std::size_t>(k);
      add(bin.push[i], p * (push.along[k] >> 10));
      add(bin.turn[i], (p >> 10) * (turned[k] >> 30));
    }
    // How the force gives way along the push: w (n·u), as the force law and the solver need it.
    std::int64_t steep = 0;
    for (int k = 0; k < 3; ++k) steep += std::int64_t{push.along[k]} * push.against[k];
    steep = std::max<std::int64_t>(steep >> 30, 0);
    const std::int64_t give = (std::int64_t{push.weight} * steep) >> 40;   // Q20
    const Long3 lever(r.x >> shift_, r.y >> shift_, r.z >> shift_);
    bin.give += give;
    for (int k = 0; k < 3; ++k) {
      const auto i = static_cast<std::size_t>(k);
      bin.give_at[i] += give * lever[k];
      bin.give_spread[i] += (give * lever[k] * lever[k]) >> 8;
      bin.give_spread[i + 3] += (give * lever[k] * lever[(k + 1) % 3]) >> 8;
    }
    FieldSums& field = out_.field;
    if (push.depth > field.max_depth) {
      field.max_depth = push.depth;
      field.deepest_static = static_id;
      field.deepest_mobile = mobile;
    } else if (push.depth == field.max_depth && push.depth > 0) {
      field.deepest_static = std::min(field.deepest_static, static_id);
      field.deepest_mobile = std::min(field.deepest_mobile, mobile);
    }
    if (carrier == nullptr) return;
    carrier->samples += 1;
    carrier->max_depth = std::max(carrier->max_depth, push.depth);
    const auto whole = static_cast<std::int64_t>((std::uint64_t{push.depth} * push.whole) >> 20);
    carrier->weight_sum += push.whole;
    carrier->depth_sum += whole;
    for (int k = 0; k < 3; ++k) {
      const auto i = static_cast<std::size_t>(k);
      add(carrier->push[i], whole * (push.along[k] >> 10));
      add(carrier->moment[i], (whole >> 10) * r[k]);
    }
  }

  /// The mock-up's samples in the tool's depth.
  void mockup_in_tool() {
    const LatticeMesh& mockup = frame_.mockup();
    for (const Sample& sample : frame_.counting)
      if (const std::uint32_t weight = mockup.field_weight_q30[sample.triangle]; weight != 0) mockup_sample(sample.triangle, sample.point, weight);
    if (!frame_.scene.tool_has_inside) return;
    for (const ExtraSample& extra : mockup.extra_samples)
      if (std::binary_search(frame_.contact_static.begin(), frame_.contact_static.end(), extra.triangle) && inside_tool(frame_, extra.point))
        mockup_sample(extra.triangle, extra.point, extra.weight_q30);
  }

  /// The tool's samples in the mock-up's depth.
  void tool_in_mockup() {
    const LatticeMesh& tool = frame_.tool_mesh();
    Box everywhere;
    everywhere.min = Int3(std::numeric_limits<std::int32_t>::min());
    everywhere.max = Int3(std::numeric_limits<std::int32_t>::max());
    for (const std::uint32_t m : frame_.contact_mobile)
      if (const std::uint32_t weight = tool.field_weight_q30[m]; weight != 0)
        for_each_sample(tool, m, frame_.scene.geometry->sample_spacing, everywhere, [&](const Int3& own) { tool_sample(m, own, weight); });
    for (const ExtraSample& extra : tool.extra_samples)
      if (std::binary_search(frame_.contact_mobile.begin(), frame_.contact_mobile.end(), extra.triangle)) tool_sample(extra.triangle, extra.point, extra.weight_q30);
  }

  /// CST and EST, ascending, with nothing on them yet.
  void begin_carriers() {
    std::vector<std::uint32_t> ids = out_.cst;
    ids.insert(ids.end(), out_.est.begin(), out_.est.end());
    std::sort(ids.begin(), ids.end());
    for (const std::uint32_t id : ids) out_.carriers.push_back({.id = id});
  }

  void list_touched() { out_.ignored_touched.assign(touched_.begin(), touched_.end()); }

 private:
  void mockup_sample(std::uint32_t id, const Int3& point, std::uint32_t weight) {
    const LatticeMesh &mockup = frame_.mockup(), &tool = frame_.tool_mesh();
    const auto below = nearest(tool, frame_.scene.tool_rest_tree, to_tool(frame_.pose, point));
    if (!below || ignored(id)) return;
    const bool sheet = is_sheet(mockup, id);
    Push push{.at = point, .against = -turned(frame_.pose, tool.unit_normal_q30[below->triangle]), .depth = below->steps};
    push.along = sheet ? push.against : mockup.unit_normal_q30[id];
    push.whole = weight;
    push.weight = weight >> (sheet ? 0 : 1);
    if (sheet) out_.flags |= kFlagSheet;
    add_push(push, id, below->triangle, carrier(id));
  }

  void tool_sample(std::uint32_t m, const Int3& own, std::uint32_t weight) {
    const LatticeMesh &mockup = frame_.mockup(), &tool = frame_.tool_mesh();
    const Int3 point = transform(frame_.pose, own);
    if (!inside_mockup(frame_, point)) return;
    const auto below = nearest(mockup, frame_.scene.mockup_tree, point);
    if (!below || ignored(below->triangle)) return;
    const bool sheet = is_sheet(tool, m) || !frame_.scene.tool_has_inside;
    Push push{.at = point, .against = mockup.unit_normal_q30[below->triangle], .depth = below->steps};
    push.along = sheet ? push.against : -turned(frame_.pose, tool.unit_normal_q30[m]);
    push.weight = weight >> (sheet ? 0 : 1);
    if (sheet) out_.flags |= kFlagSheet;
    add_push(push, below->triangle, m, nullptr);
  }

  /// Notes a contact that is left out.
  bool ignored(std::uint32_t static_id) {
    if (frame_.ignored == nullptr) return false;
    const std::vector<std::uint32_t>& patches = frame_.ignored->patches;
    const std::uint32_t patch = frame_.mockup().patch[static_id];
    if (!std::binary_search(patches.begin(), patches.end(), patch)) return false;
    touched_.insert(patch);
    return true;
  }

  CarrierSums* carrier(std::uint32_t id) {
    const auto found = std::lower_bound(out_.carriers.begin(), out_.carriers.end(), id, [](const CarrierSums& a, std::uint32_t b) { return a.id < b; });
    return found != out_.carriers.end() && found->id == id ? &*found : nullptr;
  }

  const Frame& frame_;
  Contacts& out_;
  int shift_;
  std::set<std::uint32_t> touched_;   ///< ignored patches in which something would push
};

}  // namespace

void sum_field(const Frame& frame, Contacts& out) {
  Summing summing(frame, out);
  summing.begin_carriers();
  summing.mockup_in_tool();
  summing.tool_in_mockup();
  summing.list_touched();
  const auto pushes = [](const FieldBin& bin) { return bin.samples > 0; };
  if (std::none_of(out.field.bins.begin(), out.field.bins.end(), pushes)) out.flags |= kFlagNoDirection;
}

}  // namespace palpate::cpu_ref
