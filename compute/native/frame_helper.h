#pragma once
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <memory>
#include <thread>

namespace palpate {

/// Bytes that lie between what one thread of a frame writes often and what the other reads or writes, so that
/// their caches do not pass it to and fro: two lines of 64, which processors fetch together.
inline constexpr std::size_t kOwnLines = 128;

/// A thread beside the one that asks, for parts of a frame that do not need each other. It takes parts when
/// it comes in time and is never waited for to come, so a frame is never later than alone but by a part that
/// it has begun. What a part leaves may not depend on who did it.
class FrameHelper {
 public:
  static constexpr std::uint32_t kMostParts = 0xFFFF;  ///< of a round: 16 bits of left_
  static constexpr int kLanes = 2;                     ///< threads: the asker's, 0, and the helper's, 1

  /// Null where there is but one processor for this process, or no thread to be had.
  static std::unique_ptr<FrameHelper> make();
  ~FrameHelper();
  FrameHelper(const FrameHelper&) = delete;
  FrameHelper& operator=(const FrameHelper&) = delete;

  /// Calls part(i, lane) for i = 0 … parts − 1, each once, on this thread (lane 0), from the first part on,
  /// and the helper's (lane 1), from the last: so each has what lies together, and much the same from frame
  /// to frame, which is near in its caches. Returns when all have returned. At most kMostParts. What a part
  /// throws is thrown on here, once all have ended. One caller at a time. Neither allocates nor blocks: for
  /// the other's last part it spins, then yields.
  template <class Part>
  void share(std::uint32_t parts, Part part) {
    run(
        parts, [](void* context, std::uint32_t i, int lane) { (*static_cast<Part*>(context))(i, lane); },
        &part);
  }

 private:
  using Call = void (*)(void* context, std::uint32_t part, int lane);
  FrameHelper() = default;
  void run(std::uint32_t parts, Call call, void* context);
  void take_parts(int lane) noexcept;
  void serve();

  std::atomic<std::uint64_t> left_{
      0};  ///< round, end and begin of the parts that nobody has taken: 32, 16 and 16 bits
  std::atomic<std::uint32_t> done_{0};  ///< parts of the round
  std::atomic<std::uint32_t> bell_{0};
  std::atomic<bool> stop_{false};
  Call call_ = nullptr;  ///< of the round; whoever has taken a part of it may read
  void* context_ = nullptr;
  std::array<std::exception_ptr, kLanes> thrown_;  ///< in this round, by each thread
  std::thread thread_;
};

/// With a helper or, where it is null, alone.
template <class Part>
void share_parts(FrameHelper* helper, std::uint32_t parts, Part part) {
  if (helper != nullptr && parts > 1 && parts <= FrameHelper::kMostParts) {
    helper->share(parts, part);
    return;
  }
  for (std::uint32_t i = 0; i < parts; ++i) part(i, 0);
}

}  // namespace palpate
