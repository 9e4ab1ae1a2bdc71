#include "service/cli/text_output.h"

#include <cstdio>
#include <fstream>

namespace palpate {

Result<void> write_text(const std::filesystem::path& path, std::string_view text) {
  std::ofstream out(path, std::ios::binary | std::ios::trunc);
  out.write(text.data(), static_cast<std::streamsize>(text.size()));
  out.flush();
  if (!out) return bad_value(path.string() + ": the file can't be written");
  return {};
}

Result<void> print_text(std::string_view text) {
  if (std::fwrite(text.data(), 1, text.size(), stdout) == text.size() && std::fflush(stdout) == 0) return {};
  return Error{ErrorCode::kInternal, "standard output can't be written"};
}

}  // namespace palpate
