#pragma once
#include <optional>
#include <string>
#include <utility>
#include <variant>

namespace palpate {

/// What went wrong, as the command line's exit code says it.
enum class ErrorCode {
  kInternal = 1,  ///< a fault of ours or of a library
  kUsage = 2,     ///< a flag that is unknown, missing or contradictory
  kBadValue = 3,  ///< a value in a file or an argument
  kNoDevice = 4,  ///< no usable Vulkan or haptic device
  kNotClear = 5,  ///< no fault: a path that was asked about is not clear
};

/// One clear sentence with file, offending value and limit.
struct Error {
  ErrorCode code = ErrorCode::kInternal;
  std::string sentence;
};

inline Error bad_value(std::string sentence) { return {ErrorCode::kBadValue, std::move(sentence)}; }

/// A value, or the reason there is none. For set-up paths only; the 1 kHz path uses statuses.
template <class T>
class [[nodiscard]] Result {
 public:
  Result(T value) : state_(std::move(value)) {}      // NOLINT(google-explicit-constructor)
  Result(Error error) : state_(std::move(error)) {}  // NOLINT(google-explicit-constructor)
  explicit operator bool() const { return state_.index() == 0; }
  T& value() & { return std::get<0>(state_); }
  const T& value() const& { return std::get<0>(state_); }
  T&& value() && { return std::get<0>(std::move(state_)); }
  T* operator->() { return &std::get<0>(state_); }
  const T* operator->() const { return &std::get<0>(state_); }
  T& operator*() & { return std::get<0>(state_); }
  const T& operator*() const& { return std::get<0>(state_); }
  const Error& error() const { return std::get<1>(state_); }

 private:
  std::variant<T, Error> state_;
};

/// Success, or the reason for failure.
template <>
class [[nodiscard]] Result<void> {
 public:
  Result() = default;
  Result(Error error) : error_(std::move(error)) {}  // NOLINT(google-explicit-constructor)
  explicit operator bool() const { return !error_.has_value(); }
  const Error& error() const { return *error_; }

 private:
  std::optional<Error> error_;
};

}  // namespace palpate
