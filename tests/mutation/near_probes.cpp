#include "tests/mutation/near_probes.h"

#include "compute/host_exact.h"
#include "compute/host_heights.h"
#include "tests/compute/follow_cases.h"
#include "tests/compute/probe_cases.h"

namespace palpate::mutation {
namespace {

/// FNV-1a.
class Sum {
 public:
  void add(std::int64_t answer) {
    for (int byte = 0; byte < 8; ++byte) value_ = (value_ ^ static_cast<std::uint8_t>(answer >> (8 * byte))) * 0x100000001b3u;
  }
  void add(const Int3& p) {
    for (int k = 0; k < 3; ++k) add(p[k]);
  }
  std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = 0xcbf29ce484222325u;
};

template <class Three>
exact::Corners corners(const Three& t) {
  return {t[0], t[1], t[2]};
}

}  // namespace

std::uint64_t near_probe() {
  static const auto pairs = probe_cases::pairs();
  static const auto boxes = probe_cases::boxes();
  static const auto rays = probe_cases::rays();
  static const auto segments = probe_cases::segments();
  static const auto directions = probe_cases::directions();
  static const auto heights = probe_cases::heights();
  static const auto contacts = follow_cases::contacts();
  Sum sum;
  for (const auto& c : pairs) sum.add(exact::triangles_meet(corners(c.s), corners(c.t), exact::raw_normal(corners(c.t))));
  for (const auto& c : boxes) {
    const exact::Corners t{c.a, c.b, c.c};
    sum.add(exact::triangle_touches_cube(t, exact::box_of(t), c.lo, c.hi.x - c.lo.x));
  }
  for (const auto& c : rays) {
    const exact::Crossing crossing = exact::ray_crossing(c.point, c.direction, corners(c.corner));
    sum.add(crossing.sign);
    if (crossing.sign != 0) sum.add(crossing.height);
  }
  for (const auto& c : segments) {
    sum.add(exact::segment_crossing(c.point, c.direction, corners(c.corner)));
    Int3 at(0);
    const bool meets = exact::edge_crossing(c.point, c.direction, corners(c.corner), at);
    sum.add(meets);
    if (meets) sum.add(at);
  }
  for (const auto& c : directions)
    if (c.sum[0] != 0 || c.sum[1] != 0 || c.sum[2] != 0) sum.add(exact::normalise({c.sum[0], c.sum[1], c.sum[2]}));
  for (const auto& c : heights) {
    gpu::AreaWork area{};
    HostHeights::add(area, c.point, c.height, c.weight, c.fade);
    for (const std::int64_t value : {std::int64_t{area.rays}, std::int64_t{area.max_height}, area.height_sum, area.weight_sum, area.faded_sum, area.faded_rest,
                                     area.weight_slope, area.height_slope})
      sum.add(value);
    for (std::size_t k = 0; k < 3; ++k) {
      sum.add(area.moment_low[k]);
      sum.add(area.moment_high[k]);
    }
  }
  for (const auto& contact : contacts)
    for (const gpu::AreaPierce& p : follow_cases::pierces(*contact)) {
      sum.add(p.area);
      sum.add(p.pierced);
    }
  return sum.value();
}

}  // namespace palpate::mutation
