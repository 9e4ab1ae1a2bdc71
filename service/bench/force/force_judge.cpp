#include "service/bench/force/force_judge.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "model/lattice/rotation.h"
#include "model/scene/geometry_build.h"
#include "service/queries/lone_query.h"

namespace palpate {
namespace {

constexpr double kDegrees = 180 / 3.14159265358979323846;

struct Answer {
  Wrench wrench;
  std::uint32_t flags = 0;
  bool contact = false;
};

/// Asks what is felt at poses.
class Asking {
 public:
  Asking(const SceneGeometry& geometry, CollisionBackend& backend, Profile profile, double stiffness)
      : geometry_(geometry),
        backend_(backend),
        profile_(profile),
        stiffness_(stiffness),
        lone_(geometry, stiffness) {}

  /// From here on what touches at the next pose is left out, patch by patch, until it has opened once.
  void ignore_start() {
    ignored_.patches.resize(geometry_.mockup.patch_count);
    std::iota(ignored_.patches.begin(), ignored_.patches.end(), 0u);
  }

  /// `going_on`: from the balance of the pose before.
  Result<Answer> at(const Pose& pose, bool going_on = false) {
    const Result<LatticePose> rounded = to_lattice(pose, geometry_);
    if (!rounded) return rounded.error();
    if (auto done = backend_.query(*rounded, profile_ == Profile::kRefined ? &ignored_ : nullptr, contacts_);
        !done)
      return done.error();
    if (!contacts_.truncated) ignored_.patches = contacts_.ignored_touched;
    respond(contacts_, *rounded, geometry_, profile_, stiffness_, response_);
    Answer out{response_.wrench, response_.flags, response_.contact};
    if (profile_ == Profile::kRefined) {
      if (auto done = lone_.feel(backend_, &ignored_, pose, response_, going_on); !done) return done.error();
      if (response_.felt) out.wrench = response_.felt->wrench;
      out.flags = response_.flags;
    }
    return out;
  }

 private:
  const SceneGeometry& geometry_;
  CollisionBackend& backend_;
  Profile profile_;
  double stiffness_;
  LoneQuery lone_;
  Ignored ignored_;
  Contacts contacts_;
  ContactResponse response_;
};

double angle(const Vec3& a, const Vec3& b) {
  return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)) * kDegrees;
}

/// Turn from one rotation to the other, rad.
Vec3 turn_between(const Quat& from, const Quat& to) {
  Quat by = to * glm::conjugate(from);
  if (by.w < 0) by = -by;
  const Vec3 v(by.x, by.y, by.z);
  const double sine = glm::length(v);
  return sine > 0 ? v * (2 * std::atan2(sine, by.w) / sine) : 2.0 * v;
}

/// |A − Aᵀ| / |A + Aᵀ| by central differences; poses turn about the centre of mass. Small turns about two
/// axes don't commute, so of a conservative torque, too, ∂T_i/∂θ_j − ∂T_j/∂θ_i is not 0 but ε_ijk T_k, which
/// is left out.
Result<double> antisymmetry(Asking& asking, const SceneGeometry& geometry, const Pose& pose) {
  const double step = 20e-6, rho = geometry.tool_gyration_m;  // about what the hand moves in a tick
  const Vec3 gc = geometry.tool_gc_m;
  std::array<std::array<double, 6>, 6> a{};
  for (std::size_t j = 0; j < 6; ++j) {
    std::array<Wrench, 2> ends;
    for (std::size_t side = 0; side < 2; ++side) {
      const double way = side == 0 ? -step : step;
      Pose moved = pose;
      Vec3 by(0);
      by[static_cast<int>(j % 3)] = j < 3 ? way : way / rho;
      if (j < 3) {
        moved.position += by;
      } else {
        moved.rotation = rotation_by(by) * pose.rotation;
        moved.position = pose.position + pose.rotation * gc - moved.rotation * gc;
      }
      const Result<Answer> answer = asking.at(moved);
      if (!answer) return answer.error();
      ends[side] = answer->wrench;
    }
    for (std::size_t i = 0; i < 3; ++i) {
      a[i][j] = (ends[1].force[static_cast<int>(i)] - ends[0].force[static_cast<int>(i)]) / (2 * step);
      a[i + 3][j] =
          (ends[1].torque[static_cast<int>(i)] - ends[0].torque[static_cast<int>(i)]) / (2 * step * rho);
    }
  }
  const Result<Answer> here = asking.at(pose);
  if (!here) return here.error();
  const Vec3 torque = here->wrench.torque / (rho * rho);
  for (std::size_t k = 0; k < 3; ++k) a[3 + (k + 1) % 3][3 + (k + 2) % 3] -= torque[static_cast<int>(k)];
  double odd = 0, even = 0;
  for (std::size_t i = 0; i < 6; ++i)
    for (std::size_t j = 0; j < 6; ++j) {
      odd += (a[i][j] - a[j][i]) * (a[i][j] - a[j][i]);
      even += (a[i][j] + a[j][i]) * (a[i][j] + a[j][i]);
    }
  return even > 0 ? std::sqrt(odd / even) : 0;
}

/// Which pose is asked for ∂F: that of the largest force. Where the tool slips, that is the brink: a little
/// further it lets go, and differences are of the step alone (a plate of 0.4 mm: 100, 34, 0.3 and 1 % for
/// steps of 5, 20, 80 and 320 µm). There it is the largest force up to half as much, on the way to it.
std::size_t pose_of_slope(const ForceCase& subject, const std::vector<double>& force) {
  const auto largest = static_cast<std::size_t>(std::max_element(force.begin(), force.end()) - force.begin());
  if (!subject.slips) return largest;
  std::size_t out = 0;
  for (std::size_t i = 0; i < largest; ++i)
    if (force[i] <= 0.5 * force[largest] && force[i] > force[out]) out = i;
  return out;
}

/// From a pose to the next.
struct Step {
  Vec3 way, turn;  ///< of the centre of mass; rad
  double size;     ///< m, the turn at the tool's radius of gyration
};

Step step_between(const SceneGeometry& geometry, const Pose& p, const Pose& q) {
  const Vec3 turn = turn_between(p.rotation, q.rotation);
  const Vec3 way =
      (q.position + q.rotation * geometry.tool_gc_m) - (p.position + p.rotation * geometry.tool_gc_m);
  return {way, turn, glm::length(way) + geometry.tool_gyration_m * glm::length(turn)};
}

bool may_go_on(const PathProgress& go_on, std::size_t done, std::size_t all) {
  return !go_on || go_on(static_cast<double>(done) / static_cast<double>(all));
}
Error interrupted_error() { return {ErrorCode::kInternal, "interrupted"}; }

void judge_truths(const ForceCase& subject, const std::vector<Answer>& answers, ForceFigures& out) {
  for (const ForceCase::Truth& truth : subject.truths) {
    const Wrench& wrench = answers[truth.at].wrench;
    const double force = glm::length(wrench.force);
    if (truth.direction) {
      const double off = angle(wrench.force, *truth.direction);
      if (force == 0 || off > truth.direction_deg)
        out.broken.push_back(fmt::format("pose {}: {:.3g} N, {:.1f}° from the way it must push ({}°)",
                                         truth.at, force, off, truth.direction_deg));
    }
    if (truth.most_force && force > *truth.most_force)
      out.broken.push_back(fmt::format("pose {}: {:.3g} N where there is no net force ({:.3g})", truth.at,
                                       force, *truth.most_force));
    if (truth.couple_against && !(glm::dot(wrench.torque, *truth.couple_against) < 0))
      out.broken.push_back(fmt::format("pose {}: the couple does not right it", truth.at));
  }
}

}  // namespace

std::vector<Pose> finer_path(const std::vector<Pose>& path, std::size_t count) {
  std::vector<Pose> out;
  for (std::size_t i = 0; i < count; ++i) {
    const double place = static_cast<double>(i) * static_cast<double>(path.size() - 1) /
                         static_cast<double>(std::max<std::size_t>(count - 1, 1));
    const std::size_t first = std::min(static_cast<std::size_t>(place), path.size() - 1),
                      second = std::min(first + 1, path.size() - 1);
    const double part = place - static_cast<double>(first);
    const Pose &a = path[first], &b = path[second];
    out.push_back({a.position + part * (b.position - a.position),
                   rotation_by(part * turn_between(a.rotation, b.rotation)) * a.rotation});
  }
  return out;
}

Result<ForceFigures> judge_path(const ForceCase& subject, const SceneGeometry& geometry,
                                CollisionBackend& backend, Profile profile, double stiffness,
                                const PathProgress& go_on) {
  Asking asking(geometry, backend, profile, stiffness);
  ForceFigures out;
  out.poses = subject.path.size();
  std::vector<Answer> answers;
  for (const Pose& pose : subject.path) {
    if (!may_go_on(go_on, answers.size(), subject.path.size())) return interrupted_error();
    Result<Answer> answer = asking.at(pose);
    if (!answer) return answer.error();
    answers.push_back(*answer);
    const double force = glm::length(answer->wrench.force);
    out.force_n.push_back(force);
    if (answer->contact) ++out.touching;
    if (answer->contact && (answer->flags & kFlagNoDirection) != 0) ++out.made_up;
    if ((answer->flags & kFlagUnsettled) != 0) ++out.unsettled;
    out.largest_n = std::max(out.largest_n, force);
  }
  double work = 0, moved_work = 0, deepest = 0;
  bool touched = false;
  for (std::size_t i = 0; i < answers.size(); ++i) {
    const Wrench& here = answers[i].wrench;
    if (subject.approach && !touched && out.force_n[i] > 1e-6) {
      touched = true;
      out.first_along = glm::dot(here.force, *subject.approach) / out.force_n[i];
    }
    if (subject.approach) {
      deepest = std::max(deepest, out.force_n[i]);
      if (deepest > 0)
        out.largest_loss =
            std::max(out.largest_loss, (deepest - out.force_n[i]) / std::max(deepest, 0.01 * out.largest_n));
    }
    if (i == 0) continue;
    const Wrench& before = answers[i - 1].wrench;
    const auto [way, turn, size] = step_between(geometry, subject.path[i - 1], subject.path[i]);
    if (size > 0 && glm::length(here.force - before.force) / (stiffness * size) > out.largest_step) {
      out.largest_step = glm::length(here.force - before.force) / (stiffness * size);
      out.largest_step_at = i;
    }
    const double floor = 0.01 * out.largest_n;
    if (out.force_n[i] > floor && out.force_n[i - 1] > floor && glm::dot(here.force, before.force) < 0)
      ++out.reversals;
    const double part =
        0.5 * (glm::dot(here.force + before.force, way) + glm::dot(here.torque + before.torque, turn));
    work += part;
    moved_work += std::fabs(part);
  }
  if (subject.loop && moved_work > 0) out.loop_share = std::fabs(work) / moved_work;
  if (out.largest_n > 0) {
    const Result<double> odd =
        antisymmetry(asking, geometry, subject.path[pose_of_slope(subject, out.force_n)]);
    if (!odd) return odd.error();
    out.antisymmetry = *odd;
  }
  if (out.touching == 0) out.broken.emplace_back("nothing touches");
  judge_truths(subject, answers, out);
  if (!subject.slips && out.largest_step > kMostStep)
    out.broken.push_back(
        fmt::format("a step of {:.3g} K Δx at pose {}", out.largest_step, out.largest_step_at));
  if (!subject.slips && out.loop_share > kMostLoop)
    out.broken.push_back(fmt::format("{:.1f} % of the work is lost round the loop", 100 * out.loop_share));
  if (out.antisymmetry > subject.most_antisymmetry)
    out.broken.push_back(fmt::format("∂F is {:.1f} % antisymmetric", 100 * out.antisymmetry));
  if (out.first_along > 0) out.broken.emplace_back("pulled in at first touch");
  if (out.largest_loss > kMostLoss)
    out.broken.push_back(fmt::format("{:.1f} % less while going deeper", 100 * out.largest_loss));
  return out;
}

Result<void> judge_hand(const ForceCase& subject, const SceneGeometry& geometry, CollisionBackend& backend,
                        double stiffness, StartContacts start, ForceFigures& out, const PathProgress& go_on) {
  Asking asking(geometry, backend, Profile::kRefined, stiffness);
  if (start == StartContacts::kIgnoreInitial) asking.ignore_start();
  out.hand_step = 0;
  out.hand_reversals = 0;
  const double floor = 0.01 * out.largest_n;
  Vec3 before(0);
  for (std::size_t i = 0; i < subject.path.size(); ++i) {
    if (!may_go_on(go_on, i, subject.path.size())) return interrupted_error();
    const Result<Answer> answer = asking.at(subject.path[i], true);
    if (!answer) return answer.error();
    const Vec3 here = answer->wrench.force;
    if (i > 0) {
      const double size = step_between(geometry, subject.path[i - 1], subject.path[i]).size;
      if (size > 0) out.hand_step = std::max(*out.hand_step, glm::length(here - before) / (stiffness * size));
      if (glm::length(here) > floor && glm::length(before) > floor && glm::dot(here, before) < 0)
        ++out.hand_reversals;
    }
    before = here;
  }
  return {};
}

Result<ForceFigures> judge_force(const ForceCase& subject, CollisionBackend& backend, Profile profile,
                                 double voxel_scale) {
  GeometrySettings settings;
  if (subject.voxel_m > 0) settings.voxel_size_m = subject.voxel_m * voxel_scale;
  Result<SceneGeometry> geometry = build_geometry(subject.mockup, subject.tool, settings);
  if (!geometry) return geometry.error();
  if (subject.voxel_m == 0 && voxel_scale != 1) {
    settings.voxel_size_m = voxel_scale * geometry->mockup_grid.size * geometry->lattice.step_m;
    geometry = build_geometry(subject.mockup, subject.tool, settings);
    if (!geometry) return geometry.error();
  }
  Plan plan;
  plan.profile = profile;
  if (auto done = backend.prepare(*geometry, plan, {}); !done) return done.error();
  return judge_path(subject, *geometry, backend, profile, kForceStiffness);
}

}  // namespace palpate
