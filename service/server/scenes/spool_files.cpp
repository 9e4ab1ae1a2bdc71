#include "service/server/scenes/spool_files.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

namespace palpate {

namespace fs = std::filesystem;

SpoolFolder::SpoolFolder(fs::path path) : path_(std::move(path)) {}
SpoolFolder::~SpoolFolder() { drop(); }
fs::path SpoolFolder::take() { return std::exchange(path_, {}); }
void SpoolFolder::drop() {
  std::error_code ignored;
  if (!path_.empty()) fs::remove_all(take(), ignored);
}

SpoolFile::~SpoolFile() { close(); }

bool SpoolFile::open(const fs::path& path) {
  close();
  descriptor_ = ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW, 0600);
  return descriptor_ >= 0;
}

bool SpoolFile::write(std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t done = ::write(descriptor_, bytes.data(), bytes.size());
    if (done < 0 && errno == EINTR) continue;
    if (done <= 0) return false;
    bytes.remove_prefix(static_cast<std::size_t>(done));
  }
  return true;
}

bool SpoolFile::close() {
  const int descriptor = std::exchange(descriptor_, -1);
  return descriptor < 0 || ::close(descriptor) == 0;
}

Problem storage_problem(const char* what) {
  const int why = errno;
  return {507, "storage", std::string("the upload can't be ") + what + ": " + std::strerror(why), ""};
}

std::optional<Problem> write_new_file(const fs::path& path, std::string_view text) {
  SpoolFile file;
  if (!file.open(path) || !file.write(text) || !file.close()) return storage_problem("written");
  return std::nullopt;
}

}  // namespace palpate
