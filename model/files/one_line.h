#pragma once
#include <string>

namespace palpate {

/// The text as one line that no terminal obeys: control characters become '?'. For sentences that quote
/// strangers' files and names.
inline std::string one_line(std::string text) {
  for (char& c : text)
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = '?';
  return text;
}

}  // namespace palpate
