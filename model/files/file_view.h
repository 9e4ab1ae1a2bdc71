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
  /// `other` is left without a file.
  FileView(FileView&& other) noexcept;
  /// `other` is left without a file.
  FileView& operator=(FileView&& other) noexcept;
  FileView(const FileView&) = delete;
  FileView& operator=(const FileView&) = delete;
  ~FileView();

  /// The whole file; valid as long as the view.
  std::string_view bytes() const { return {data_, size_}; }

 private:
  FileView(const char* data, std::size_t size) : data_(data), size_(size) {}
  const char* data_ = nullptr;
  std::size_t size_ = 0;
};

}  // namespace palpate
