#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

namespace palpate {

/// SHA-256, piece by piece. Not for passwords.
class ContentHash {
 public:
  ContentHash();
  ~ContentHash();
  void add(std::string_view bytes);
  std::string hex();  ///< 64 digits; ends the hash

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// SHA-256 of a file's content; empty when it can't be read to the end.
std::string file_hash(const std::string& path);

/// Whether two secrets are equal, in a time that tells nothing of where they differ or how long the right one
/// is.
bool same_secret(std::string_view given, std::string_view right);

}  // namespace palpate
