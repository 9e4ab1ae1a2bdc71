#include "service/cli/console.h"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>

namespace palpate {
namespace {

std::atomic<bool> interrupt_seen{false};
std::atomic<std::int64_t> interrupt_ns{0};  // when it came first; 0: it has not
static_assert(std::atomic<bool>::is_always_lock_free && std::atomic<std::int64_t>::is_always_lock_free,
              "a signal handler may only touch lock-free atomics");
// Signals so close to each other are one: `timeout` sends its own to the program and then to its group
// (chosen).
constexpr std::int64_t kOneSignalNs = 250'000'000;

extern "C" void on_interrupt(int number) {
  timespec time{};
  clock_gettime(CLOCK_MONOTONIC, &time);
  const std::int64_t now = std::int64_t{time.tv_sec} * 1'000'000'000 + time.tv_nsec;
  std::int64_t first = 0;
  if (interrupt_ns.compare_exchange_strong(first, now)) {
    interrupt_seen.store(true, std::memory_order_relaxed);
  } else if (now - first > kOneSignalNs) {
    std::signal(number, SIG_DFL);  // a second signal ends a program that hangs
    std::raise(number);
  }
}

std::size_t terminal_columns() {
  winsize size{};
  if (ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0) return size.ws_col;
  return 80;
}

/// The first `columns` characters of a UTF-8 text.
std::string_view cut(std::string_view text, std::size_t columns) {
  std::size_t shown = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool starts_character = (static_cast<unsigned char>(text[i]) & 0xC0u) != 0x80u;
    if (starts_character && shown++ == columns) return text.substr(0, i);
  }
  return text;
}

void put(std::string_view text) {
  std::fwrite(text.data(), 1, text.size(), stderr);
  std::fflush(stderr);
}

constexpr int kBarCells = 30;
constexpr std::chrono::milliseconds kRedraw{50}, kSignOfLife{10'000};

std::atomic<bool> is_quiet{false};

std::string bar(double done) {
  const int full = std::clamp(static_cast<int>(std::lround(done * kBarCells)), 0, kBarCells);
  std::string cells;
  for (int i = 0; i < kBarCells; ++i) cells += i < full ? "█" : "░";
  return cells;
}

}  // namespace

void catch_interrupts() {
  interrupt_seen = false;
  interrupt_ns = 0;
  std::signal(SIGINT, on_interrupt);
  std::signal(SIGTERM, on_interrupt);
}

bool interrupted() noexcept { return interrupt_seen.load(std::memory_order_relaxed); }
const std::atomic<bool>& interrupt_flag() noexcept { return interrupt_seen; }

Console::Console() {
  const char* term = std::getenv("TERM");
  terminal_ = isatty(STDERR_FILENO) == 1 && term != nullptr && std::strcmp(term, "dumb") != 0;
  if (!terminal_) last_draw_ = std::chrono::steady_clock::now();
}

void Console::be_quiet() { is_quiet = true; }
bool Console::quiet() { return is_quiet; }

Console::~Console() { finish(); }

void Console::note(std::string_view sentence) {
  if (!is_quiet) say(sentence);
}

void Console::say(std::string_view sentence) {
  finish();
  put(fmt::format("palpate: {}\n", sentence));
}

void Console::step(std::string_view name) {
  step_ = name;
  if (!terminal_) note(name);
}

bool Console::progress(const char* what, double done) {
  if (terminal_ ? !drawn_ || done >= 1 || wants_live() : wants_live()) {
    const double percent = 100 * std::clamp(done, 0.0, 1.0);
    live(terminal_ ? fmt::format("{} {:3.0f} %  {}: {}", bar(done), percent, step_, what)
                   : fmt::format("{}: {}, {:.0f} %", step_, what, percent));
  }
  return !interrupted();
}

bool Console::wants_live() const {
  return !is_quiet && std::chrono::steady_clock::now() - last_draw_ >= (terminal_ ? kRedraw : kSignOfLife);
}

void Console::live(std::string_view line) {
  if (is_quiet) return;
  last_draw_ = std::chrono::steady_clock::now();
  if (terminal_)
    draw(line);
  else
    note(line.substr(std::min(line.find_first_not_of(' '), line.size())));
}

void Console::finish() {
  if (!drawn_) return;
  drawn_ = false;
  put("\r\033[K");
}

void Console::draw(std::string_view line) {
  drawn_ = true;
  put(fmt::format("\r\033[K{}", cut(line, terminal_columns() - 1)));
}

}  // namespace palpate
