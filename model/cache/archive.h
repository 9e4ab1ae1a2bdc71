#pragma once
#include <cstring>
#include <deque>
#include <string>
#include <string_view>
#include <vector>

#include "model/cache/content_key.h"

namespace palpate {

inline constexpr std::size_t kListAlignment =
    8;  ///< bytes from the row's begin to a list's first entry are a multiple of it

/// Writes values and lists as a row of bytes. One function `template <class Archive> void archive(Archive& a,
/// …)` that calls a(x) for each member serves both this and ArchiveReader, so that they can't fall out of
/// step. Lists are not copied: they must outlive the archive.
class ArchiveWriter {
 public:
  template <PlainValue T>
  void operator()(const T& v) {
    owned(&v, sizeof v);
  }
  void operator()(const std::string& s) {
    (*this)(s.size());
    owned(s.data(), s.size());
  }
  template <PlainValue T>
  void operator()(const std::vector<T>& v) {
    (*this)(v.size());
    static constexpr char kZeros[kListAlignment]{};
    borrow({kZeros, (kListAlignment - bytes_ % kListAlignment) % kListAlignment});
    borrow({reinterpret_cast<const char*>(v.data()), v.size() * sizeof(T)});
  }
  template <class T, class Each>
  void each(const std::vector<T>& v, Each each_of) {
    (*this)(v.size());
    for (const T& item : v) each_of(*this, item);
  }
  void borrow(std::string_view bytes) {
    pieces_.push_back(bytes);
    bytes_ += bytes.size();
  }
  const std::vector<std::string_view>& pieces() const { return pieces_; }

 private:
  void owned(const void* data, std::size_t size) {
    small_.emplace_back(static_cast<const char*>(data), size);
    borrow(small_.back());
  }
  std::deque<std::string> small_;  // a deque: what pieces_ points to stays where it is
  std::vector<std::string_view> pieces_;
  std::size_t bytes_ = 0;  // of all of them
};

/// Reads such a row back. What lies beyond the end reads as zero or empty, and ok() is false from then on.
class ArchiveReader {
 public:
  explicit ArchiveReader(std::string_view bytes) : bytes_(bytes.size()), rest_(bytes) {}

  template <PlainValue T>
  void operator()(T& v) {
    if (const std::string_view piece = take(sizeof v); !piece.empty())
      std::memcpy(&v, piece.data(), sizeof v);
  }
  void operator()(std::string& s) { s = take(size(1)); }
  template <PlainValue T>
  void operator()(std::vector<T>& v) {
    std::size_t n = size(sizeof(T));
    take((kListAlignment - (bytes_ - rest_.size()) % kListAlignment) % kListAlignment);
    const std::string_view piece = take(n * sizeof(T));
    if (piece.empty()) n = 0;
    // Where entries lie as in a list of T they are copied without first being made 0.
    const auto* entries = reinterpret_cast<const T*>(piece.data());
    if (reinterpret_cast<std::uintptr_t>(entries) % alignof(T) == 0) {
      v.assign(entries, entries + n);
    } else {
      v.resize(n);
      std::memcpy(v.data(), piece.data(), piece.size());
    }
  }
  template <class T, class Each>
  void each(std::vector<T>& v, Each each_of) {
    v.resize(size(1));
    for (T& item : v) each_of(*this, item);
  }
  /// The next `bytes` bytes, where they lie.
  std::string_view take(std::size_t bytes) {
    if (bytes > rest_.size()) {
      ok_ = false;
      rest_ = {};
      return {};
    }
    const std::string_view piece = rest_.substr(0, bytes);
    rest_.remove_prefix(bytes);
    return piece;
  }
  /// Whether all was there and nothing is left.
  bool complete() const { return ok_ && rest_.empty(); }

 private:
  /// A list's length; 0 when what is left can't hold so many entries of at least `entry` bytes.
  std::size_t size(std::size_t entry) {
    std::size_t n = 0;
    (*this)(n);
    if (n <= rest_.size() / entry) return n;
    ok_ = false;
    return 0;
  }
  std::size_t bytes_ = 0;  // of the whole row
  std::string_view rest_;
  bool ok_ = true;
};

}  // namespace palpate
