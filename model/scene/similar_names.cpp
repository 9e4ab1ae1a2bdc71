#include "model/scene/similar_names.h"

#include <algorithm>
#include <cctype>
#include <numeric>

namespace palpate {
namespace {

/// Letters to add, drop or change (Levenshtein); case counts nothing.
std::size_t edits(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const auto lower = [](char c) { return std::tolower(static_cast<unsigned char>(c)); };
      const std::size_t change = diagonal + (lower(a[i]) == lower(b[j]) ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({change, row[j] + 1, row[j + 1] + 1});
    }
  }
  return row.back();
}

}  // namespace

std::string similar_names(const std::string& name, const std::vector<std::string>& names) {
  constexpr std::size_t kLongest = 256;  // a longer name is no slip of the pen, and edits() is quadratic
  std::vector<std::pair<std::size_t, std::string>> near;
  for (const std::string& other : names) {
    if (name.size() > kLongest || other.size() > kLongest) continue;
    const std::size_t count = edits(name, other);
    if (2 * count <= std::max(name.size(), other.size())) near.emplace_back(count, other);
  }
  std::sort(near.begin(), near.end());
  near.erase(std::unique(near.begin(), near.end()), near.end());
  near.resize(std::min<std::size_t>(near.size(), 3));
  if (near.empty()) return {};
  std::string out = "; did you mean ";
  for (std::size_t i = 0; i < near.size(); ++i)
    out += (i == 0 ? "'" : i + 1 == near.size() ? " or '" : ", '") + near[i].second + "'";
  return out + "?";
}

}  // namespace palpate
