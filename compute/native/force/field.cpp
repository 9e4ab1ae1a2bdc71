#include "compute/native/force/field.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdlib>
#include <functional>
#include <glm/vector_relational.hpp>
#include <optional>
#include <utility>

#include "compute/native/processor.h"
#include "compute/scene/exact.h"
#include "model/lattice/sample_grid.h"

namespace palpate {

using namespace gpu;  // names of shaders/shared/frame.h

namespace {

constexpr std::size_t kMostListed = std::size_t{1} << 22;  // samples of the tool (chosen: 48 MiB)
constexpr std::size_t kPart = 64;           // samples that count, of a part of the sum (chosen: some 10 us)
constexpr std::size_t kMostOfABody = 4096;  // of either body; beyond, parts are larger (chosen)

bool is_sheet(const LatticeMesh& mesh, std::uint32_t id) { return (mesh.flags[id] & kTriangleSheet) != 0; }

bool is_thin(const LatticeMesh& mesh, std::uint32_t id) { return (mesh.flags[id] & kTriangleThin) != 0; }

/// What counts of a sample's weight: half, for the other body says the same once more; of a thin piece and
/// one that isn't, the thin one's samples alone (EXACTNESS section 8). `in_thin`: the nearest triangle is
/// thin.
std::uint32_t counted(std::uint32_t weight, bool sheet, bool thin, bool in_thin) {
  if (sheet || (thin && !in_thin)) return weight;
  return thin == in_thin ? weight >> 1 : 0;
}

Int3 turned(const LatticePose& pose, const Int3& n) {
  Int3 out;
  for (int r = 0; r < 3; ++r) {
    const auto& row = pose.rotation_q30[r];
    out[r] = static_cast<std::int32_t>((std::int64_t{row[0]} * n.x + std::int64_t{row[1]} * n.y +
                                        std::int64_t{row[2]} * n.z + (std::int64_t{1} << 29)) >>
                                       30);
  }
  return out;
}

Int3 to_tool(const LatticePose& pose, const Int3& point) {
  Int3 at;
  for (int c = 0; c < 3; ++c) {
    std::int64_t sum = std::int64_t{1} << 29;
    for (int r = 0; r < 3; ++r)
      sum += pose.rotation_q30[r][c] * (std::int64_t{point[r]} - pose.translation[r]);
    at[c] = static_cast<std::int32_t>(sum >> 30);
  }
  return at;
}

/// 256 log2(count), count > 0, straight between powers of two.
std::uint32_t log_q8(std::uint64_t count) {
  const auto whole = static_cast<std::uint32_t>(std::bit_width(count) - 1);
  return 256 * whole + static_cast<std::uint32_t>((count << 8) >> whole) - 256;
}

void add_term(WideSum& sum, std::int64_t term) {
  sum.low += term & 0xFFFFFFFF;
  sum.high += term >> 32;
}

/// (p·x) >> 10 of the whole product: a small p keeps its last bits. p ≥ 0.
std::int64_t product_q10(std::int64_t p, std::int64_t x) { return (p >> 10) * x + (((p & 1023) * x) >> 10); }

void add_bin(FieldBin& bin, const FieldBin& more) {
  bin.samples += more.samples;
  bin.give += more.give;
  for (std::size_t k = 0; k < 3; ++k) {
    bin.push[k] += more.push[k];
    bin.turn[k] += more.turn[k];
    bin.give_at[k] += more.give_at[k];
  }
  for (std::size_t k = 0; k < 6; ++k) bin.give_spread[k] += more.give_spread[k];
}

/// The deepest of both, of several the smallest ids.
void add_deepest(FieldSums& field, std::uint32_t depth, std::uint32_t static_id, std::uint32_t mobile) {
  if (depth > field.max_depth) {
    field.max_depth = depth;
    field.deepest_static = static_id;
    field.deepest_mobile = mobile;
  } else if (depth == field.max_depth && depth > 0) {
    field.deepest_static = std::min(field.deepest_static, static_id);
    field.deepest_mobile = std::min(field.deepest_mobile, mobile);
  }
}

}  // namespace

/// A sample inside the other body (EXACTNESS section 8).
struct PressureField::Push {
  Int3 at;
  Int3 along, against;  ///< n and u
  std::uint32_t depth;
  std::uint32_t weight;   ///< the sample's own, Q24
  std::uint32_t counted;  ///< of it; 0 pushes nothing
  bool sheet;
};

PressureField::Extras::Extras(const LatticeMesh& mesh)
    : all_(mesh.extra_samples), has_((mesh.triangles.size() + 63) / 64) {
  for (const ExtraSample& extra : all_)
    has_[extra.triangle >> 6] |= std::uint64_t{1} << (extra.triangle & 63);
  std::uint32_t bits = 0;
  for (const std::uint64_t word : has_) {
    before_.push_back(bits);
    bits += static_cast<std::uint32_t>(std::popcount(word));
  }
  for (std::size_t level = 0; level < levels_.size(); ++level) {
    const auto weighs = [&](const ExtraSample& extra, std::size_t at) {
      return at == 0 || extra.coarse_q30[at - 1] != 0;
    };
    Level& out = levels_[level];
    for (std::uint32_t i = 0; i < all_.size(); ++i) {
      if (i == 0 || all_[i].triangle != all_[i - 1].triangle)
        out.begin.push_back(static_cast<std::uint32_t>(out.number.size()));
      if (weighs(all_[i], level) || weighs(all_[i], std::min(level + 1, levels_.size() - 1)))
        out.number.push_back(i);
    }
    out.begin.push_back(static_cast<std::uint32_t>(out.number.size()));
  }
}

template <class Take>
void PressureField::Extras::for_each(std::uint32_t triangle, std::uint32_t level, Take&& take) const {
  const std::uint64_t word = has_[triangle >> 6], bit = std::uint64_t{1} << (triangle & 63);
  if ((word & bit) == 0) return;
  const std::size_t place =
      before_[triangle >> 6] + static_cast<std::size_t>(std::popcount(word & (bit - 1)));
  const Level& from = levels_[std::min<std::size_t>(level, levels_.size() - 1)];
  for (std::uint32_t i = from.begin[place]; i < from.begin[place + 1]; ++i) take(all_[from.number[i]]);
}

PressureField PressureField::make(const SceneGeometry& geometry, const TriangleTree& mockup,
                                  const InsideSearch& in_mockup, const TriangleTree& tool,
                                  const InsideSearch& in_tool, std::span<const std::uint32_t> order,
                                  const HasInside& has_inside) {
  PressureField out;
  out.geometry_ = &geometry;
  out.in_tool_ = &in_tool;
  for (Lane& lane : out.lanes_) {
    lane.mockup_depth = DepthSearch(geometry.mockup, mockup, geometry.sample_spacing);
    lane.tool_depth = DepthSearch(geometry.tool, tool, geometry.sample_spacing);
    lane.in_mockup = in_mockup;
  }
  out.has_inside_ = has_inside;
  out.mockup_extras_ = Extras(geometry.mockup);
  out.tool_extras_ = Extras(geometry.tool);
  out.lever_shift_ = lever_shift(geometry.tool_radius);
  out.list_tool_samples(order);
  return out;
}

/// Triangle by triangle as C_m has them.
void PressureField::list_tool_samples(std::span<const std::uint32_t> order) {
  const LatticeMesh& tool = geometry_->tool;
  const double density = static_cast<double>(geometry_->sample_spacing) * geometry_->sample_spacing;
  if (geometry_->tool_surface.area / density + static_cast<double>(tool.triangles.size()) >
      static_cast<double>(kMostListed))
    return;
  own_.resize(tool.triangles.size());
  std::vector<std::pair<int, Int3>> samples;  // level and point, of a triangle
  for (const std::uint32_t id : order) {
    if (tool.field_weight_q30[id] == 0) continue;
    samples.clear();
    work_out_tool_samples(id, [&](const Int3& p, int level) { samples.emplace_back(level, p); });
    std::ranges::stable_sort(samples, std::ranges::greater{}, &std::pair<int, Int3>::first);
    OwnSamples& own = own_[id];
    own.begin = static_cast<std::uint32_t>(own_samples_.size());
    const std::uint32_t side = tool.levels_of[id],
                        coarsest = side == 0 ? 0 : tool.side_levels[side - 1].coarsest;
    for (std::uint32_t level = 0; level < own.weigh.size(); ++level)
      own.weigh[level] = static_cast<std::uint32_t>(std::ranges::count_if(samples, [&](const auto& sample) {
        return sample.first >= static_cast<int>(std::min(level, coarsest));
      }));
    for (const auto& [level, point] : samples) {
      own_samples_.push_back(point);
      own_levels_.push_back(static_cast<std::uint8_t>(level));
    }
  }
}

template <class Take>
void PressureField::work_out_tool_samples(std::uint32_t mobile, Take&& take) const {
  const LatticeMesh& tool = geometry_->tool;
  if (tool.collapsed(mobile)) return;
  const exact::Corners corners{tool.corner(mobile, 0), tool.corner(mobile, 1), tool.corner(mobile, 2)};
  const exact::Box box = exact::box_of(corners);
  const int axis = tool.sample_axis[mobile];
  const std::int32_t spacing = geometry_->sample_spacing;
  exact::for_samples(
      corners, axis, spacing, box.low - Int3(1), box.high + Int3(1),
      [&](const Int3& p, std::int64_t i, std::int64_t j) { take(p, SampleGrid::level(i, j)); });
}

/// The mock-up's samples inside the tool are counted already; the tool's inside the mock-up are guessed:
/// those of triangles that lie deep inside, and half of those of triangles that are cut, but no more than the
/// mock-up has in there, for of a large triangle only a corner may be inside.
void PressureField::choose_levels(const FoundSets& found, std::uint32_t coarser) {
  std::uint64_t deep = 0, cut = 0;  // samples of triangles in IMT and in CMT
  for (const MobileResult& result : found.mobiles)
    if ((result.state & kMobileHit) != 0)
      cut += geometry_->tool.grid_samples[result.id];
    else if ((result.state & kMobileInternal) != 0)
      deep += geometry_->tool.grid_samples[result.id];
  const std::uint64_t wanted = geometry_->contact_samples, counted = found.samples.size();
  const auto beyond = [&](std::uint64_t count) {
    return wanted != 0 && count > wanted ? log_q8(count) - log_q8(wanted) : 0;
  };
  constexpr std::uint32_t kMostBySize = 256 * kSurfaceLevels;
  const std::uint32_t of_mockup = std::max(std::min(beyond(counted + found.mobiles.size() / 16), kMostBySize),
                                           beyond(deep / 4)),
                      of_tool = std::max(of_mockup,
                                         std::min(beyond(deep + std::min(cut / 2, counted)), kMostBySize));
  const auto level = [&](std::uint32_t by_size) -> Level {
    const std::uint32_t all = std::min(by_size + coarser, Ignored::kCoarsest);
    return {all >> 8, all & 255};
  };
  mockup_level_ = level(of_mockup);
  tool_level_ = level(of_tool);
}

/// Of a grid sample in this frame, Q30.
std::uint64_t PressureField::weight_of(const LatticeMesh& mesh, std::uint32_t triangle, int level,
                                       const Level& taken) {
  const std::uint32_t place = mesh.levels_of[triangle];
  if (place == 0 || taken.all()) return mesh.field_weight_q30[triangle];
  const SideLevels& side = mesh.side_levels[place - 1];
  const auto at = [&](std::uint32_t wanted) -> std::uint64_t {
    wanted = std::min(wanted, side.coarsest);
    if (level < static_cast<int>(wanted)) return 0;
    return wanted == 0
               ? mesh.field_weight_q30[triangle]
               : ((std::uint64_t{mesh.field_weight_q30[triangle]} * side.factor_q30[wanted - 1]) >> 30)
                     << wanted;
  };
  return ((256 - taken.between) * at(taken.whole) + taken.between * at(taken.whole + 1)) >> 8;
}

std::uint64_t PressureField::weight_of(const ExtraSample& extra, const Level& taken) {
  const auto at = [&](std::uint32_t level) -> std::uint64_t {
    level = std::min<std::uint32_t>(level, kSurfaceLevels);
    return level == 0 ? extra.weight_q30 : std::uint64_t{extra.coarse_q30[level - 1]} << level;
  };
  return ((256 - taken.between) * at(taken.whole) + taken.between * at(taken.whole + 1)) >> 8;
}

bool PressureField::is_ignored(std::uint32_t static_id, Lane& lane) const {
  if (ignored_ == nullptr || ignored_->patches.empty()) return false;
  const std::uint32_t patch = geometry_->mockup.patch[static_id];
  if (!std::binary_search(ignored_->patches.begin(), ignored_->patches.end(), patch)) return false;
  lane.touched.push_back(patch);
  return true;
}

/// What pushes.
void PressureField::add_push(const Push& push, Lane& lane) const {
  const std::uint32_t weight = push.counted;
  const Int3 &n = push.along, r = push.at;
  const auto p = static_cast<std::int64_t>((std::uint64_t{push.depth} * weight) >> 14);
  constexpr std::int32_t kLeast = 444764242;  // tan 22.5° in Q30
  std::size_t number = 0;
  for (int k = 2; k >= 0; --k)
    number = 3 * number + static_cast<std::size_t>(1 + (n[k] > kLeast ? 1 : 0) - (n[k] < -kLeast ? 1 : 0));
  FieldBin& bin = lane.field.bins[number];
  ++bin.samples;
  const exact::Normal turn = exact::cross(r, n);
  const std::int64_t turns[3] = {turn.x >> 30, turn.y >> 30, turn.z >> 30};
  for (std::size_t k = 0; k < 3; ++k) {
    add_term(bin.push[k], p * (n[static_cast<int>(k)] >> 10));
    add_term(bin.turn[k], product_q10(p, turns[k]));
  }
  const Int3& u = push.against;
  const std::int64_t steep = std::max<std::int64_t>(
      (std::int64_t{n.x} * u.x + std::int64_t{n.y} * u.y + std::int64_t{n.z} * u.z) >> 30, 0);
  const std::int64_t give = (std::int64_t{weight} * steep) >> 34;
  const std::int64_t x = r.x >> lever_shift_, y = r.y >> lever_shift_, z = r.z >> lever_shift_;
  bin.give += give;
  bin.give_at[0] += give * x;
  bin.give_at[1] += give * y;
  bin.give_at[2] += give * z;
  bin.give_spread[0] += (give * x * x) >> 8;
  bin.give_spread[1] += (give * y * y) >> 8;
  bin.give_spread[2] += (give * z * z) >> 8;
  bin.give_spread[3] += (give * x * y) >> 8;
  bin.give_spread[4] += (give * y * z) >> 8;
  bin.give_spread[5] += (give * z * x) >> 8;
}

void PressureField::add(const Push& push, std::uint32_t static_id, std::uint32_t mobile, CarrierSums* carrier,
                        Lane& lane) const {
  if (push.counted != 0) add_push(push, lane);
  add_deepest(lane.field, push.depth, static_id, mobile);
  if (push.sheet) lane.flags |= kFlagSheet;
  if (carrier == nullptr) return;
  const auto whole = static_cast<std::int64_t>((std::uint64_t{push.depth} * push.weight) >> 14);
  ++carrier->samples;
  carrier->max_depth = std::max(carrier->max_depth, push.depth);
  carrier->weight_sum += push.weight;
  carrier->depth_sum += whole;
  for (std::size_t k = 0; k < 3; ++k) {
    add_term(carrier->push[k], whole * (push.along[static_cast<int>(k)] >> 10));
    add_term(carrier->moment[k], product_q10(whole, push.at[static_cast<int>(k)]));
  }
}

void PressureField::push_from_mockup(const LatticePose& pose, std::uint32_t static_id, const Int3& point,
                                     std::uint64_t weight_q30, CarrierSums* carrier, Lane& lane) const {
  const Int3 in_tool = to_tool(pose, point);
  const DepthSearch::Depth below = lane.tool_depth.below(in_tool, lane.near_tool);
  lane.near_tool = below.place;
  if (below.triangle == DepthSearch::kNobody || is_ignored(static_id, lane)) return;
  const bool sheet = !has_inside_.mockup || is_sheet(geometry_->mockup, static_id);
  const Int3 against = -turned(pose, sheet ? lane.tool_depth.way_out(in_tool, below.triangle, below.steps)
                                           : geometry_->tool.unit_normal_q30[below.triangle]);
  const bool thin = is_thin(geometry_->mockup, static_id), in_thin = is_thin(geometry_->tool, below.triangle);
  const auto weight = static_cast<std::uint32_t>(weight_q30 >> 6);
  std::uint32_t pushing = counted(weight, sheet, thin, in_thin);
  if (!geometry_->tool.closed) pushing = in_tool_->sure(pushing, in_tool);
  add({point - pose.translation, sheet ? against : geometry_->mockup.unit_normal_q30[static_id], against,
       below.steps, weight, pushing, sheet},
      static_id, below.triangle, carrier, lane);
}

void PressureField::push_from_tool(const LatticePose& pose, std::uint32_t mobile, const Int3& point,
                                   std::uint64_t weight_q30, Lane& lane) const {
  const DepthSearch::Depth below = lane.mockup_depth.below(point, lane.near_mockup);
  lane.near_mockup = below.place;
  if (below.triangle == DepthSearch::kNobody || is_ignored(below.triangle, lane)) return;
  const bool sheet = !has_inside_.tool || is_sheet(geometry_->tool, mobile);
  const Int3 against = sheet ? lane.mockup_depth.way_out(point, below.triangle, below.steps)
                             : geometry_->mockup.unit_normal_q30[below.triangle];
  const bool thin = is_thin(geometry_->tool, mobile), in_thin = is_thin(geometry_->mockup, below.triangle);
  const auto weight = static_cast<std::uint32_t>(weight_q30 >> 6);
  std::uint32_t pushing = counted(weight, sheet, thin, in_thin);
  if (!geometry_->mockup.closed) pushing = lane.in_mockup.sure(pushing, point);
  add({point - pose.translation, sheet ? against : -turned(pose, geometry_->tool.unit_normal_q30[mobile]),
       against, below.steps, weight, pushing, sheet},
      below.triangle, mobile, nullptr, lane);
}

namespace {

/// `carriers` ascend by id.
CarrierSums* carrier_of(std::span<CarrierSums> carriers, std::uint32_t id) {
  const auto at = std::lower_bound(carriers.begin(), carriers.end(), id,
                                   [](const CarrierSums& a, std::uint32_t b) { return a.id < b; });
  return at != carriers.end() && at->id == id ? &*at : nullptr;
}

constexpr std::size_t kAtOnce = 64;  // samples whose levels are worked out together (chosen)
using AtOnce = std::array<std::int32_t, kAtOnce>;

/// Of samples, whose lattice coordinates along their grids' two axes are `u` and `v`, the last levels that
/// they are of.
void levels_at(std::int32_t spacing, const AtOnce& u, const AtOnce& v, AtOnce& levels) {
  // As SampleGrid::cell: half a step from the nearest integer quotient, which is far more than a double
  // rounds.
  const double per_step = 1.0 / spacing;
  const auto cell = [&](std::int32_t coordinate) {
    const double along = (coordinate + 0.5) * per_step;
    return static_cast<std::int32_t>(along) - (along < 0 ? 1 : 0);
  };
  on_this_processor([&] {
    for (std::size_t n = 0; n < kAtOnce; ++n) levels[n] = SampleGrid::level(cell(u[n]), cell(v[n]));
  });
}

}  // namespace

/// Of the mock-up's samples inside the tool.
void PressureField::sum_samples(const LatticePose& pose, std::span<const FrameSample> samples,
                                std::span<CarrierSums> carriers, Lane& lane) const {
  const LatticeMesh& mockup = geometry_->mockup;
  AtOnce u{}, v{}, levels{};  // levels: 0 where all samples count
  for (; !samples.empty(); samples = samples.subspan(std::min(kAtOnce, samples.size()))) {
    const std::span<const FrameSample> now = samples.first(std::min(kAtOnce, samples.size()));
    if (!mockup_level_.all()) {
      for (std::size_t n = 0; n < now.size(); ++n) {
        const int axis = mockup.sample_axis[now[n].static_id];
        u[n] = now[n].point[axis == 2 ? 0 : axis + 1];
        v[n] = now[n].point[axis == 0 ? 2 : axis - 1];
      }
      levels_at(geometry_->sample_spacing, u, v, levels);
    }
    for (std::size_t n = 0; n < now.size(); ++n) {
      const std::uint32_t id = now[n].static_id;
      if (const std::uint64_t weight = weight_of(mockup, id, levels[n], mockup_level_); weight != 0)
        push_from_mockup(pose, id, now[n].point, weight, carrier_of(carriers, id), lane);
    }
  }
}

/// Of the mock-up's extra samples that lie inside the tool.
void PressureField::sum_extras(const LatticePose& pose, ContactSets& sets,
                               std::span<const StaticResult> statics, std::span<CarrierSums> carriers,
                               int number) {
  Lane& lane = lanes_[static_cast<std::size_t>(number)];
  lane.asked.clear();
  lane.extras.clear();
  const std::array<Int3, 2> box = sets.reach(pose);
  for (const StaticResult& result : statics)
    mockup_extras_.for_each(result.id, mockup_level_.whole, [&](const ExtraSample& extra) {
      const Int3& p = extra.point;
      if (glm::any(glm::lessThan(p, box[0])) || glm::any(glm::greaterThan(p, box[1]))) return;
      const std::uint64_t weight = weight_of(extra, mockup_level_);
      if (weight == 0) return;
      lane.asked.push_back({extra.point, static_cast<std::uint32_t>(lane.extras.size())});
      lane.extras.push_back({result.id, weight});
    });
  for (const FrameSample& inside : sets.inside_of(pose, lane.asked, number)) {
    const AskedExtra& extra = lane.extras[inside.static_id];
    push_from_mockup(pose, extra.triangle, inside.point, extra.weight_q30,
                     carrier_of(carriers, extra.triangle), lane);
  }
}

/// Parts of C_m's samples, alike in size: one triangle may have thousands.
void PressureField::divide_tool(std::span<const MobileResult> mobiles) {
  const std::size_t size = std::max(kPart, own_samples_.size() / kMostOfABody);
  tool_parts_.clear();
  tool_counts_.clear();
  const std::uint32_t level = std::min<std::uint32_t>(tool_level_.whole, kSampleLevels);
  std::size_t room = 0;  // of the last part
  for (std::uint32_t i = 0; i < mobiles.size(); ++i) {
    const std::size_t count = tool_counts_.emplace_back(own_.empty() ? 0 : own_[mobiles[i].id].weigh[level]);
    for (std::size_t first = 0; first == 0 || first < count;) {
      if (room == 0) {
        tool_parts_.push_back({i, static_cast<std::uint32_t>(first)});
        room = size;
      }
      const std::size_t taken =
          std::clamp<std::size_t>(count - first, 1, room);  // 1: a triangle costs a look
      room -= taken;
      first += taken;
    }
  }
}

/// Of the samples of C_m inside the mock-up, those of a part.
void PressureField::sum_tool(const LatticePose& pose, std::span<const MobileResult> mobiles, std::size_t part,
                             Lane& lane) const {
  const LatticeMesh& own = geometry_->tool;
  const ToolPart begin = tool_parts_[part],
                 end = part + 1 < tool_parts_.size()
                           ? tool_parts_[part + 1]
                           : ToolPart{static_cast<std::uint32_t>(mobiles.size()), 0};
  for (std::uint32_t i = begin.mobile; i < end.mobile || (i == end.mobile && end.sample != 0); ++i) {
    const MobileResult& result = mobiles[i];
    // What touches nothing is on one side of a closed mock-up, with its first corner.
    const bool each = !geometry_->mockup.closed || (result.state & kMobileHit) != 0;
    std::optional<bool> inside;
    const auto push = [&](const Int3& p, std::uint64_t weight_q30) {
      if (weight_q30 == 0) return;
      const Int3 point = transform(pose, p);
      if (!each && !inside) inside = lane.in_mockup.inside(transform(pose, own.corner(result.id, 0)));
      if (each ? lane.in_mockup.inside(point) : *inside)
        push_from_tool(pose, result.id, point, weight_q30, lane);
    };
    int level = -1;  // of the sample before
    std::uint64_t weight = 0;
    const auto weighed = [&](const Int3& p, int of) {
      if (of != level) weight = weight_of(own, result.id, level = of, tool_level_);
      push(p, weight);
    };
    const std::uint32_t first = i == begin.mobile ? begin.sample : 0;
    if (own_.empty()) {
      if (own.field_weight_q30[result.id] != 0) work_out_tool_samples(result.id, weighed);
    } else {
      const std::uint32_t all = own_[result.id].begin, last = i == end.mobile ? end.sample : tool_counts_[i];
      for (std::uint32_t k = all + first; k < all + last; ++k) weighed(own_samples_[k], own_levels_[k]);
    }
    if (first == 0)
      tool_extras_.for_each(result.id, tool_level_.whole, [&](const ExtraSample& extra) {
        push(extra.point, weight_of(extra, tool_level_));
      });
  }
}

std::uint64_t PressureField::looks() const {
  std::uint64_t out = 0;
  for (const Lane& lane : lanes_) out += lane.mockup_depth.looks() + lane.tool_depth.looks();
  return out;
}

std::uint64_t PressureField::Extras::bytes() const {
  std::uint64_t sum = bytes_of(has_) + bytes_of(before_);
  for (const Level& level : levels_) sum += bytes_of(level.begin) + bytes_of(level.number);
  return sum;
}

std::uint64_t PressureField::bytes() const {
  std::uint64_t sum = mockup_extras_.bytes() + tool_extras_.bytes() + bytes_of(own_) +
                      bytes_of(own_samples_) + bytes_of(own_levels_) + bytes_of(tool_parts_) +
                      bytes_of(tool_counts_);
  for (const Lane& lane : lanes_)
    sum += lane.mockup_depth.bytes() + lane.tool_depth.bytes() + lane.in_mockup.bytes() +
           bytes_of(lane.carriers) + bytes_of(lane.touched) + bytes_of(lane.asked) + bytes_of(lane.extras);
  return sum;
}

void PressureField::sum(const LatticePose& pose, ContactSets& sets, const FoundSets& found,
                        const Wanted& wanted, FrameHelper* helper, Contacts& out) {
  choose_levels(found, wanted.ignored != nullptr ? wanted.ignored->coarser : 0);
  out.carriers.clear();
  ignored_ = wanted.ignored;
  for (Lane& lane : lanes_) {
    lane.field = {};
    lane.flags = 0;
    lane.touched.clear();
  }
  // C_s ascends; of it CST and EST carry.
  if (wanted.carriers)
    for (const StaticResult& result : found.statics)
      if ((result.state & (kStaticHit | kStaticSampled)) != 0) out.carriers.emplace_back().id = result.id;

  std::vector<CarrierSums>& of_helper = lanes_[1].carriers;
  of_helper.clear();
  if (helper != nullptr) of_helper = out.carriers;

  // Whole numbers are summed, so it is the same who sums which.
  const auto parts_of = [&](std::size_t count) {
    const std::size_t size = kPart << mockup_level_.whole;
    return std::min((count + size - 1) / size, kMostOfABody);
  };
  const std::span<const StaticResult> statics = has_inside_.tool && !mockup_extras_.empty()
                                                    ? std::span(found.statics)
                                                    : std::span<const StaticResult>();
  const std::size_t of_samples = parts_of(found.samples.size()), of_statics = parts_of(statics.size());
  divide_tool(found.mobiles);
  const auto piece = []<class T>(std::span<const T> all, std::size_t part, std::size_t parts) {
    const std::size_t first = all.size() * part / parts;
    return all.subspan(first, all.size() * (part + 1) / parts - first);
  };
  share_parts(helper, static_cast<std::uint32_t>(of_samples + of_statics + tool_parts_.size()),
              [&](std::uint32_t part, int number) {
                Lane& lane = lanes_[static_cast<std::size_t>(number)];
                const std::span<CarrierSums> carriers = number == 0 ? out.carriers : of_helper;
                if (part < of_samples)
                  sum_samples(pose, piece(std::span<const FrameSample>(found.samples), part, of_samples),
                              carriers, lane);
                else if (part < of_samples + of_statics)
                  sum_extras(pose, sets, piece(statics, part - of_samples, of_statics), carriers, number);
                else
                  sum_tool(pose, found.mobiles, part - of_samples - of_statics, lane);
              });

  const Lane &first = lanes_[0], &second = lanes_[1];
  static_assert(FrameHelper::kLanes == 2);
  out.field = first.field;
  for (std::size_t i = 0; i < kFieldBins; ++i) add_bin(out.field.bins[i], second.field.bins[i]);
  add_deepest(out.field, second.field.max_depth, second.field.deepest_static, second.field.deepest_mobile);
  for (std::size_t i = 0; i < of_helper.size(); ++i) out.carriers[i] += of_helper[i];
  out.flags |= first.flags | second.flags;
  out.ignored_touched = first.touched;
  std::vector<std::uint32_t>& touched = out.ignored_touched;
  touched.insert(touched.end(), second.touched.begin(), second.touched.end());
  std::sort(touched.begin(), touched.end());
  touched.erase(std::unique(touched.begin(), touched.end()), touched.end());
  if (std::none_of(out.field.bins.begin(), out.field.bins.end(),
                   [](const FieldBin& bin) { return bin.samples != 0; }))
    out.flags |= kFlagNoDirection;
}

}  // namespace palpate
