#include "cpu_ref/field.h"

#include <algorithm>
#include <limits>
#include <set>

#include "cpu_ref/depth.h"
#include "cpu_ref/direction.h"
#include "cpu_ref/exact.h"
#include "cpu_ref/samples.h"
#include "cpu_ref/sets.h"

namespace palpate::cpu_ref {
namespace {

void add(WideSum& sum, std::int64_t term) {
  sum.low += term & 0xFFFFFFFF;
  sum.high += term >> 32;
}

/// floor(a·b / 1024).
std::int64_t over_1024(std::int64_t a, std::int64_t b) {
  return static_cast<std::int64_t>((Int128{a} * b) >> 10);
}

/// A sample that lies inside the other body.
struct Push {
  Int3 at{0};                ///< world lattice
  Int3 along{0};             ///< n: the way it pushes the tool, Q30
  Int3 against{0};           ///< u: φ falls as the tool moves along it, Q30
  std::uint32_t depth = 0;   ///< φ, steps
  std::uint32_t weight = 0;  ///< what counts of the sample's w, Q24: half, for the other body's samples say
                             ///< the same once more; all of it where they can't (sheets); 0: none pushes
  std::uint32_t whole = 0;   ///< the sample's own
};

bool is_thin(const LatticeMesh& mesh, std::uint32_t id) { return (mesh.flags[id] & kTriangleThin) != 0; }

/// What counts of a sample's weight: half of it, but what lies in a thin piece counts for nothing, and the
/// thin piece's own samples wholly.
std::uint32_t counted_weight(std::uint32_t weight, bool own_thin, bool other_thin) {
  return own_thin == other_thin ? weight / 2 : own_thin ? weight : 0;
}

/// Which of the bins a direction belongs to: about an eighth of a turn round each axis, edge and corner of a
/// cube.
std::uint32_t bin_of(const Int3& n) {
  constexpr std::int32_t kLeast = 444764242;  // tan 22.5° in Q30
  std::uint32_t bin = 0;
  for (int k = 2; k >= 0; --k) bin = 3 * bin + (n[k] > kLeast ? 2 : n[k] < -kLeast ? 0 : 1);
  return bin;
}

/// 256 log2(count), straight between powers of two.
std::int64_t binary_log_q8(std::int64_t count) {
  int whole = 0;
  while ((count >> whole) >= 2) ++whole;
  return 256 * whole + (count * 256 >> whole) - 256;
}

class Summing {
 public:
  Summing(const Frame& frame, Contacts& out)
      : frame_(frame), out_(out), shift_(lever_shift(frame.scene.geometry->tool_radius)) {
    const std::int64_t wanted = frame.scene.geometry->contact_samples;
    const auto grade_of = [&](std::int64_t samples) -> std::int64_t {
      return wanted > 0 && samples > wanted ? binary_log_q8(samples) - binary_log_q8(wanted) : 0;
    };
    const auto samples_of = [&](const std::vector<std::uint32_t>& set) {
      std::int64_t sum = 0;
      for (const std::uint32_t m : set) sum += frame.tool_mesh().grid_samples[m];
      return sum;
    };
    const auto inside = static_cast<std::int64_t>(frame.counting.size()),
               tools = static_cast<std::int64_t>(frame.contact_mobile.size());
    const std::int64_t deep = samples_of(out.imt), most = 256 * kSurfaceLevels;
    mockup_grade_ = std::max(std::min(grade_of(inside + tools / 16), most), grade_of(deep / 4));
    // The tool's own samples inside are not known yet: about half of a cut triangle's, and about as many as
    // the mock-up's.
    tool_grade_ =
        std::max(mockup_grade_, std::min(grade_of(deep + std::min(samples_of(out.cmt) / 2, inside)), most));
    for (std::int64_t* grade : {&mockup_grade_, &tool_grade_}) {
      if (frame.ignored != nullptr) *grade += frame.ignored->coarser;
      *grade = std::min<std::int64_t>(*grade, 256 * kSampleLevels);
    }
  }

  /// What a sample inside the other body adds.
  void add_sample(const Push& push, std::uint32_t static_id, std::uint32_t mobile, CarrierSums* carrier) {
    const Long3 r = difference(push.at, frame_.pose.translation);  // within tool_radius + a few
    if (push.weight != 0) add_push(push, r);
    add_depth(push.depth, static_id, mobile);
    if (carrier != nullptr) add_carried(push, r, *carrier);
  }

  /// The mock-up's samples in the tool's depth.
  void mockup_in_tool() {
    const LatticeMesh& mockup = frame_.mockup();
    for (const Sample& sample : frame_.counting)
      if (const std::uint64_t weight = weight_of(mockup, sample.triangle, sample.point,
                                                 frame_.scene.geometry->sample_spacing, mockup_grade_);
          weight != 0)
        mockup_sample(sample.triangle, sample.point, static_cast<std::uint32_t>(weight >> 6));
    if (!frame_.scene.tool_has_inside) return;
    for (const ExtraSample& extra : mockup.extra_samples)
      if (const std::uint64_t weight = weight_of(extra, mockup_grade_);
          weight != 0 &&
          std::binary_search(frame_.contact_static.begin(), frame_.contact_static.end(), extra.triangle) &&
          inside_tool(frame_, extra.point))
        mockup_sample(extra.triangle, extra.point, static_cast<std::uint32_t>(weight >> 6));
  }

  /// The tool's samples in the mock-up's depth.
  void tool_in_mockup() {
    const LatticeMesh& tool = frame_.tool_mesh();
    Box everywhere;
    everywhere.min = Int3(std::numeric_limits<std::int32_t>::min());
    everywhere.max = Int3(std::numeric_limits<std::int32_t>::max());
    const std::int32_t spacing = frame_.scene.geometry->sample_spacing;
    for (const std::uint32_t m : frame_.contact_mobile) {
      if (tool.field_weight_q30[m] == 0) continue;
      for_each_sample(tool, m, spacing, everywhere, [&](const Int3& own) {
        if (const std::uint64_t weight = weight_of(tool, m, own, spacing, tool_grade_); weight != 0)
          tool_sample(m, own, static_cast<std::uint32_t>(weight >> 6));
      });
    }
    for (const ExtraSample& extra : tool.extra_samples)
      if (const std::uint64_t weight = weight_of(extra, tool_grade_);
          weight != 0 &&
          std::binary_search(frame_.contact_mobile.begin(), frame_.contact_mobile.end(), extra.triangle))
        tool_sample(extra.triangle, extra.point, static_cast<std::uint32_t>(weight >> 6));
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
  void add_push(const Push& push, const Long3& r) {
    const Long3 turned = cross(r, Long3(push.along));                                           // within 2^60
    const auto p = static_cast<std::int64_t>((std::uint64_t{push.depth} * push.weight) >> 14);  // below 2^46
    FieldBin& bin = out_.field.bins[bin_of(push.along)];
    bin.samples += 1;
    for (int k = 0; k < 3; ++k) {
      const auto i = static_cast<std::size_t>(k);
      add(bin.push[i], p * (push.along[k] >> 10));
      add(bin.turn[i], over_1024(p, turned[k] >> 30));
    }
    // How the force gives way along the push: w (n·u), as the force law and the solver need it.
    std::int64_t steep = 0;
    for (int k = 0; k < 3; ++k) steep += std::int64_t{push.along[k]} * push.against[k];
    steep = std::max<std::int64_t>(steep >> 30, 0);
    const std::int64_t give = (std::int64_t{push.weight} * steep) >> 34;  // Q20
    const Long3 lever(r.x >> shift_, r.y >> shift_, r.z >> shift_);
    bin.give += give;
    for (int k = 0; k < 3; ++k) {
      const auto i = static_cast<std::size_t>(k);
      bin.give_at[i] += give * lever[k];
      bin.give_spread[i] += (give * lever[k] * lever[k]) >> 8;
      bin.give_spread[i + 3] += (give * lever[k] * lever[(k + 1) % 3]) >> 8;
    }
  }

  void add_depth(std::uint32_t depth, std::uint32_t static_id, std::uint32_t mobile) {
    FieldSums& field = out_.field;
    if (depth > field.max_depth) {
      field.max_depth = depth;
      field.deepest_static = static_id;
      field.deepest_mobile = mobile;
    } else if (depth == field.max_depth && depth > 0) {
      field.deepest_static = std::min(field.deepest_static, static_id);
      field.deepest_mobile = std::min(field.deepest_mobile, mobile);
    }
  }

  void add_carried(const Push& push, const Long3& r, CarrierSums& carrier) {
    carrier.samples += 1;
    carrier.max_depth = std::max(carrier.max_depth, push.depth);
    const auto whole = static_cast<std::int64_t>((std::uint64_t{push.depth} * push.whole) >> 14);
    carrier.weight_sum += push.whole;
    carrier.depth_sum += whole;
    for (int k = 0; k < 3; ++k) {
      const auto i = static_cast<std::size_t>(k);
      add(carrier.push[i], whole * (push.along[k] >> 10));
      add(carrier.moment[i], over_1024(whole, r[k]));
    }
  }

  /// What a grid sample weighs in this frame, Q30: between what it weighs at one level and at the next.
  std::uint64_t weight_of(const LatticeMesh& mesh, std::uint32_t triangle, const Int3& sample,
                          std::int32_t spacing, std::int64_t grade) const {
    const int axis = mesh.sample_axis[triangle];
    const int level = level_of({floor_divide(std::int64_t{sample[(axis + 1) % 3]}, std::int64_t{spacing}),
                                floor_divide(std::int64_t{sample[(axis + 2) % 3]}, std::int64_t{spacing})});
    const SideLevels* side =
        mesh.levels_of[triangle] == 0 ? nullptr : &mesh.side_levels[mesh.levels_of[triangle] - 1];
    const auto at = [&](std::int64_t wanted) -> std::uint64_t {
      const int taken =
          side == nullptr ? 0 : static_cast<int>(std::min<std::int64_t>(wanted, side->coarsest));
      if (level < taken) return 0;
      if (taken == 0) return mesh.field_weight_q30[triangle];
      return ((std::uint64_t{mesh.field_weight_q30[triangle]} *
               side->factor_q30[static_cast<std::size_t>(taken - 1)]) >>
              30)
             << taken;
    };
    return blended(at, grade);
  }

  /// Likewise of an extra sample.
  std::uint64_t weight_of(const ExtraSample& extra, std::int64_t grade) const {
    return blended(
        [&](std::int64_t wanted) -> std::uint64_t {
          if (wanted == 0) return extra.weight_q30;
          const std::int64_t taken = std::min<std::int64_t>(wanted, kSurfaceLevels);
          return std::uint64_t{extra.coarse_q30[static_cast<std::size_t>(taken - 1)]} << taken;
        },
        grade);
  }

  template <class AtLevel>
  static std::uint64_t blended(AtLevel&& at, std::int64_t grade) {
    const std::int64_t whole = grade / 256, part = grade % 256;
    return (static_cast<std::uint64_t>(256 - part) * at(whole) +
            static_cast<std::uint64_t>(part) * at(whole + 1)) >>
           8;
  }

  /// Whether a point of a mobile triangle counts as inside the mock-up: what touches nothing is on one side
  /// of it, with its first corner, if it is closed.
  bool counts_inside(std::uint32_t m, const Int3& point) const {
    if (!frame_.mockup().closed || std::binary_search(out_.cmt.begin(), out_.cmt.end(), m))
      return inside_mockup(frame_, point);
    return inside_mockup(frame_, transform(frame_.pose, frame_.tool_mesh().corner(m, 0)));
  }

  void mockup_sample(std::uint32_t id, const Int3& point, std::uint32_t weight) {
    const LatticeMesh &mockup = frame_.mockup(), &tool = frame_.tool_mesh();
    const auto below = nearest(tool, frame_.scene.tool_rest_tree, to_tool(frame_.pose, point));
    if (!below || ignored(id)) return;
    const bool sheet = is_sheet(mockup, id) || !frame_.scene.mockup_has_inside;
    Push push{.at = point,
              .against = -turned(frame_.pose, tool.unit_normal_q30[below->triangle]),
              .depth = below->steps};
    if (sheet)
      push.against =
          -turned(frame_.pose, way_out(tool, below->triangle, below->steps, to_tool(frame_.pose, point)));
    push.along = sheet ? push.against : mockup.unit_normal_q30[id];
    push.whole = weight;
    push.weight =
        sheet ? weight : counted_weight(weight, is_thin(mockup, id), is_thin(tool, below->triangle));
    if (!tool.closed) push.weight = frame_.open_tool.sure(push.weight, to_tool(frame_.pose, point));
    if (sheet) out_.flags |= kFlagSheet;
    add_sample(push, id, below->triangle, carrier(id));
  }

  void tool_sample(std::uint32_t m, const Int3& own, std::uint32_t weight) {
    const LatticeMesh &mockup = frame_.mockup(), &tool = frame_.tool_mesh();
    const Int3 point = transform(frame_.pose, own);
    if (!counts_inside(m, point)) return;
    const auto below = nearest(mockup, frame_.scene.mockup_tree, point);
    if (!below || ignored(below->triangle)) return;
    const bool sheet = is_sheet(tool, m) || !frame_.scene.tool_has_inside;
    Push push{.at = point, .against = mockup.unit_normal_q30[below->triangle], .depth = below->steps};
    if (sheet) push.against = way_out(mockup, below->triangle, below->steps, point);
    push.along = sheet ? push.against : -turned(frame_.pose, tool.unit_normal_q30[m]);
    push.weight = sheet ? weight : counted_weight(weight, is_thin(tool, m), is_thin(mockup, below->triangle));
    if (!mockup.closed) push.weight = frame_.open_mockup.sure(push.weight, point);
    if (sheet) out_.flags |= kFlagSheet;
    add_sample(push, below->triangle, m, nullptr);
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
    const auto found = std::lower_bound(out_.carriers.begin(), out_.carriers.end(), id,
                                        [](const CarrierSums& a, std::uint32_t b) { return a.id < b; });
    return found != out_.carriers.end() && found->id == id ? &*found : nullptr;
  }

  const Frame& frame_;
  Contacts& out_;
  int shift_;
  std::int64_t mockup_grade_ = 0, tool_grade_ = 0;  ///< the levels of their samples, Q8
  std::set<std::uint32_t> touched_;                 ///< ignored patches in which something would push
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
