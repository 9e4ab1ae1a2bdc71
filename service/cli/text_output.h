#pragma once
#include <filesystem>
#include <string_view>

#include "model/result.h"

namespace palpate {

/// Makes or replaces a file of these bytes. Error: kBadValue, it can't be written whole.
Result<void> write_text(const std::filesystem::path& path, std::string_view text);

/// To standard output. Error: kInternal, it can't be written.
Result<void> print_text(std::string_view text);

}  // namespace palpate
