#pragma once
#include <functional>
#include <memory>

namespace palpate {

/// Runs jobs on a few threads of its own, in the order of their coming; threads come with the jobs and go
/// when none is left. For compiling pipelines side by side. One thread at a time may call it.
class Compilers {
 public:
  Compilers();
  /// Drops the jobs that have not begun, and waits for the others.
  ~Compilers();
  Compilers(const Compilers&) = delete;
  Compilers& operator=(const Compilers&) = delete;

  void add(std::function<void()> job);
  /// What is added from now on brings no thread: it waits for begin(), or for a thread that is at work.
  void hold();
  void begin();

 private:
  struct State;
  std::shared_ptr<State> state_;
};

}  // namespace palpate
