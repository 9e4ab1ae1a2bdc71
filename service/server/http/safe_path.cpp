#include "service/server/http/safe_path.h"

#include <algorithm>

namespace palpate {

namespace fs = std::filesystem;

std::optional<fs::path> path_below(const fs::path& root, const fs::path& name) {
  std::error_code error;
  const fs::path real = fs::canonical(
      root / name, error);  // an absolute name takes the root's place, and is judged like any other
  if (error) return std::nullopt;
  const auto [end, ignored] = std::mismatch(root.begin(), root.end(), real.begin(), real.end());
  if (end != root.end()) return std::nullopt;
  return real;
}

std::string without_folder(std::string sentence, const fs::path& folder) {
  const std::string prefix = folder.string() + "/";
  for (auto at = sentence.find(prefix); at != std::string::npos; at = sentence.find(prefix, at))
    sentence.erase(at, prefix.size());
  return sentence;
}

bool plain_name(std::string_view name) {
  if (name.empty() || name.size() > 100 || name.front() == '.') return false;
  return std::all_of(name.begin(), name.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '.' ||
           c == '_' || c == '-';
  });
}

}  // namespace palpate
