#include "driver/falcon/falcon_link.h"

#include <pthread.h>
#include <sched.h>

#include <chrono>

#include "driver/kept_text.h"

namespace palpate::falcon {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::microseconds;
using std::chrono::milliseconds;

constexpr auto kReopenEvery = milliseconds(250);
constexpr auto kPause = microseconds(500);  // between two packets at least: twice the device's design rate
constexpr auto kAnswerTime =
    milliseconds(5);  // without an answer by then the next packet goes out all the same
constexpr auto kLoopSilence = milliseconds(20);  // without a new force by then the motors get zero
constexpr auto kDeviceSilence =
    milliseconds(200);  // without a sound report by then the device counts as gone

constexpr const char* kUnplugged = "the Falcon is gone; plug it in again";
constexpr const char* kLoading = "loading the Falcon's firmware";
constexpr const char* kHomingText =
    "home the Falcon: pull the grip all the way out, then push it all the way in";
constexpr const char* kNoFirmware = "the Falcon runs no firmware; name its file with --firmware";
constexpr const char* kNotHomed = "the Falcon was not homed in time; start again";
constexpr const char* kJumped =
    "the Falcon's encoders keep jumping, so its homing is lost; start again and home it";

std::int64_t nanoseconds(Clock::time_point time) {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(time.time_since_epoch()).count();
}

}  // namespace

FalconLink::FalconLink(FalconSettings settings, std::vector<std::uint8_t> image, OpenPort open_port)
    : settings_(std::move(settings)), image_(std::move(image)), open_port_(std::move(open_port)) {}

FalconLink::~FalconLink() { stop(); }

Result<void> FalconLink::start() {
  stop();
  auto port = open_port_();
  if (!port) return port.error();
  line_ = std::make_unique<SerialLine>(std::move(*port));
  if (auto begun = line_->begin(); !begun) {
    line_.reset();
    return begun;
  }
  stop_ = false;
  now_ = {};
  thread_ = std::thread([this] { run(); });
  return {};
}

void FalconLink::stop() noexcept {
  stop_ = true;
  if (thread_.joinable()) thread_.join();
  line_.reset();
}

void FalconLink::tell(DeviceState state, const char* guidance) noexcept {
  now_.state = state;
  now_.guidance = guidance;
  from_device_.publish(now_);
}

void FalconLink::run() {
  // As punctual as the control loop, and just behind it (its priority is 80). Refused, it is an ordinary
  // thread, as the loop is then.
  const sched_param priority{.sched_priority = 79};
  (void)pthread_setschedparam(pthread_self(), SCHED_FIFO, &priority);
  while (!stopping()) {
    const Next next = line_ ? serve(*line_) : Next::kReopen;
    if (line_ && !line_->lost())
      (void)line_->write(encode(Command{}), milliseconds(100));  // whatever ended it: no force stays on
    if (next == Next::kStop) return;
    line_.reset();
    if (next == Next::kFault) return;  // told already; the next start() begins anew
    tell(DeviceState::kOpening, kUnplugged);
    for (const auto again = Clock::now() + kReopenEvery; Clock::now() < again && !stopping();)
      std::this_thread::sleep_for(milliseconds(10));
    if (stopping()) return;
    if (auto port = open_port_()) {
      line_ = std::make_unique<SerialLine>(std::move(*port));
      if (!line_->begin()) line_.reset();
    }
  }
}

FalconLink::Next FalconLink::serve(SerialLine& line) {
  const std::optional<Next> failed = bring_up(line);
  return failed ? *failed : exchange(line);
}

std::optional<FalconLink::Next> FalconLink::bring_up(SerialLine& line) {
  tell(DeviceState::kLoading, kLoading);
  if (set_running_line(line) && answers(line)) return std::nullopt;
  if (stopping()) return Next::kStop;
  if (line.lost()) return Next::kReopen;
  if (image_.empty()) {
    tell(DeviceState::kFault, kNoFirmware);
    return Next::kFault;
  }
  const Result<void> loaded = load_firmware(line, image_, [this] { return stopping(); });
  if (loaded) return std::nullopt;
  if (stopping()) return Next::kStop;
  if (line.lost()) return Next::kReopen;
  tell(DeviceState::kFault,
       kept_text(loaded.error().sentence + "; unplug the Falcon, plug it in and start again"));
  return Next::kFault;
}

MotorCounts FalconLink::wanted_motors() noexcept {
  const std::int64_t now = nanoseconds(Clock::now());
  if (const FromLoop* wanted = to_device_.take()) {
    newest_ = *wanted;
    newest_ns_ = now;
  }
  const bool silent = now - newest_ns_ > std::chrono::nanoseconds(kLoopSilence).count();
  return silent ? MotorCounts{} : newest_.motors;
}

FalconLink::Next FalconLink::exchange(SerialLine& line) {
  PacketStream stream;
  ReportFilter filter;
  const auto begun = Clock::now();
  auto last_sound = begun, last_sent = begun - kAnswerTime, homing_since = begun;
  bool answered = true;
  const BusCounts before = now_.counts;  // of earlier times that it was plugged in
  tell(DeviceState::kHoming, kHomingText);
  while (!stopping()) {
    const auto now = Clock::now();
    if (line.lost() || now - last_sound > kDeviceSilence) return Next::kReopen;
    if (filter.homed()) homing_since = now;  // lost homing has the whole time again
    if (now - homing_since > std::chrono::duration<double>(settings_.homing_timeout_s)) {
      tell(DeviceState::kFault, kNotHomed);
      return Next::kFault;
    }
    if ((answered && now - last_sent >= kPause) || now - last_sent >= kAnswerTime) {
      const bool ready = filter.homed();
      const Command command{ready ? wanted_motors() : MotorCounts{},
                            static_cast<std::uint8_t>(kHomingOn | (ready ? kGreen : kRed))};
      if (line.send(encode(command))) {
        if (!answered) ++now_.counts.late;
        last_sent = now;
        answered = false;
      }
    }
    line.take(kPause, [&](std::uint8_t byte) {
      const auto packet = stream.take(byte);
      if (!packet) return;
      const auto report = decode_report(*packet);
      if (!report) return;
      answered = true;
      const auto came = Clock::now();
      const auto ticks = std::chrono::duration_cast<milliseconds>(came - last_sound).count() + 1;
      last_sound = came;
      ++now_.counts.reports;
      if (filter.take(*report, static_cast<int>(ticks))) now_.time_ns = nanoseconds(came);
    });
    now_.encoders = filter.encoders();
    now_.buttons = filter.buttons();
    now_.counts.malformed = before.malformed + stream.malformed();
    now_.counts.jumps = before.jumps + filter.jumps();
    now_.counts.errors = before.errors + line.errors();
    if (filter.lost()) {
      tell(DeviceState::kFault, kJumped);
      return Next::kFault;
    }
    tell(filter.homed() ? DeviceState::kReady : DeviceState::kHoming, filter.homed() ? "" : kHomingText);
  }
  return Next::kStop;
}

}  // namespace palpate::falcon
