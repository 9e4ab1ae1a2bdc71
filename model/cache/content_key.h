#pragma once
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace palpate {

/// 128 bits that stand for some content (XXH3: fast and even, not made against an adversary; the cache's
/// folder is its owner's alone).
struct ContentKey {
  std::uint64_t high = 0, low = 0;
  bool operator==(const ContentKey&) const = default;
  std::string hex() const;  ///< 32 digits
};

/// Values without padding, whose bytes are their content.
template <class T>
concept PlainValue = std::is_trivially_copyable_v<T> && !std::is_pointer_v<T>;

/// Works out the key of content that is given piece by piece. Every list is preceded by its length, so that
/// no two contents read alike.
class KeyBuilder {
 public:
  KeyBuilder();
  ~KeyBuilder();
  KeyBuilder(const KeyBuilder&) = delete;
  KeyBuilder& operator=(const KeyBuilder&) = delete;

  /// `size` bytes from `data`, as they are.
  void bytes(const void* data, std::size_t size);
  /// `T` must have no padding: its bytes are hashed.
  template <PlainValue T>
  void value(const T& v) {
    static_assert(std::has_unique_object_representations_v<T> || std::is_floating_point_v<T>,
                  "padding would be hashed");
    bytes(&v, sizeof v);
  }
  /// Its length, then its bytes.
  void text(std::string_view s) {
    value(s.size());
    bytes(s.data(), s.size());
  }
  /// Its length, then its elements.
  template <PlainValue T>
  void list(const std::vector<T>& v) {
    value(v.size());
    bytes(v.data(), v.size() * sizeof(T));
  }
  /// The whole content of a file. False: it can't be read.
  [[nodiscard]] bool file(const std::string& path);

  /// The key of all that was given so far.
  ContentKey finish() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Key of the running program, or of the shared library that this code is in: what another build has worked
/// out may mean something else. Zero where it can't be read.
const ContentKey& program_key();

}  // namespace palpate
