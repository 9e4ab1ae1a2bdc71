#include "service/cli/output_folder.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>

namespace palpate {

std::string cannot_write_to(const std::string& folder) {
  namespace fs = std::filesystem;
  if (folder.empty()) return "the name of a folder is empty";
  std::error_code error;
  fs::path place = fs::absolute(folder, error);
  // Up to what is there already.
  for (; !error && !fs::exists(fs::symlink_status(place, error)) && place.has_relative_path();
       place = place.parent_path())
    error.clear();
  if (!fs::is_directory(place, error)) return fmt::format("{}: '{}' is no folder", folder, place.string());
  if (::access(place.c_str(), W_OK | X_OK) != 0)
    return fmt::format("{}: nothing can be written to '{}' ({})", folder, place.string(),
                       std::strerror(errno));
  return {};
}

Result<void> check_output_folder(const std::string& folder, std::span<const char* const> files,
                                 const char* whose, bool overwrite, const char* option) {
  if (const std::string wrong = cannot_write_to(folder); !wrong.empty())
    return bad_value(fmt::format("{} {}", option, wrong));
  if (overwrite) return {};
  std::error_code ignored;
  for (const char* file : files)
    if (std::filesystem::exists(std::filesystem::path(folder) / file, ignored))
      return bad_value(
          fmt::format("{} {}: {} files are there already ({}); name another folder, or say --overwrite",
                      option, folder, whose, file));
  return {};
}

}  // namespace palpate
