#include "bench/haptic/metrics.h"

#include <algorithm>
#include <cmath>

namespace yardstick {
namespace {

constexpr double kDegrees = 180 / 3.14159265358979323846;

double angle_deg(const Vec3& a, const Vec3& b) {
  if (glm::length(a) == 0) return 90;
  return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)) * kDegrees;
}

void put(const std::vector<double>& errors, std::optional<double>& p50, std::optional<double>& p95) {
  if (errors.empty()) return;
  p50 = quantile(errors, 0.5);
  p95 = quantile(errors, 0.95);
}

void judge_truths(const Case& subject, const std::vector<Sample>& path, Figures& out) {
  double largest = 0;
  for (const Truth& truth : subject.truths) largest = std::max(largest, truth.scale);
  std::vector<double> direction, magnitude, torque;
  for (std::size_t i = 0; i < subject.truths.size(); ++i) {
    const Truth& truth = subject.truths[i];
    const Wrench& felt = path[i].answer.wrench;
    if (truth.scale <= 0 || truth.scale < largest / 10) continue;
    if (truth.way) direction.push_back(angle_deg(felt.force, *truth.way));
    if (truth.force) {
      const double right = glm::length(*truth.force);
      if (right > 0) direction.push_back(angle_deg(felt.force, *truth.force));
      magnitude.push_back(std::abs(glm::length(felt.force) - right) / truth.scale);
    }
    if (truth.torque)
      torque.push_back(glm::length(felt.torque - *truth.torque) / (subject.gyration * truth.scale));
  }
  put(direction, out.direction_p50_deg, out.direction_p95_deg);
  put(magnitude, out.magnitude_p50, out.magnitude_p95);
  put(torque, out.torque_p50, out.torque_p95);
}

double largest_step(const Case& subject, const std::vector<Sample>& path) {
  const double farthest = reach(subject.tool);
  double out = 0;
  for (std::size_t i = 1; i < path.size(); ++i) {
    const Pose &a = path[i - 1].hand, &b = path[i].hand;
    const double way =
        glm::length(b.position - a.position) + farthest * glm::length(turn_between(a.rotation, b.rotation));
    const double change = glm::length(path[i].answer.wrench.force - path[i - 1].answer.wrench.force);
    if (way > 0) out = std::max(out, change / (subject.stiffness * way));
  }
  return out;
}

double noise_at_rest(const Case& subject, const Measured& measured) {
  Vec3 mean(0);
  for (const Sample& s : measured.rest) mean += s.answer.wrench.force;
  mean /= static_cast<double>(measured.rest.size());
  double squares = 0;
  for (const Sample& s : measured.rest) {
    const Vec3 off = s.answer.wrench.force - mean;
    squares += glm::dot(off, off);
  }
  return std::sqrt(squares / static_cast<double>(measured.rest.size())) /
         (subject.stiffness * measured.tremble_m * std::sqrt(3.0));
}

double work_lost(const std::vector<Sample>& loop) {
  double sum = 0, all = 0;
  for (std::size_t i = 1; i < loop.size(); ++i) {
    const Sample &a = loop[i - 1], &b = loop[i];
    const Vec3 force = (a.answer.wrench.force + b.answer.wrench.force) / 2.0,
               torque = (a.answer.wrench.torque + b.answer.wrench.torque) / 2.0;
    const double work = glm::dot(force, b.hand.position - a.hand.position) +
                        glm::dot(torque, turn_between(a.hand.rotation, b.hand.rotation));
    sum += work;
    all += std::abs(work);
  }
  return all > 0 ? std::abs(sum) / all : 0;
}

}  // namespace

double quantile(std::vector<double> values, double q) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  const double place = q * static_cast<double>(values.size() - 1);
  const auto below = static_cast<std::size_t>(place);
  const std::size_t above = std::min(below + 1, values.size() - 1);
  return values[below] + (place - static_cast<double>(below)) * (values[above] - values[below]);
}

Figures figures_of(const Case& subject, const Measured& measured) {
  Figures out;
  judge_truths(subject, measured.path, out);
  out.step = largest_step(subject, measured.path);
  if (!measured.rest.empty()) out.noise = noise_at_rest(subject, measured);
  out.loop_lost = work_lost(measured.loop);
  std::vector<double> times, each;
  std::size_t unsettled = 0;
  for (const Sample& s : measured.path) {
    times.push_back(measured.cpu_clock ? s.cpu_us : s.wall_us);
    each.push_back(times.back() / std::max(1u, s.answer.evaluations));
    unsettled += s.answer.settled ? 0 : 1;
  }
  out.frame_p50_us = quantile(times, 0.5);
  out.frame_p99_us = quantile(times, 0.99);
  out.evaluation_p50_us = quantile(each, 0.5);
  if (!measured.path.empty())
    out.unsettled = static_cast<double>(unsettled) / static_cast<double>(measured.path.size());
  return out;
}

}  // namespace yardstick
