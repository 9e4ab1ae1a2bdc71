#pragma once
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "service/server/http/problem.h"

namespace palpate {

/// The boundary of a multipart/form-data content type, or "" when it has none that is allowed (RFC 2046: 1 to
/// 70 characters).
std::string boundary_of(std::string_view content_type);

/// What stands before a part's content.
struct PartHead {
  std::string name, filename;  ///< of Content-Disposition; bytes as sent
};

/// Reads multipart/form-data piece by piece, in memory that doesn't grow with the body. Never throws.
class MultipartReader {
 public:
  struct Events {
    std::function<std::optional<Problem>(const PartHead&)> part;
    std::function<std::optional<Problem>(std::string_view)> data;
    std::function<std::optional<Problem>()> end;  ///< of the part
  };
  static constexpr std::size_t kLongestHead = 8 << 10;  ///< bytes of a part's header

  MultipartReader(const std::string& boundary, Events events);
  /// The first problem ends the reading.
  std::optional<Problem> feed(std::string_view bytes);
  bool complete() const { return state_ == State::kOver; }

 private:
  enum class State : std::uint8_t { kPreamble, kAfterBoundary, kHead, kData, kOver };
  std::optional<Problem> read_head(std::string_view head);

  std::string delimiter_, pending_;
  Events events_;
  State state_ = State::kPreamble;
};

}  // namespace palpate
