// How long a Falcon's packet and its answer take on this machine, and how well 1 kHz is kept: usb_round_trip
// [SECONDS], default 60, twice.
//
// First a loop by the clock, 1 ms a turn, that does by turns what a Falcon's thread does (16 bytes out, the
// report found in what comes in) and the same with nothing but libusb (16 bytes out, any packet in), each on
// an in-process device that answers at once. The difference is ours. Then the whole driver, its own thread
// included, under a 1 kHz control loop. No real bus is in it: 16 bytes take another 107 µs each way there.

#include <pthread.h>
#include <sched.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <thread>
#include <vector>

#include "driver/falcon/packet.h"
#include "driver/falcon/serial_line.h"
#include "tests/driver/fake_usb/falcon_table.h"

namespace {

using namespace palpate;
using namespace palpate::falcon;
using Clock = std::chrono::steady_clock;
using std::chrono::microseconds;
using std::chrono::milliseconds;

class Figures {
 public:
  explicit Figures(std::size_t count) { values_.reserve(count); }
  void add(Clock::duration time) {
    values_.push_back(std::chrono::duration<double, std::micro>(time).count());
  }
  void print(const char* what) {
    std::sort(values_.begin(), values_.end());
    const auto at = [&](double share) {
      return values_.empty()
                 ? 0
                 : values_[static_cast<std::size_t>(share * static_cast<double>(values_.size() - 1))];
    };
    std::printf("%-42s %8zu  p50 %8.1f  p99 %8.1f  p99.9 %8.1f  max %8.1f us\n", what, values_.size(),
                at(0.5), at(0.99), at(0.999), at(1));
  }

 private:
  std::vector<double> values_;
};

/// Turns of 1 ms by the clock; a turn that begins a whole period late is skipped and counted.
template <class Turn>
std::size_t by_the_clock(std::size_t turns, Figures& lateness, Turn turn) {
  std::size_t missed = 0;
  auto due = Clock::now();
  for (std::size_t i = 0; i < turns; ++i) {
    turn(i);
    due += milliseconds(1);
    std::this_thread::sleep_until(due);
    const auto late = Clock::now() - due;
    lateness.add(late);
    if (late >= milliseconds(1)) {
      const auto skipped = late / milliseconds(1);
      missed += static_cast<std::size_t>(skipped);
      due += milliseconds(1) * skipped;
    }
  }
  return missed;
}

int round_trips(std::size_t turns) {
  // A Falcon that runs, and a device that says 16 bytes for any 16 bytes.
  fake::FalconTable table({}, true);
  auto port = table.opener()();
  if (!port) return std::fprintf(stderr, "%s\n", port.error().sentence.c_str()), 1;
  SerialLine line(std::move(*port));
  if (!line.begin() || !line.set_baud(Baud::k1500000))
    return std::fprintf(stderr, "the model does not begin\n"), 1;
  std::size_t owed = 0;
  fake::DescriptorFront echo(
      {[](std::uint8_t, std::uint16_t) { return true; }, [&](std::span<const std::uint8_t>) { ++owed; },
       [&] {
         std::vector<std::uint8_t> packet(owed > 0 ? 18 : 2);
         owed -= owed > 0;
         return packet;
       },
       [&] { return owed > 0; }},
      fake::bulk_pair_descriptors(1, 1));
  auto bare = UsbPort::open_descriptor(echo.descriptor(), 0);
  if (!bare) return std::fprintf(stderr, "%s\n", bare.error().sentence.c_str()), 1;
  std::size_t answers = 0;
  if (!(*bare)->listen(0x81, false, 64,
                       [&](std::span<const std::uint8_t> bytes) { answers += bytes.size() > 2; }))
    return 1;

  Figures falcon(turns), empty(turns), lateness(turns);
  PacketStream stream;
  std::size_t unanswered = 0;
  const Packet command = encode(Command{{100, -200, 300}, kHomingOn | kGreen});
  const std::size_t missed = by_the_clock(turns, lateness, [&](std::size_t i) {
    const auto begun = Clock::now();
    bool done = false;
    if (i % 2 == 0) {
      if (!line.send(command))
        line.take(microseconds(0), [&](std::uint8_t byte) { (void)stream.take(byte); });
      while (!done && Clock::now() - begun < milliseconds(1))
        line.take(microseconds(500), [&](std::uint8_t byte) {
          if (const auto packet = stream.take(byte)) done = decode_report(*packet).has_value() || done;
        });
    } else {
      const std::size_t before = answers;
      (void)(*bare)->send(0x02, command);
      while (!(done = answers > before) && Clock::now() - begun < milliseconds(1))
        (*bare)->pump(microseconds(500));
    }
    if (done)
      (i % 2 == 0 ? falcon : empty).add(Clock::now() - begun);
    else
      ++unanswered;
  });
  falcon.print("round trip, Falcon packet and its report");
  empty.print("round trip, libusb alone");
  lateness.print("turn begun late");
  std::printf("%zu turns of 1 ms, %zu missed, %zu without an answer within their turn\n", turns, missed,
              unanswered);
  return 0;
}

int whole_driver(std::size_t turns) {
  fake::FalconTable table({}, true);
  auto made = make_falcon({}, Pose{}, table.opener());
  if (!made || !(*made)->open()) return std::fprintf(stderr, "the driver does not open\n"), 1;
  HapticDevice& device = **made;
  while (device.read().state != DeviceState::kReady) {
    device.write({}, Vec3(0));
    std::this_thread::sleep_for(milliseconds(1));
  }
  const int before = table.locked([&] { return table.model.reports(); });
  Figures calls(turns), age(turns), lateness(turns);
  std::size_t unready = 0;
  const std::size_t missed = by_the_clock(turns, lateness, [&](std::size_t) {
    const auto begun = Clock::now();
    const DeviceSample sample = device.read();
    device.write({Vec3(0, 0, 2), Vec3(0)}, Vec3(0));
    const auto now = Clock::now();
    calls.add(now - begun);
    age.add(now.time_since_epoch() - std::chrono::nanoseconds(sample.time_ns));
    unready += sample.state != DeviceState::kReady;
  });
  const int reports = table.locked([&] { return table.model.reports(); }) - before;
  calls.print("read() and write() of a tick");
  age.print("age of a tick's sample");
  lateness.print("tick begun late");
  std::printf("%zu ticks, %zu missed, %zu not ready, %.0f reports a second\n", turns, missed, unready,
              static_cast<double>(reports) / (static_cast<double>(turns + missed) / 1000));
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  const double seconds = argc > 1 ? std::atof(argv[1]) : 60;
  if (!(seconds > 0 && seconds <= 3600))
    return std::fprintf(stderr, "usage: usb_round_trip [SECONDS up to 3600]\n"), 2;
  const sched_param priority{.sched_priority = 80};
  const bool granted = pthread_setschedparam(pthread_self(), SCHED_FIFO, &priority) == 0;
  std::printf("%.0f s each, real-time priority %s\n", seconds, granted ? "granted" : "refused");
  const auto turns = static_cast<std::size_t>(seconds * 1000);
  const int failed = round_trips(turns);
  return failed != 0 ? failed : whole_driver(turns);
}
