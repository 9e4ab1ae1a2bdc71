#pragma once
#include <string>
#include <string_view>

#include "model/result.h"

namespace palpate {

/// A file's bytes, mapped for reading; unmapped at the end of its life.
class FileView {
 public:
  /// Error (kBadValue): missing, a directory, unreadable or empty.
  static Result<FileView> open(const std::string& path);
  FileView(FileView&& other) noexcept;
  FileView& operator=(FileView&& other) noexcept;
  FileView(const FileView&) = delete;
  FileView& operator=(const FileView&) = delete;
  ~FileView();

  std::string_view bytes() const { return {data_, size_}; }

 private:
  FileView(const char* data, std::size_t size) : data_(data), size_(size) {}
  const char* data_ = nullptr;
  std::size_t size_ = 0;
};

}  // namespace palpate
