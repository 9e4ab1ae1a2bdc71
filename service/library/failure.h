#pragma once
#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstring>
#include <exception>
#include <new>
#include <string>

#include "model/result.h"
#include "service/library/palpate.h"

struct palpate_error {
  std::int32_t code = PALPATE_INTERNAL;
  std::string sentence;
};

namespace palpate::library {

/// Hands an error to the caller, who may not want it, and gives its code.
std::int32_t fail(std::int32_t code, const std::string& sentence, palpate_error** out) noexcept;

inline Error wrong_call(std::string sentence) { return {ErrorCode::kUsage, std::move(sentence)}; }

/// A caller's struct as this version knows it: members beyond its `size` are zero. What a newer caller has
/// beyond must be zero, or it would wait for an answer in vain. Error: kUsage.
template <class Sized>
Result<Sized> taken(const Sized* given, const char* name) {
  Sized out{};
  if (!given) return out;
  const std::size_t size = given->size;
  if (size < sizeof size || size > 64 * sizeof out)
    return wrong_call(std::string(name) + " has the size " + std::to_string(size) +
                      "; it must be sizeof of the struct");
  const auto* const bytes = reinterpret_cast<const unsigned char*>(given);
  if (std::any_of(bytes + std::min(size, sizeof out), bytes + size, [](unsigned char b) { return b != 0; }))
    return wrong_call(std::string(name) + " has members that version " PALPATE_VERSION " does not know");
  std::memcpy(&out, given, std::min(size, sizeof out));
  return out;
}

/// A caller's watch, looked at.
class Watch {
 public:
  explicit Watch(const palpate_watch* watch) {
    const Result<palpate_watch> known = taken(watch, "palpate_watch");
    if (known)
      watch_ = *known;
    else
      wrong_ = known.error().sentence;
  }

  /// Error: it is no watch.
  Result<void> usable() const {
    if (wrong_.empty()) return {};
    return wrong_call(wrong_);
  }

  /// By any thread.
  bool cancelled() const {
    return stopped_.load(std::memory_order_relaxed) ||
           (watch_.cancel && __atomic_load_n(watch_.cancel, __ATOMIC_RELAXED) != 0);
  }
  /// By the calling thread alone. False: stop.
  bool tell(const char* what, double done) {
    try {
      if (watch_.progress && watch_.progress(watch_.context, what, done) != 0) stopped_ = true;
    } catch (...) {  // a caller in C++: nothing of it may pass through threads of ours
      stopped_ = true;
    }
    return !cancelled();
  }
  void note(const std::string& sentence) {
    try {
      if (watch_.note) watch_.note(watch_.context, sentence.c_str());
    } catch (...) {
      stopped_ = true;
    }
  }

 private:
  palpate_watch watch_{};
  std::string wrong_;
  std::atomic<bool> stopped_{false};
};

/// Runs a function of the interface: what it returns or throws becomes a code and an error. `watch`, where
/// there is one, tells a failure from a wish.
template <class Body>
std::int32_t guarded(palpate_error** out, const Watch* watch, Body body) noexcept {
  if (out) *out = nullptr;
  try {
    const Result<void> done = body();
    if (done) return PALPATE_OK;
    if (watch && watch->cancelled()) return fail(PALPATE_CANCELLED, "cancelled by the caller", out);
    return fail(static_cast<std::int32_t>(done.error().code), done.error().sentence, out);
  } catch (const std::bad_alloc&) {
    return fail(PALPATE_INTERNAL, "there was no memory left", out);
  } catch (const std::exception& thrown) {
    return fail(PALPATE_INTERNAL, thrown.what(), out);
  } catch (...) {
    return fail(PALPATE_INTERNAL, "something unknown was thrown", out);
  }
}

}  // namespace palpate::library
