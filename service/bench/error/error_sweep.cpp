#include "service/bench/error/error_sweep.h"

#include <algorithm>
#include <cmath>

#include "model/contact/response.h"
#include "service/bench/error/cut_mesh.h"
#include "service/bench/time/times.h"

namespace palpate {
namespace {

std::optional<ContactTruth> summary_of(const ContactResponse& response) {
  const AreaResponse* deepest = nullptr;
  for (const AreaResponse& area : response.areas)
    if (area.depth > 0 && (deepest == nullptr || area.depth > deepest->depth)) deepest = &area;
  if (deepest == nullptr) return std::nullopt;
  return ContactTruth{deepest->normal, deepest->depth, deepest->point, response.wrench};
}

double angle_deg(const Vec3& a, const Vec3& b) {
  return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)) * 57.29577951308232;
}

}  // namespace

Result<Answered> answer_all(const ErrorSubject& subject, const ErrorSetting& setting, std::uint64_t rounds,
                            CollisionBackend& backend, const Progress& progress, bool cpu_clock) {
  Mesh finer;
  const Mesh* mockup = &subject.meshes.mockup;
  if (setting.triangles > mockup->triangles.size()) {
    finer = cut_to(*mockup, setting.triangles);
    mockup = &finer;
  }
  const Result<SceneGeometry> geometry = build_geometry(*mockup, subject.meshes.tool, setting.geometry);
  if (!geometry) return Error{geometry.error().code, subject.name + ": " + geometry.error().sentence};
  Plan plan;
  plan.profile = setting.profile;
  plan.est = setting.profile == Profile::kRefined;
  if (auto done = backend.prepare(*geometry, plan, progress); !done)
    return Error{done.error().code, subject.name + ": " + done.error().sentence};

  Answered out;
  out.answers.resize(subject.poses.size());
  out.times_us.assign(subject.poses.size(), HUGE_VAL);
  out.all_us.resize(subject.poses.size());
  std::vector<DeviceWork> work;
  Contacts contacts;
  ContactResponse response;
  for (std::uint64_t round = 0; round <= rounds; ++round)  // the first warms up
    for (std::size_t i = 0; i < subject.poses.size(); ++i) {
      const DeviceWork before = backend.device_work();
      const Stopwatch watch(cpu_clock);
      const Result<LatticePose> pose = to_lattice(subject.poses[i], *geometry);
      if (!pose) return Error{pose.error().code, subject.name + ": " + pose.error().sentence};
      if (auto done = backend.query(*pose, nullptr, contacts); !done) return done.error();
      respond(contacts, *pose, *geometry, setting.profile, subject.stiffness_n_per_m, response);
      const double us = watch.us();
      if (contacts.truncated)
        return Error{ErrorCode::kInternal,
                     subject.name + ": a frame was truncated: " + contacts.truncated_capacity};
      if (round > 0) {
        out.times_us[i] = std::min(out.times_us[i], us);
        out.all_us[i].push_back(us);
        work.push_back(since(before, backend.device_work()));
      }
      if (round == 0) {
        out.answers[i] = summary_of(response);
        for (const ContactArea& area : contacts.areas)
          out.samples += setting.profile == Profile::kPaper ? area.rays : area.field.samples;
      }
      if (i % 16 == 0 &&
          !progress("poses", static_cast<double>(i) / static_cast<double>(subject.poses.size())))
        return Error{ErrorCode::kInternal, "interrupted"};
    }
  out.work = median_of(std::move(work));
  return out;
}

ErrorResult judge(const Answered& answered, const std::vector<std::optional<ContactTruth>>& truths) {
  ErrorResult out;
  for (std::size_t i = 0; i < truths.size(); ++i) {
    if (!truths[i]) continue;
    out.times_us.push_back(answered.times_us[i]);
    const ContactTruth nothing, &truth = *truths[i],
                                &answer = answered.answers[i] ? *answered.answers[i] : nothing;
    out.errors[0].push_back(std::fabs(answer.depth - truth.depth));
    out.errors[3].push_back(glm::length(answer.wrench.force - truth.wrench.force));
    out.errors[4].push_back(glm::length(answer.wrench.torque - truth.wrench.torque));
    if (!answered.answers[i]) {
      ++out.lost;
      continue;
    }
    out.errors[1].push_back(angle_deg(answer.normal, truth.normal));
    out.errors[2].push_back(glm::length(answer.point - truth.point));
  }
  out.samples = answered.samples;
  out.work = answered.work;
  return out;
}

double percentile(std::vector<double> values, double fraction) {
  if (values.empty()) return 0;
  const auto rank = static_cast<std::size_t>(std::ceil(fraction * static_cast<double>(values.size())));
  const auto place = values.begin() + static_cast<std::ptrdiff_t>(rank > 0 ? rank - 1 : 0);
  std::nth_element(values.begin(), place, values.end());
  return *place;
}

}  // namespace palpate
