#pragma once
#include <atomic>
#include <chrono>
#include <string>
#include <string_view>

namespace palpate {

/// Writes to standard error: sentences, a progress bar, a live line. On a terminal the bar and the live line
/// are redrawn in place; elsewhere a step is one plain line, and of what is under way a line comes every 10
/// seconds, so that a log shows that it goes on. One thread at a time.
class Console {
 public:
  Console();
  ~Console();
  Console(const Console&) = delete;
  Console& operator=(const Console&) = delete;

  /// From now on no console writes more than say() does.
  static void be_quiet();
  static bool quiet();

  bool terminal() const { return terminal_; }

  /// "palpate: <sentence>".
  void note(std::string_view sentence);
  /// The same, however quiet: what a person has to do.
  void say(std::string_view sentence);

  /// Begins a step of long work ("reading the meshes").
  void step(std::string_view name);
  /// Progress of the step, `done` in [0, 1]; `what` goes on inside it now. Returns false when the
  /// user asked to stop (interrupted()), as `Progress` of model/collision_backend.h wants it.
  bool progress(const char* what, double done);

  /// Whether a live line would be seen now: at most 20 times a second on a terminal, every 10 seconds
  /// elsewhere.
  bool wants_live() const;
  /// One line of numbers, on a terminal redrawn in place.
  void live(std::string_view line);

  /// Ends the bar or the live line, so that what follows starts on a line of its own.
  void finish();

 private:
  void draw(std::string_view line);

  bool terminal_ = false;
  bool drawn_ = false;  ///< a bar or live line stands on the current line
  std::string step_;
  std::chrono::steady_clock::time_point last_draw_{};
};

/// From now on SIGINT and SIGTERM only raise a flag, which is down until then; a second one, a quarter of a
/// second later or more, ends the process as usual.
void catch_interrupts();
bool interrupted() noexcept;
const std::atomic<bool>& interrupt_flag() noexcept;

}  // namespace palpate
