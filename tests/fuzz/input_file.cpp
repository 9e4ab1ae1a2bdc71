#include "tests/fuzz/input_file.h"

#include <sys/mman.h>
#include <unistd.h>

#include <cstdlib>

namespace palpate {

InputFile::InputFile()
    : file_(::memfd_create("fuzz input", MFD_CLOEXEC)), path_("/proc/self/fd/" + std::to_string(file_)) {
  if (file_ < 0) std::abort();
}

InputFile::~InputFile() { ::close(file_); }

void InputFile::write(const std::uint8_t* data, std::size_t size) {
  if (::ftruncate(file_, 0) != 0 || ::pwrite(file_, data, size, 0) != static_cast<ssize_t>(size) ||
      ::lseek(file_, 0, SEEK_SET) != 0)
    std::abort();
}

}  // namespace palpate
