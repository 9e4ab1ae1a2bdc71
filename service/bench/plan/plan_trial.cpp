#include "service/bench/plan/plan_trial.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

#include "model/contact/response.h"
#include "service/bench/time/times.h"

namespace palpate {
namespace {

double median(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

bool any_contact(const PlanTrial& trial) {
  return std::any_of(trial.frames.begin(), trial.frames.end(),
                     [](const auto& frame) { return frame.contacts.contact; });
}

bool same_bits(double a, double b) {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}
bool same_bits(const Vec3& a, const Vec3& b) {
  return same_bits(a.x, b.x) && same_bits(a.y, b.y) && same_bits(a.z, b.z);
}

/// Names the first difference of two areas and their responses.
const char* difference(const ContactArea& a, const AreaResponse& ra, const ContactArea& b,
                       const AreaResponse& rb, bool points, bool lists) {
  if (a.id != b.id || ra.id != rb.id) return "id";
  if (a.static_ids != b.static_ids) return "static";
  if (lists && (a.zones != b.zones || a.mobile_ids != b.mobile_ids)) return "zones or mobile";
  if (a.flags != b.flags || ra.flags != rb.flags) return "flags";
  if (a.direction != b.direction || !same_bits(ra.normal, rb.normal)) return "n_c";
  if (a.rays != b.rays || a.max_height != b.max_height || a.height_sum != b.height_sum || a.field != b.field)
    return "sums";
  if (!same_bits(ra.depth, rb.depth) || !same_bits(ra.max_depth, rb.max_depth) ||
      !same_bits(ra.slope, rb.slope))
    return "d";
  if (!same_bits(ra.force, rb.force)) return "F";
  if (points && (!same_bits(ra.point, rb.point) || !same_bits(ra.torque, rb.torque))) return "cp or T";
  return nullptr;
}

}  // namespace

Result<void> try_plan(CollisionBackend& backend, const PlanQuestion& question, const Plan& plan,
                      std::uint64_t rounds, PlanTrial& trial) {
  if (auto done = backend.replan(plan); !done) return done;
  backend.time_stages(true);  // of every plan alike, whether somebody watches or not
  const bool first = trial.frames.empty();
  if (first) {
    trial.frames.resize(question.poses.size());
    trial.frame_us.assign(question.poses.size(), HUGE_VAL);
  }
  std::map<std::string, std::vector<double>> stages;
  Contacts contacts;
  ContactResponse response;
  for (std::uint64_t round = 0; round <= rounds; ++round) {
    for (std::size_t i = 0; i < question.poses.size(); ++i) {
      const Stopwatch watch(question.cpu_clock);
      const Result<LatticePose> pose = to_lattice(question.poses[i], *question.geometry);
      if (!pose) return pose.error();
      contacts = Contacts{};
      if (auto done = backend.query(*pose, nullptr, contacts); !done) return done;
      respond(contacts, *pose, *question.geometry, plan.profile, question.stiffness_n_per_m, response);
      const double us = watch.us();
      if (contacts.truncated)
        return Error{ErrorCode::kInternal,
                     std::string("a frame was truncated: ") + contacts.truncated_capacity};
      if (round == 0) {
        if (first) trial.frames[i] = {contacts, response};
        continue;
      }
      trial.frame_us[i] = std::min(trial.frame_us[i], us);
      for (const auto& time : contacts.times)
        if (contacts.contact || !any_contact(trial)) stages[time.stage].push_back(time.us);
    }
  }
  for (const auto& [stage, times] : stages) {
    const auto known = trial.stage_us.find(stage);
    trial.stage_us[stage] =
        known == trial.stage_us.end() ? median(times) : std::min(known->second, median(times));
  }
  trial.memory = backend.memory_by_stage();
  trial.memory_bytes = backend.memory_bytes();
  return {};
}

std::string difference(const PlanTrial& whole, const PlanTrial& lean) {
  for (std::size_t i = 0; i < whole.frames.size(); ++i) {
    const Contacts &a = whole.frames[i].contacts, &b = lean.frames[i].contacts;
    const ContactResponse &ra = whole.frames[i].response, &rb = lean.frames[i].response;
    const bool points = a.contact_points && b.contact_points, lists = a.lists && b.lists;
    // In `refined` areas are for people to look at: without lists there are none.
    const bool compared =
        lists || (a.carriers.empty() && b.carriers.empty() && a.areas.size() == b.areas.size());
    const char* what = nullptr;
    if (a.contact != b.contact || a.pairs != b.pairs || a.flags != b.flags || ra.flags != rb.flags)
      what = "contact, pairs or flags";
    else if (lists && (a.cst != b.cst || a.bst != b.bst || a.est != b.est || a.cmt != b.cmt ||
                       a.bmt != b.bmt || a.imt != b.imt))
      what = "sets";
    else if (a.field != b.field)
      what = "the field";
    else if (compared && (a.areas.size() != b.areas.size() || ra.areas.size() != rb.areas.size()))
      what = "areas";
    else if (!same_bits(ra.wrench.force, rb.wrench.force))
      what = "F";
    else if (points && !same_bits(ra.wrench.torque, rb.wrench.torque))
      what = "T";
    for (std::size_t k = 0; compared && what == nullptr && k < a.areas.size(); ++k)
      what = difference(a.areas[k], ra.areas[k], b.areas[k], rb.areas[k], points, lists);
    if (what != nullptr) return fmt::format("pose {}: {} of the two plans differ", i, what);
  }
  return {};
}

PlanRatio time_ratio(const PlanTrial& whole, const PlanTrial& lean) {
  std::vector<double> ratios;
  for (std::size_t i = 0; i < whole.frames.size(); ++i)
    if ((whole.frames[i].contacts.contact || !any_contact(whole)) && whole.frame_us[i] > 0)
      ratios.push_back(lean.frame_us[i] / whole.frame_us[i]);
  if (ratios.empty()) return {};
  std::sort(ratios.begin(), ratios.end());
  const auto n = static_cast<double>(ratios.size());
  const double reach = 1.96 * std::sqrt(n) / 2;  // of the binomial that says how many lie below the median
  const auto at = [&](double rank) { return ratios[static_cast<std::size_t>(std::clamp(rank, 0.0, n - 1))]; };
  return {at(n / 2), at(std::floor(n / 2 - reach)), at(std::ceil(n / 2 + reach))};
}

double median_frame_us(const PlanTrial& trial) {
  std::vector<double> times;
  for (std::size_t i = 0; i < trial.frames.size(); ++i)
    if (trial.frames[i].contacts.contact || !any_contact(trial)) times.push_back(trial.frame_us[i]);
  return median(std::move(times));
}

}  // namespace palpate
