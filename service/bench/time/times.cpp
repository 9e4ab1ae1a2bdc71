#include "service/bench/time/times.h"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <string_view>

namespace palpate {

namespace {
double now_us(bool cpu_clock) {
  std::timespec now{};
  clock_gettime(cpu_clock ? CLOCK_PROCESS_CPUTIME_ID : CLOCK_MONOTONIC, &now);
  return static_cast<double>(now.tv_sec) * 1e6 + static_cast<double>(now.tv_nsec) * 1e-3;
}
}  // namespace

Stopwatch::Stopwatch(bool cpu_clock) : cpu_clock_(cpu_clock), start_us_(now_us(cpu_clock)) {}
double Stopwatch::us() const { return now_us(cpu_clock_) - start_us_; }

TimePercentiles percentiles(std::vector<double> times_us) {
  TimePercentiles out;
  out.count = times_us.size();
  if (times_us.empty()) return out;
  std::sort(times_us.begin(), times_us.end());
  const auto at = [&](double part) {
    const double rank = std::ceil(part * static_cast<double>(times_us.size()));
    return times_us[static_cast<std::size_t>(std::max(rank, 1.0)) - 1];
  };
  out.p50 = at(0.5);
  out.p95 = at(0.95);
  out.p99 = at(0.99);
  if (times_us.size() >= 1000) out.p999 = at(0.999);
  out.max = times_us.back();
  return out;
}

FrameKind frame_kind(const Contacts& contacts) {
  if (contacts.contact) return FrameKind::kContact;
  const bool culled = contacts.times.size() == 1 && std::string_view(contacts.times[0].stage) == "cull";
  return culled ? FrameKind::kApart : FrameKind::kFree;
}

void TimeTable::put(FrameKind kind, const std::string& stage, double us) {
  if (std::find(order_.begin(), order_.end(), stage) == order_.end()) order_.push_back(stage);
  times_[static_cast<std::size_t>(kind)][stage].push_back(us);
}

void TimeTable::add(FrameKind kind, double total_us, const DeviceWork& work) {
  work_[static_cast<std::size_t>(kind)].push_back(work);
  add(kind, total_us);
}

void TimeTable::add(const Contacts& contacts, double total_us, const DeviceWork& work) {
  add(frame_kind(contacts), total_us, work);
  add_stages(contacts, total_us);
}

void TimeTable::add_stages(const Contacts& contacts, double total_us) {
  const FrameKind kind = frame_kind(contacts);
  // A stage may come several times in a frame; its time is their sum.
  std::vector<std::pair<std::string_view, double>> sums;
  double known = 0;
  for (const auto& time : contacts.times) {
    known += time.us;
    const auto found =
        std::find_if(sums.begin(), sums.end(), [&](const auto& sum) { return sum.first == time.stage; });
    if (found == sums.end())
      sums.emplace_back(time.stage, time.us);
    else
      found->second += time.us;
  }
  for (const auto& [stage, us] : sums) put(kind, std::string(stage), us);
  put(kind, "host", std::max(0.0, total_us - known));
}

std::vector<double> TimeTable::times(std::size_t kind, const std::string& stage) const {
  std::vector<double> out;
  for (std::size_t k = 0; k < 3; ++k) {
    if (kind != 3 && kind != k) continue;
    const auto found = times_[k].find(stage);
    if (found != times_[k].end()) out.insert(out.end(), found->second.begin(), found->second.end());
  }
  return out;
}

DeviceWork TimeTable::work(std::size_t kind) const {
  std::vector<DeviceWork> all;
  for (std::size_t k = 0; k < 3; ++k)
    if (kind == 3 || kind == k) all.insert(all.end(), work_[k].begin(), work_[k].end());
  return median_of(std::move(all));
}

DeviceWork median_of(std::vector<DeviceWork> all) {
  DeviceWork out;
  if (all.empty()) return out;
  const auto take = [&](auto member) {
    const auto middle = all.begin() + static_cast<std::ptrdiff_t>((all.size() - 1) / 2);
    std::nth_element(all.begin(), middle, all.end(),
                     [&](const DeviceWork& a, const DeviceWork& b) { return a.*member < b.*member; });
    out.*member = (*middle).*member;
  };
  for (const auto member : {&DeviceWork::submissions, &DeviceWork::dispatches, &DeviceWork::barriers,
                            &DeviceWork::bytes_up, &DeviceWork::bytes_down})
    take(member);
  take(&DeviceWork::host_us);
  return out;
}

DeviceWork since(const DeviceWork& before, const DeviceWork& after) {
  return {after.submissions - before.submissions, after.dispatches - before.dispatches,
          after.barriers - before.barriers,       after.bytes_up - before.bytes_up,
          after.bytes_down - before.bytes_down,   after.host_us - before.host_us};
}

}  // namespace palpate
