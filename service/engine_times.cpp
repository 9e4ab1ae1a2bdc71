#include "service/engine_times.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "model/contact/response.h"
#include "model/files/path_file.h"

namespace palpate {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kRounds = 3;  // chosen: tells a few per cent, in milliseconds

std::vector<Pose> poses_near_start(const Scene& scene) {
  constexpr std::size_t kNear = 8, kSecond = 1000;  // chosen: poses of the path's first second
  std::vector<Pose> out{scene.start};
  const std::size_t ticks = std::min(kSecond, scene.device.path.size());
  for (std::size_t i = 1; i < kNear && ticks > kNear; ++i)
    out.push_back(path_pose(scene.device.path[i * ticks / kNear], scene.device.guide));
  return out;
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

Result<EngineTime> time_engine(const LoadedScene& scene, CollisionBackend& backend) {
  const ResponseSettings& settings = scene.scene.response;
  Contacts contacts;
  ContactResponse response;
  std::vector<double> in_contact, all;
  for (const Pose& pose : poses_near_start(scene.scene)) {
    double least = HUGE_VAL;
    for (int round = 0; round <= kRounds; ++round) {  // the first one warms up
      const auto start = Clock::now();
      const Result<LatticePose> lattice = to_lattice(pose, scene.geometry);
      if (!lattice) return lattice.error();
      if (auto done = backend.query(*lattice, nullptr, contacts); !done) return done.error();
      respond(contacts, *lattice, scene.geometry, settings.profile, settings.stiffness_n_per_m, response);
      const double us = std::chrono::duration<double, std::micro>(Clock::now() - start).count();
      if (round > 0) least = std::min(least, us);
    }
    all.push_back(least);
    if (contacts.contact) in_contact.push_back(least);
  }
  return EngineTime{backend.name(), backend.device(), median(in_contact.empty() ? all : in_contact), {}};
}

std::string engines_text(const std::vector<EngineTime>& engines) {
  std::string out;
  const EngineTime* quickest = nullptr;
  const EngineTime* slower = nullptr;
  for (const EngineTime& e : engines) {
    out += (out.empty() ? "" : "; ") + e.engine +
           (e.missing.empty() ? fmt::format(" {:.0f} µs on {}", e.frame_us, e.device)
                              : " not measured: " + e.missing);
    if (!e.missing.empty()) continue;
    slower = quickest;
    quickest = &e;
    if (slower != nullptr && slower->frame_us < quickest->frame_us) std::swap(slower, quickest);
  }
  if (slower != nullptr)
    out += fmt::format("; {} is the quicker by a factor of {:.3g}", quickest->engine,
                       slower->frame_us / quickest->frame_us);
  return out;
}

}  // namespace palpate
