#include "model/response.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>

namespace palpate {
namespace {

constexpr double kQ30 = 1073741824.0;   // 2^30

double to_double(const WideSum& sum) { return static_cast<double>(sum.high) * 4294967296.0 + static_cast<double>(sum.low); }

Vec3 to_metres(const Lattice& lattice, const Vec3& steps) { return lattice.origin_m + lattice.step_m * steps; }

/// Σ H·w' / 2^30.
double faded_height(const ContactArea& area) { return static_cast<double>(area.faded_sum) + static_cast<double>(area.faded_rest) / 1048576.0; }

/// ∂d/∂h. With N = Σ H·w' and W = Σ w', (N/W)' = (N' − W' N/W) / W. `paper` fades nothing in, its sums say nothing about it: estimated from
/// ρ = d/h as ρ + 3 (ρ − ½)₊ (1 − ρ), exact for a flat contact (1) and a corner (⅓) and at most 1.3 % above for a cap up to half its radius deep.
double slope_of(const ContactArea& area, Profile profile) {
  const auto weight = static_cast<double>(area.weight_sum);
  const double mean = faded_height(area) / weight * kQ30;   // of H
  if (profile == Profile::kPaper) {
    const double ratio = area.max_height > 0 ? mean / static_cast<double>(area.max_height) : 1.0;
    return ratio + 3 * std::max(0.0, ratio - 0.5) * (1 - ratio);
  }
  return (static_cast<double>(area.height_slope) - mean * (static_cast<double>(area.weight_slope) / 1024.0)) / weight;
}

/// What an area was in the frame before.
enum class Before { kGaveForce, kUnknown, kSilent };

/// Of the held area with most static ids in common, at least one; tie: the earliest (EXACTNESS section 6).
Before before(const ContactArea& area, const Held* held) {
  if (held == nullptr) return Before::kUnknown;
  std::size_t most = 0;
  Before result = Before::kUnknown;
  for (const HeldArea& candidate : held->areas) {
    std::size_t common = 0;
    auto a = area.static_ids.begin();
    auto b = candidate.static_ids.begin();
    while (a != area.static_ids.end() && b != candidate.static_ids.end()) {
      if (*a == *b) ++common;
      const bool step_a = *a <= *b, step_b = *b <= *a;
      a += step_a ? 1 : 0;
      b += step_b ? 1 : 0;
    }
    if (common > most) {
      most = common;
      result = candidate.silent ? Before::kSilent : Before::kGaveForce;
    }
  }
  return result;
}

/// Lets one area of every pierced plate give force, with the smallest depth of its group (EXACTNESS section 7).
void silence_pierced(const Contacts& contacts, const Held* held, double stiffness, const Vec3& gc,
                     std::vector<AreaResponse>& areas) {
  std::vector<std::size_t> group(areas.size());
  std::iota(group.begin(), group.end(), std::size_t{0});
  const auto root = [&](std::size_t i) {
    while (group[i] != i) i = group[i] = group[group[i]];
    return i;
  };
  for (std::size_t a = 0; a < areas.size(); ++a)
    for (const std::uint32_t b : contacts.areas[a].pierces) group[root(a)] = root(b);

  std::vector<Before> was(areas.size());
  bool still_gives_force = false;   // an area that did before
  for (std::size_t a = 0; a < areas.size(); ++a) {
    was[a] = before(contacts.areas[a], held);
    still_gives_force = still_gives_force || (was[a] == Before::kGaveForce && areas[a].depth > 0);
  }

  // Areas come in the order of their ids, so `<` leaves a tie with the smallest id. Areas that gave no height
  // can't be chosen: their depth is unknown, not zero.
  constexpr std::size_t kNone = SIZE_MAX;
  std::vector<std::size_t> size(areas.size(), 0), chosen(areas.size(), kNone);
  std::vector<double> smallest(areas.size(), 0), slope(areas.size(), 1);
  for (std::size_t a = 0; a < areas.size(); ++a) {
    const std::size_t g = root(a);
    ++size[g];
    if (contacts.areas[a].rays == 0) continue;
    if (chosen[g] == kNone || areas[a].depth < smallest[g]) smallest[g] = areas[a].depth, slope[g] = areas[a].slope;
    if (chosen[g] == kNone || was[a] < was[chosen[g]] ||
        (was[a] == was[chosen[g]] && areas[a].depth < areas[chosen[g]].depth))
      chosen[g] = a;
  }
  for (std::size_t a = 0; a < areas.size(); ++a) {
    const std::size_t g = root(a);
    AreaResponse& area = areas[a];
    if (size[g] < 2) {
      area.silent = was[a] == Before::kSilent && !still_gives_force;
    } else {
      area.flags |= kFlagPierced;
      area.silent = a != chosen[g];
      if (!area.silent) {
        area.depth = smallest[g];
        area.slope = slope[g];
        area.force = stiffness * area.depth * area.normal;
        area.torque = glm::cross(area.point - gc, area.force);
      }
    }
    if (area.silent) area.force = area.torque = Vec3(0);
  }
}

}  // namespace

void respond(const Contacts& contacts, const LatticePose& pose, const SceneGeometry& geometry, Profile profile,
             double stiffness, ContactResponse& out, const Held* held) {
  const Lattice& lattice = geometry.lattice;
  // gc follows the lattice pose, not the pose asked for: the wrench belongs to what was judged.
  Vec3 gc_steps(0);
  const Vec3 gc_tool = (geometry.tool_gc_m - geometry.tool_centre_m) / lattice.step_m;
  for (int r = 0; r < 3; ++r)
    gc_steps[r] = (pose.rotation_q30[r][0] * gc_tool.x + pose.rotation_q30[r][1] * gc_tool.y +
                   pose.rotation_q30[r][2] * gc_tool.z) / kQ30 + pose.translation[r];
  out.gc = to_metres(lattice, gc_steps);
  out.wrench = {};
  out.flags = contacts.flags;
  out.contact = contacts.contact;
  out.contact_points = contacts.contact_points;
  out.areas.clear();
  if (contacts.truncated || !contacts.contact) return;

  for (const ContactArea& area : contacts.areas) {
    AreaResponse response;
    response.id = area.id;
    response.flags = area.flags;
    const Vec3 direction(area.direction);
    const double length = std::sqrt(direction.x * direction.x + direction.y * direction.y + direction.z * direction.z);
    if (length > 0) response.normal = direction / length;
    response.point = out.gc;
    if (area.rays > 0 && area.weight_sum > 0 && length > 0) {
      const double metres_per_height = length * lattice.step_m;
      response.depth = metres_per_height * (faded_height(area) / static_cast<double>(area.weight_sum));
      response.max_depth = metres_per_height * (static_cast<double>(area.max_height) / kQ30);
      response.slope = slope_of(area, profile);
      if (!contacts.contact_points) {
        // stays gc: no torque
      } else if (profile == Profile::kPaper) {
        if (area.voxel_count > 0)
          response.point = to_metres(lattice, Vec3(area.voxel_sum[0], area.voxel_sum[1], area.voxel_sum[2]) /
                                                  static_cast<double>(area.voxel_count));
      } else if (area.height_sum > 0) {
        response.point = to_metres(lattice, Vec3(to_double(area.moment[0]), to_double(area.moment[1]), to_double(area.moment[2])) /
                                                static_cast<double>(area.height_sum));
      }
      response.force = stiffness * response.depth * response.normal;   // eq. 3
      response.torque = glm::cross(response.point - out.gc, response.force);
    }
    out.areas.push_back(response);
  }
  silence_pierced(contacts, held, stiffness, out.gc, out.areas);

  if (contacts.flags & kFlagSwallowed && contacts.swallowed_height > 0) {
    AreaResponse response;
    response.id = 0xFFFFFFFFu;
    response.flags = contacts.flags;
    const Vec3 direction(contacts.swallowed_direction);
    const double length = std::sqrt(direction.x * direction.x + direction.y * direction.y + direction.z * direction.z);
    if (length > 0) {
      response.normal = direction / length;
      response.depth = length * lattice.step_m * (static_cast<double>(contacts.swallowed_height) / kQ30);
      response.max_depth = response.depth;
      response.point = out.gc;
      response.force = stiffness * response.depth * response.normal;
      out.areas.push_back(response);
    }
  }
  for (const AreaResponse& area : out.areas) {
    out.flags |= area.flags;
    out.wrench.force += area.force;
    out.wrench.torque += area.torque;
  }
}

void remember(const Contacts& contacts, const ContactResponse& response, Held& held) {
  if (contacts.truncated) return;   // nothing was learnt: keep what there was
  held.areas.clear();
  if (!contacts.contact) {
    held.last_direction = Int3(0);
    return;
  }
  double deepest = 0;
  Int3 last(0);
  for (std::size_t a = 0; a < contacts.areas.size(); ++a) {
    const ContactArea& area = contacts.areas[a];
    if (area.direction != Int3(0)) {
      held.areas.push_back({area.static_ids, area.direction, area.sheet_sign, response.areas[a].silent});
      if (!response.areas[a].silent && response.areas[a].depth > deepest) {
        deepest = response.areas[a].depth;
        last = area.direction;
      }
    }
  }
  if (contacts.flags & kFlagSwallowed) last = contacts.swallowed_direction;
  if (last != Int3(0)) held.last_direction = last;
}

}  // namespace palpate
