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
  for (; !error && !fs::exists(fs::symlink_status(place, error)) && place.has_relative_path(); place = place.parent_path()) error.clear();
  if (!fs::is_directory(place, error)) return fmt::format("{}: '{}' is no folder", folder, place.string());
  if (::access(place.c_str(), W_OK | X_OK) != 0) return fmt::format("{}: nothing can be written to '{}' ({})", folder, place.string(), std::strerror(errno));
  return {};
}

}  // namespace palpate
