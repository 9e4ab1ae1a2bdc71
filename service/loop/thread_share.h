#pragma once
#include <set>

namespace palpate {

// What share of the processor the calling thread gets beside others, as far as it may choose; what is refused
// is left as it is.

/// How much it gives way, from −20 to 19; below 0 needs the right to it (root, CAP_SYS_NICE, LimitNICE).
/// Chosen: what a hand waits for goes before what a person waits for, and that before what a program waits
/// for.
inline constexpr int kNiceContact = -10, kNiceConnections = 10, kNiceBatches = 19, kNicePreparation = 15;
void set_nice(int level) noexcept;

/// How long it runs at a stretch where others wait, µs, 100 to 100,000. Who wants little at a time is let on
/// sooner when it wakes (Linux 6.12 and later; needs no right): a waking thread goes first if its turn is
/// shorter and would end before the running one's. Chosen: a tick takes far less than a tenth of its
/// millisecond, finding contact some hundreds of µs. Beside a loop without priority its turn outlasts the
/// tick that woke it, so that the next tick's ends first, and stays below the usual 3 ms, so that others'
/// programs are still left behind.
inline constexpr int kSliceTickUs = 100, kSliceContactUs = 400, kSliceBesideLoopUs = 1200;
void set_slice(int microseconds) noexcept;

/// Its sleeps end when they should, not up to 50 µs later so that the processor wakes less often (needs no
/// right).
void set_exact_sleep() noexcept;

/// The last of the processors that the calling thread may run on: a control loop's; −1: there is but one.
int loop_processor() noexcept;

/// The calling thread works for a hand while this lives: it may run on all of the process's processors,
/// whatever LoopRoom says.
class ForHand {
 public:
  ForHand() noexcept;
  ~ForHand();
  ForHand(const ForHand&) = delete;
  ForHand& operator=(const ForHand&) = delete;
};

/// The same, and for as long as they last the threads that the process makes meanwhile: a driver's, which a
/// loop's back end needs.
class MakesForHand {
 public:
  MakesForHand();
  ~MakesForHand();
  MakesForHand(const MakesForHand&) = delete;
  MakesForHand& operator=(const MakesForHand&) = delete;

 private:
  ForHand self_;
  std::set<int> before_;  ///< threads
};

/// While one lives, all threads of the process that are not ForHand, drivers' and those yet to come included,
/// stay off the control loops' processor: neither they nor what the kernel does for them (network packets,
/// page tables) keep a tick or its contact waiting. No right is needed. Nothing happens where there is but
/// one processor. Takes a lock and reads /proc: not for the loop itself.
class LoopRoom {
 public:
  LoopRoom();
  ~LoopRoom();
  LoopRoom(const LoopRoom&) = delete;
  LoopRoom& operator=(const LoopRoom&) = delete;
};

}  // namespace palpate
