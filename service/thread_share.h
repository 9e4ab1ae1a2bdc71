#pragma once

namespace palpate {

// What share of the processor the calling thread gets beside others, as far as it may choose; what is refused is left as it is.

/// How much it gives way, from −20 to 19; below 0 needs the right to it (root, CAP_SYS_NICE, LimitNICE). Chosen: what a hand waits for goes
/// before what a person waits for, and that before what a program waits for.
inline constexpr int kNiceContact = -10, kNiceConnections = 5, kNiceBatches = 10, kNicePreparation = 10;
void set_nice(int level) noexcept;

/// How long it runs at a stretch where others wait, µs, 100 at least. Who wants little at a time is let on sooner when it wakes (Linux 6.12 and later; needs
/// no right). Chosen: a tick takes far less than a tenth of its millisecond, finding contact some hundreds of µs.
inline constexpr int kSliceTickUs = 100, kSliceContactUs = 400;
void set_slice(int microseconds) noexcept;

}  // namespace palpate
