#pragma once
#include <optional>
#include <string>
#include <utility>
#include <variant>

/// All of palpate: classes by themselves, functions here.
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

/// An Error with kBadValue.
inline Error bad_value(std::string sentence) { return {ErrorCode::kBadValue, std::move(sentence)}; }

/// A value, or the reason there is none. For set-up paths only; the 1 kHz path uses statuses.
template <class T>
class [[nodiscard]] Result {
 public:
  /// A value.
  Result(T value) : state_(std::move(value)) {}  // NOLINT(google-explicit-constructor)
  /// The reason why there is none.
  Result(Error error) : state_(std::move(error)) {}  // NOLINT(google-explicit-constructor)
  /// Whether there is a value, and no reason. What is not there must not be looked at.
  explicit operator bool() const { return state_.index() == 0; }
  /// The value.
  T& value() & { return std::get<0>(state_); }
  /// The value.
  const T& value() const& { return std::get<0>(state_); }
  /// The value, to be moved from.
  T&& value() && { return std::get<0>(std::move(state_)); }
  /// A member of the value.
  T* operator->() { return &std::get<0>(state_); }
  /// A member of the value.
  const T* operator->() const { return &std::get<0>(state_); }
  /// The value.
  T& operator*() & { return std::get<0>(state_); }
  /// The value.
  const T& operator*() const& { return std::get<0>(state_); }
  /// The reason.
  const Error& error() const { return std::get<1>(state_); }

 private:
  std::variant<T, Error> state_;
};

/// Success, or the reason for failure.
template <>
class [[nodiscard]] Result<void> {
 public:
  Result() = default;
  /// The reason why it was not done.
  Result(Error error) : error_(std::move(error)) {}  // NOLINT(google-explicit-constructor)
  /// Whether it was done.
  explicit operator bool() const { return !error_.has_value(); }
  /// The reason; only where there is one.
  const Error& error() const { return *error_; }

 private:
  std::optional<Error> error_;
};

}  // namespace palpate
