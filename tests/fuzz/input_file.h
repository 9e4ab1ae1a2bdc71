#pragma once
#include <cstddef>
#include <cstdint>
#include <string>

namespace palpate {

/// Gives a parser that reads files one input after the other: a file in memory, with a path of its own.
class InputFile {
 public:
  InputFile();
  ~InputFile();
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;

  /// Replaces the content; the file is read from its beginning by whoever opens path().
  void write(const std::uint8_t* data, std::size_t size);
  const std::string& path() const { return path_; }
  int descriptor() const { return file_; }

 private:
  int file_;
  std::string path_;  ///< /proc/self/fd/N
};

}  // namespace palpate
