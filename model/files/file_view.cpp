#include "model/files/file_view.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <new>
#include <utility>

namespace palpate {

Result<FileView> FileView::open(const std::string& path) {
  const int file =
      ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);  // O_NONBLOCK: a pipe must not block us
  if (file < 0) return bad_value(fmt::format("'{}' can't be opened: {}", path, std::strerror(errno)));
  struct stat status {};
  const bool known = ::fstat(file, &status) == 0;
  if (!known || !S_ISREG(status.st_mode) || status.st_size == 0) {
    ::close(file);
    return bad_value(
        fmt::format("'{}' is {}", path, known && S_ISREG(status.st_mode) ? "empty" : "not a file"));
  }
  const auto size = static_cast<std::size_t>(status.st_size);
  void* data = ::mmap(nullptr, size, PROT_READ, MAP_PRIVATE, file, 0);
  const int failed = errno;
  ::close(file);
  if (data == MAP_FAILED && failed == ENOMEM)  // who has set a limit hears of it, as where `new` finds none
    if (const std::new_handler told = std::get_new_handler()) told();
  if (data == MAP_FAILED)
    return bad_value(fmt::format("'{}' can't be read: {}", path, std::strerror(failed)));
  return FileView(static_cast<const char*>(data), size);
}

FileView::FileView(FileView&& other) noexcept
    : data_(std::exchange(other.data_, nullptr)), size_(std::exchange(other.size_, 0)) {}

FileView& FileView::operator=(FileView&& other) noexcept {
  std::swap(data_, other.data_);
  std::swap(size_, other.size_);
  return *this;
}

FileView::~FileView() {
  if (data_) ::munmap(const_cast<char*>(data_), size_);
}

}  // namespace palpate
