#include "bench/haptic/measure.h"

#include <malloc.h>
#include <unistd.h>

#include <cmath>
#include <ctime>
#include <fstream>
#include <random>

namespace yardstick {
namespace {

constexpr double kTremble = 1e-6;

double seconds(clockid_t clock) {
  timespec time{};
  clock_gettime(clock, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

double resident_mib() {
  malloc_trim(0);
  std::ifstream in("/proc/self/statm");
  double size = 0, resident = 0;
  in >> size >> resident;
  return resident * static_cast<double>(sysconf(_SC_PAGESIZE)) / (1 << 20);
}

std::vector<Sample> ask(Adapter& adapter, const std::vector<Pose>& poses) {
  std::vector<Sample> out;
  for (const Pose& pose : poses) {
    const double wall = seconds(CLOCK_MONOTONIC), cpu = seconds(CLOCK_PROCESS_CPUTIME_ID);
    const Answer answer = adapter.answer(pose);
    out.push_back({pose, answer, 1e6 * (seconds(CLOCK_MONOTONIC) - wall),
                   1e6 * (seconds(CLOCK_PROCESS_CPUTIME_ID) - cpu)});
  }
  return out;
}

/// Of the standard normal distribution, by the sum of twelve: the same from every standard library.
double normal(std::mt19937_64& random) {
  double sum = -6;
  for (int i = 0; i < 12; ++i) sum += static_cast<double>(random() >> 11) * 0x1p-53;
  return sum;
}

}  // namespace

Measured measure(Adapter& adapter, const Case& subject, std::size_t rest_poses, bool cpu_clock) {
  Measured out;
  out.cpu_clock = cpu_clock;
  const double memory = resident_mib(), began = seconds(CLOCK_MONOTONIC);
  adapter.prepare(subject);
  out.prepare_s = seconds(CLOCK_MONOTONIC) - began;
  ask(adapter, subject.path);
  out.memory_mib = resident_mib() - memory;
  out.path = ask(adapter, subject.path);
  out.loop = ask(adapter, subject.loop);
  std::mt19937_64 random(1);
  std::vector<Pose> rest;
  double squares = 0;
  for (std::size_t i = 0; i < rest_poses; ++i) {
    Vec3 off(0);
    for (int k = 0; k < 3; ++k) off[k] = kTremble * normal(random);
    squares += glm::dot(off, off);
    rest.push_back(moved(subject.rest, off, Vec3(0)));
  }
  if (rest_poses > 0) out.tremble_m = std::sqrt(squares / static_cast<double>(rest_poses) / 3);
  out.rest = ask(adapter, rest);
  return out;
}

}  // namespace yardstick
