#pragma once
#include <filesystem>
#include <optional>
#include <string_view>

#include "service/server/http/problem.h"

namespace palpate {

/// A folder of files of a client's that goes when nobody has taken it.
class SpoolFolder {
 public:
  explicit SpoolFolder(std::filesystem::path path);
  ~SpoolFolder();
  SpoolFolder(const SpoolFolder&) = delete;
  SpoolFolder& operator=(const SpoolFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }
  /// It stays from here on; who takes it removes it.
  std::filesystem::path take();
  /// Removes it now.
  void drop();

 private:
  std::filesystem::path path_;
};

/// A new file being written; never over one that is there, nor through a symbolic link.
class SpoolFile {
 public:
  SpoolFile() = default;
  ~SpoolFile();
  SpoolFile(const SpoolFile&) = delete;
  SpoolFile& operator=(const SpoolFile&) = delete;
  bool open(const std::filesystem::path& path);
  bool write(std::string_view bytes);
  bool close();
  bool is_open() const { return descriptor_ >= 0; }

 private:
  int descriptor_ = -1;
};

/// 507 with errno's reason; `what`: "written", "opened".
Problem storage_problem(const char* what);

/// A whole new file.
std::optional<Problem> write_new_file(const std::filesystem::path& path, std::string_view text);

}  // namespace palpate
