#include "model/import/part_names.h"

#include <fmt/format.h>

#include <algorithm>

namespace palpate {

std::string clean_name(std::string name) {
  std::replace_if(
      name.begin(), name.end(),
      [](char c) { return c == '/' || static_cast<unsigned char>(c) < 0x20 || c == 0x7f; }, '_');
  return name;
}

std::string SiblingNames::unique(const std::string& name) {
  std::string out = name;
  for (int& n = used_[name]; ++n > 1 && used_.count(out = fmt::format("{}#{}", name, n)) != 0;) {
  }
  if (out != name) used_[out] = 1;
  return out;
}

}  // namespace palpate
