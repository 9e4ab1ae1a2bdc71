#pragma once
#include <algorithm>
#include <cstdint>

#include "model/contact/contacts.h"

namespace palpate {

/// Keeps a loop's frames to a budget of time: while they exceed it they are sampled coarser, little by
/// little, so that no frame's force jumps. Does nothing where samples are not what takes the time. One
/// thread; neither allocates nor blocks.
class FrameBudget {
 public:
  /// `budget_us`: of a whole frame; 0: none.
  explicit FrameBudget(double budget_us) : budget_us_(budget_us) {}

  /// By how much the next frame is to be coarser (Ignored::coarser).
  std::uint32_t coarser() const noexcept { return coarser_; }

  /// A frame took `total_us`, of it `field_us` for its samples; it was as coarse as coarser() said.
  void frame(double total_us, double field_us) noexcept {
    if (budget_us_ <= 0) return;
    if (coarser_ > 0) ++coarse_frames_;
    coarsest_ = std::max(coarsest_, coarser_);
    if (total_us > budget_us_) {
      if (field_us * (coarser_ < kFew ? kWorth : kWorthFew) > total_us)
        coarser_ = std::min(coarser_ + kUp, Ignored::kCoarsest);
    } else if (total_us < kRoom * budget_us_) {
      coarser_ -= std::min(coarser_, kDown);
    }
  }

  /// Frames that were coarser than their size asked for.
  std::uint64_t coarse_frames() const noexcept { return coarse_frames_; }
  std::uint32_t coarsest() const noexcept { return coarsest_; }  ///< of these, 256ths of a level

 private:
  // Chosen. A sixteenth of a level moves a force by a sixteenth of what two levels differ by: a level comes
  // in 16 frames, some 70 ms at the budget, and goes in 64.
  static constexpr std::uint32_t kUp = 16, kDown = 4;
  static constexpr double kRoom =
      0.75;  ///< of the budget: below it samples come back; half of them more cost less than the rest
  static constexpr double kWorth = 8;  ///< coarser samples are of use while they take that part of a frame, …
  static constexpr std::uint32_t kFew =
      2 * 256;                            ///< … and below a quarter of them, where forces get rough, …
  static constexpr double kWorthFew = 2;  ///< … while they take that one

  double budget_us_;
  std::uint32_t coarser_ = 0, coarsest_ = 0;
  std::uint64_t coarse_frames_ = 0;
};

}  // namespace palpate
