#include "compute/ray_packet.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <glm/common.hpp>

namespace palpate {
namespace {

constexpr std::size_t kMostSquares = 1 << 14;   // (chosen)
// A row of squares is this much higher than a square is wide, so that it holds rays for a vector (chosen).
constexpr double kHigher = 4;
// Triangles before the rays, a ray, up to which to test them all costs less than to walk from each ray (chosen).
constexpr std::size_t kTrianglesARay = 8;
// Rows of squares that triangles lie in, a ray, up to which the same holds: long triangles across the squares lie in many (chosen).
constexpr std::size_t kRowsARay = 16, kRunsKnown = 8;   // judged by so many runs
// Crossings a ray that are kept (chosen).
constexpr std::size_t kHitsARay = 16;

// A height from three sides beyond the bound b, all of one sign, S their sum; R and L as in ray_shadows.cpp. Two corners are within L of the third along
// z, and the mean of that is off by 5 L b / S and 10 ε L, L ≤ 2 R; its sum with the third's way from the ray, by 4 ε R more. Times 2^30 / |along| ≤ 4, a
// quotient and a product, of at most 2 R: below 20 L b / S + 120 ε R.
constexpr double kSideError = 24, kReachError = 0x1p-46;

}  // namespace

RayPacket::RayPacket(const LatticeMesh& tool, const RunTree& runs) : tool_(&tool), tree_(&runs), eight_{} {
  // No entry of a rotation is beyond 1; a vertex is rounded.
  for (const Int3& v : tool.vertices) tool_reach_ = std::max(tool_reach_, 1.0 + std::abs(v.x) + std::abs(v.y) + std::abs(v.z));
}

/// Into squares, about as many as rays.
void RayPacket::sort(std::span<const Int3> points, const Int3& origin) {
  const auto [u, v, w] = axes_;
  begins_.resize(points.size());
  std::array<double, 2> low, high;
  low.fill(INFINITY);
  high.fill(-INFINITY);
  Int3 first(INT32_MAX), last(INT32_MIN);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Int3 way = points[i] - origin;
    first = glm::min(first, way);
    last = glm::max(last, way);
    const auto d = std::bit_cast<std::array<std::int32_t, 3>>(way);
    const double x = d[u] - d[w] * view_.shear[0], y = d[v] - d[w] * view_.shear[1];
    low = {std::min(low[0], x), std::min(low[1], y)};
    high = {std::max(high[0], x), std::max(high[1], y)};
    begins_[i] = {x, y, d[w], 0};
  }
  view_.low = low;
  view_.high = high;
  const Int3 most = glm::max(-first, last);
  view_.least = -std::bit_cast<std::array<std::int32_t, 3>>(view_.towards < 0 ? last : -first)[w];
  view_.reach = std::max(tool_reach_, static_cast<double>(std::max({most.x, most.y, most.z})));

  std::array<double, 2> side{high[0] - low[0], high[1] - low[1]};
  for (columns_ = rows_ = 1; columns_ * rows_ < std::min(points.size(), kMostSquares);) {
    const std::size_t axis = kHigher * side[0] >= side[1] ? 0 : 1;
    if (!(side[axis] > 1)) break;   // a step
    side[axis] /= 2;
    (axis == 0 ? columns_ : rows_) *= 2;
  }
  view_.last = {static_cast<double>(columns_ - 1), static_cast<double>(rows_ - 1)};
  for (std::size_t axis = 0; axis < 2; ++axis) view_.per_step[axis] = 1 / std::max(side[axis], 1.0);

  // By square; while they are counted in, first_[s + 1] is where the next one of square s goes.
  first_.assign(columns_ * rows_ + 2, 0);
  for (Begin& ray : begins_) {
    ray.square = view_.square(0, ray.x) + static_cast<std::uint32_t>(columns_) * view_.square(1, ray.y);
    ++first_[ray.square + 2];
  }
  for (std::size_t i = 2; i < first_.size(); ++i) first_[i] += first_[i - 1];
  x_.resize(points.size() + kRayLanes);
  y_.resize(points.size() + kRayLanes);
  z_.resize(points.size());
  number_.resize(points.size());
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    const std::uint32_t to = first_[begins_[i].square + 1]++;
    x_[to] = begins_[i].x;
    y_[to] = begins_[i].y;
    z_[to] = begins_[i].z;
    number_[to] = i;
  }
}

bool RayPacket::holds_rays(const std::array<std::int32_t, 2>& first, const std::array<std::int32_t, 2>& last) const {
  for (std::int32_t row = first[1]; row <= last[1]; ++row) {
    const std::uint32_t* of_row = first_.data() + static_cast<std::size_t>(row) * columns_;
    if (of_row[first[0]] != of_row[last[0] + 1]) return true;
  }
  return false;
}

/// Runs of triangles before the rays. False: more than it pays to test.
bool RayPacket::find_runs(const LatticePose& pose) {
  // A vertex is rounded to lattice points: half a step an axis, at most one across the rays. In single precision: coordinates, entries, three products and
  // their sum, for a box's centre and its half, and the sum of these and the place: below 32 · 2^-24 of the reach.
  const double margin = 2 + view_.reach * 0x1p-18;
  constexpr double kAhead = 0x1p-10;   // units a step, so that they are whole numbers of 32 bits
  VoxelTurn turn;
  const auto set = [&](std::size_t r, double scale, double at, double end, const auto& entry) {
    for (std::size_t c = 0; c < 3; ++c) turn.rotation[r][c] = static_cast<float>(entry(c) * 0x1p-30 * scale);
    turn.below[r] = static_cast<float>((at - margin) * scale);
    turn.above[r] = static_cast<float>((at + margin) * scale);
    turn.end[r] = static_cast<float>(end);
  };
  const auto& along = pose.rotation_q30[axes_[2]];
  for (std::size_t r = 0; r < 2; ++r) {
    const auto& across = pose.rotation_q30[axes_[r]];
    set(r, view_.per_step[r], -view_.low[r], view_.last[r] + 1, [&](std::size_t c) { return across[c] - view_.shear[r] * along[c]; });
  }
  set(2, kAhead, -view_.least, 0x1p24, [&](std::size_t c) { return view_.towards * along[c]; });

  const std::size_t most = (begins_.size() * kTrianglesARay + kEight - 1) / kEight;
  runs_.clear();
  bool few = true;
  tree_->descend(
      turn,
      [&](const EightRanges& at) {
        unsigned out = 0;
        for (std::size_t i = 0; i < kEight; ++i)
          if (at.may[i] != 0 && holds_rays({at.first[0][i], at.first[1][i]}, {at.last[0][i], at.last[1][i]})) out |= 1u << i;
        return out;
      },
      [&](std::uint32_t run) {
        few = runs_.size() < most;
        if (few) runs_.push_back(run);
        return few;
      });
  return few;
}

/// Notes what a ray that may meet triangle `i` crosses there.
void RayPacket::note(std::uint32_t ray, std::size_t i, std::uint32_t id) {
  const EightShadows& t = eight_;
  const double x = x_[ray], y = y_[ray], bound = t.bound[i];
  double side[3];
  for (std::size_t e = 0; e < 3; ++e) side[e] = t.a[e][i] * x + t.b[e][i] * y + t.c[e][i];
  std::uint32_t& last = first_hit_[number_[ray]];
  Hit hit{id, 0, 0, last};
  if (std::min({side[0], side[1], side[2]}) > bound || std::max({side[0], side[1], side[2]}) < -bound) {
    const std::int32_t z0 = t.corner[2][i], z1 = t.corner[5][i], z2 = t.corner[8][i];
    const double each = 1 / (side[0] + side[1] + side[2]);
    const double way = (side[2] * (z1 - z0) + side[0] * (z2 - z0)) * each + (z0 - z_[ray]);   // across from edge 2 is corner 1
    const double height = way * height_a_step_, error = kSideError * t.length[i] * bound * std::abs(each) + kReachError * view_.reach;
    if (height < -error) return;   // behind
    const auto low = static_cast<std::int64_t>(height - error), high = static_cast<std::int64_t>(height + error);
    if (height > error && low == high) {
      hit.sign = (each > 0) == (view_.towards > 0) ? 1 : -1;
      hit.height = static_cast<std::uint32_t>(low);
    }
  }
  last = static_cast<std::uint32_t>(hits_.size());
  hits_.push_back(hit);
}

void RayPacket::test_run(PosedTool& tool, std::uint32_t run) {
  const auto moved = std::bit_cast<std::array<std::int32_t, 3>>(tool.pose().translation);
  const std::array<std::int32_t, 3> origin{moved[axes_[0]], moved[axes_[1]], moved[axes_[2]]};
  const auto ids = tree_->order().subspan(run * kEight, std::min(tree_->order().size() - run * kEight, kEight));
  for (std::size_t i = 0; i < ids.size(); ++i) {
    const auto corners = std::bit_cast<std::array<std::int32_t, 9>>(tool.corners(ids[i]));
    for (std::size_t k = 0; k < 3; ++k)
      for (std::size_t c = 0; c < 3; ++c) eight_.corner[3 * c + k][i] = corners[3 * c + axes_[k]] - origin[k];
  }
  see(view_, eight_);
  const RayRows rows{x_.data(), y_.data(), first_.data(), columns_};
  for (std::size_t i = 0; i < ids.size(); ++i) {
    if (eight_.may[i] == 0 || tool_->collapsed(ids[i])) continue;
    rows_tested_ += static_cast<std::size_t>(eight_.last[1][i] - eight_.first[1][i] + 1);
    const std::size_t count = rays_met(view_, rows, eight_, i, met_.data());
    for (std::size_t k = 0; k < count; ++k) note(met_[k], i, ids[i]);
  }
}

bool RayPacket::trace(PosedTool& tool, std::span<const Int3> points, const Int3& along) {
  const Int3 size = glm::abs(along);
  const std::size_t w = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  axes_ = {(w + 1) % 3, (w + 2) % 3, w};
  const std::array<double, 3> d{static_cast<double>(along.x), static_cast<double>(along.y), static_cast<double>(along.z)};
  view_.towards = d[w] < 0 ? -1 : 1;
  view_.shear = {d[axes_[0]] / d[w], d[axes_[1]] / d[w]};
  height_a_step_ = 0x1p30 / d[w];
  sort(points, tool.pose().translation);
  if (!find_runs(tool.pose())) return false;
  hits_.clear();
  first_hit_.assign(points.size(), kNoHit);
  met_.resize(points.size() + kRayLanes);
  rows_tested_ = 0;
  for (std::size_t i = 0; i < runs_.size(); ++i) {
    test_run(tool, runs_[i]);
    if (hits_.size() > kHitsARay * points.size()) return false;
    if ((i + 1) % kRunsKnown == 0 && rows_tested_ * runs_.size() > kRowsARay * points.size() * (i + 1)) return false;
  }
  return true;
}

}  // namespace palpate
