#pragma once
#include <string>

namespace palpate {

/// Whether files can be written to a folder that may have to be made: the sentence why not, else empty. For a check before long work; nothing is made.
std::string cannot_write_to(const std::string& folder);

}  // namespace palpate
