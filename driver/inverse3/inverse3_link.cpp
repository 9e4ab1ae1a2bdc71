#include "driver/inverse3/inverse3_link.h"

#include <pthread.h>
#include <sched.h>

namespace palpate::inverse3 {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::microseconds;
using std::chrono::milliseconds;

constexpr auto kConnectTime = milliseconds(1000);
constexpr auto kReopenEvery = milliseconds(250);
constexpr auto kPause = microseconds(800);  // between two messages: a little faster than the control loop
constexpr auto kLoopSilence = milliseconds(20);  // without a new force by then the arm gets zero
constexpr auto kSilence = milliseconds(200);     // without a sound state by then the arm counts as gone

constexpr const char* kGone = "the Inverse3 or its service is gone; plug it in or start the service again";
constexpr const char* kNotReady =
    "the Inverse3 is not ready; see that it has power, and calibrate it in its maker's program";

std::int64_t nanoseconds(Clock::time_point time) {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(time.time_since_epoch()).count();
}

}  // namespace

Inverse3Link::~Inverse3Link() { stop(); }

Result<Connection> connect(std::uint16_t port) {
  auto socket = std::make_unique<ServiceSocket>();
  if (auto connected = socket->connect(port, kConnectTime); !connected) return connected.error();
  const auto inventory = socket->receive(kConnectTime);
  if (!inventory) return Error{ErrorCode::kNoDevice, "the service doesn't say which devices it has"};
  auto session = read_inventory(*inventory);
  if (!session) return session.error();
  return Connection{std::move(socket), std::move(*session)};
}

Result<void> Inverse3Link::start() {
  stop();
  auto connected = connect(port_);
  if (!connected) return connected.error();
  to_ = std::move(*connected);
  has_grip_ = !to_.session.grip.empty();
  stop_ = false;
  now_ = {};
  thread_ = std::thread([this] { run(); });
  return {};
}

void Inverse3Link::stop() noexcept {
  stop_ = true;
  if (thread_.joinable()) thread_.join();
  to_.socket.reset();
}

void Inverse3Link::tell(DeviceState state, const char* guidance) noexcept {
  now_.state = state;
  now_.guidance = guidance;
  from_device_.publish(now_);
}

void Inverse3Link::run() {
  // As punctual as the control loop, and just behind it (its priority is 80). Refused, it is an ordinary
  // thread, as the loop is then.
  const sched_param priority{.sched_priority = 79};
  (void)pthread_setschedparam(pthread_self(), SCHED_FIFO, &priority);
  while (!stopping()) {
    exchange();
    (void)to_.socket->send(force_message(to_.session, Vec3(0)), milliseconds(100));
    to_.socket.reset();
    if (stopping()) return;
    ++now_.counts.lost;
    tell(DeviceState::kOpening, kGone);
    while (!stopping() && !to_.socket) {
      for (const auto again = Clock::now() + kReopenEvery; Clock::now() < again && !stopping();)
        std::this_thread::sleep_for(milliseconds(10));
      if (stopping()) return;
      if (auto connected = connect(port_)) to_ = std::move(*connected);
    }
  }
}

Vec3 Inverse3Link::wanted_force() noexcept {
  const std::int64_t now = nanoseconds(Clock::now());
  if (const FromLoop* wanted = to_device_.take()) {
    newest_ = *wanted;
    newest_ns_ = now;
  }
  const bool silent = now - newest_ns_ > std::chrono::nanoseconds(kLoopSilence).count();
  return silent || now_.state != DeviceState::kReady ? Vec3(0) : newest_.force;
}

void Inverse3Link::take_in(const State& state) {
  ++now_.counts.states;
  now_.cursor = state.cursor;
  now_.turned = state.orientation.has_value();
  if (state.orientation) now_.orientation = *state.orientation;
  now_.buttons = state.buttons;
  now_.time_ns = nanoseconds(Clock::now());
  tell(state.usable ? DeviceState::kReady : DeviceState::kHoming, state.usable ? "" : kNotReady);
}

void Inverse3Link::exchange() {
  auto last_sound = Clock::now();
  while (!stopping() && Clock::now() - last_sound <= kSilence) {
    const auto next = Clock::now() + kPause;
    if (!to_.socket->send(force_message(to_.session, wanted_force()), kSilence)) return;
    const auto answer = to_.socket->receive(kSilence);
    if (!answer) return;
    if (const auto state = read_state(*answer, to_.session)) {
      last_sound = Clock::now();
      take_in(*state);
    } else {
      ++now_.counts.broken;
    }
    std::this_thread::sleep_until(next);
  }
}

}  // namespace palpate::inverse3
