#include "model/mesh/mesh_import.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstring>
#include <filesystem>

#include "model/files/one_line.h"
#include "model/files/own_file.h"
#include "model/import/import_child.h"
#include "model/import/mesh_parcel.h"
#include "model/mesh/confined_import.h"

namespace palpate {
namespace {

namespace fs = std::filesystem;

std::string& told() {
  static std::string path;
  return path;
}

std::string ending_of(const std::string& path) {
  std::string out = fs::path(path).extension().string();
  std::transform(out.begin(), out.end(), out.begin(),
                 [](char c) { return static_cast<char>(std::tolower(static_cast<unsigned char>(c))); });
  return out;
}

template <std::size_t n>
bool is_one_of(const std::string& word, const std::array<const char*, n>& words) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

/// Beside the running program or the shared library that this is (a wheel), in ../bin (the build tree), in
/// libexec/palpate of the prefix (installed, the bundle; a library may lie in lib/x86_64-linux-gnu), or where
/// we were told.
Result<std::string> find_import_program(const std::string& path) {
  const bool cad = is_cad_file(path);
  const std::string name = cad ? "palpate-import-cad" : "palpate-import";
  std::error_code ignored;
  const fs::path here = fs::path(own_file()).parent_path(), above = here.parent_path();
  const fs::path places[] = {here / name, above / "bin" / name, above / "libexec" / "palpate" / name,
                             above.parent_path() / "libexec" / "palpate" / name,
                             told().empty() ? fs::path() : fs::path(told()).replace_filename(name)};
  std::string looked;
  for (const fs::path& place : places) {
    if (place.empty()) continue;
    if (::access(place.c_str(), X_OK) == 0 && fs::is_regular_file(place, ignored)) return place.string();
    looked += (looked.empty() ? "" : ", ") + place.string();
  }
  if (cad)
    return bad_value(
        fmt::format("'{}' can't be read: the program palpate-import-cad, which reads STEP, IGES and BREP "
                    "files, is missing (looked for {}); "
                    "it is built where OpenCASCADE is installed (Debian: libocct-data-exchange-dev)",
                    path, looked));
  return Error{
      ErrorCode::kInternal,
      fmt::format("the program palpate-import, which reads mesh files, is missing (looked for {})", looked)};
}

/// A file in memory, clear of the low descriptors that the child gets.
class MemoryFile {
 public:
  MemoryFile() {
    const int made = ::memfd_create("palpate mesh", MFD_CLOEXEC);
    descriptor_ = made < 0 ? -1 : ::fcntl(made, F_DUPFD_CLOEXEC, 10);
    if (made >= 0) ::close(made);
  }
  ~MemoryFile() {
    if (descriptor_ >= 0) ::close(descriptor_);
  }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;
  int descriptor() const { return descriptor_; }

 private:
  int descriptor_ = -1;
};

std::string words_of(const ChildEnd& end) {
  return end.last_words.empty() ? "" : fmt::format(" (\"{}\")", end.last_words);
}

std::string signal_name(int number) {
  const char* name = ::sigabbrev_np(number);  // glibc: "SEGV"
  return name ? name : std::to_string(number);
}

Error refusal(const std::string& path, const ChildEnd& end, const ImportLimits& limits) {
  switch (end.how) {
    case ChildEnd::kOutOfMemory:
      return bad_value(fmt::format(
          "'{}' can't be read: its import wants more than the {} MiB of memory allowed (--import-memory)",
          path, limits.memory_bytes >> 20));
    case ChildEnd::kOutOfTime:
      return bad_value(fmt::format(
          "'{}' can't be read: its import takes more than the {:.0f} s allowed (--import-seconds)", path,
          limits.seconds));
    case ChildEnd::kStopped:
      return {ErrorCode::kInternal, fmt::format("the import of '{}' was cancelled", path)};
    case ChildEnd::kCrashed:
      return bad_value(fmt::format("'{}' can't be read: its import crashed (SIG{}){}", path,
                                   signal_name(end.detail), words_of(end)));
    default:
      return bad_value(fmt::format("'{}' can't be read: its import ended with code {}{}", path, end.detail,
                                   words_of(end)));
  }
}

}  // namespace

void set_import_program(std::string path) { told() = std::move(path); }
const std::string& told_import_program() { return told(); }

bool is_cad_file(const std::string& path) {
  return is_one_of(ending_of(path), std::array{".step", ".stp", ".iges", ".igs", ".brep", ".brp"});
}

bool states_unit(const std::string& path) {
  return is_one_of(ending_of(path), std::array{".step", ".stp", ".iges", ".igs", ".3mf"});
}

bool comes_in_metres(const std::string& path) {
  return states_unit(path) || is_one_of(ending_of(path), std::array{".dae", ".gltf", ".glb"});
}

ImportLimits import_limits(const std::string& path, const ImportLimits& asked) {
  struct stat status {};
  const auto bytes = ::stat(path.c_str(), &status) == 0 ? static_cast<std::uint64_t>(status.st_size) : 0;
  const bool cad = is_cad_file(path);
  ImportLimits limits = asked;
  if (limits.memory_bytes == 0) limits.memory_bytes = (std::uint64_t{2} << 30) + (cad ? 100 : 20) * bytes;
  if (!(limits.seconds > 0))
    limits.seconds = (cad ? 60 : 20) + (cad ? 10 : 1) * static_cast<double>(bytes >> 20);
  return limits;
}

Result<Mesh> import_mesh(const std::string& path, double scale, ImportReport& report,
                         const ImportLimits& asked, const ImportProgress& progress,
                         const Tessellation& tessellation) {
  return import_mesh_below({}, path, scale, report, asked, progress, tessellation);
}

Result<Mesh> import_mesh_below(const std::string& folder, const std::string& path, double scale,
                               ImportReport& report, const ImportLimits& asked,
                               const ImportProgress& progress, const Tessellation& tessellation) {
  report = {path, {}};
  if (!std::isfinite(scale) || !(scale > 0))
    return bad_value(fmt::format("the scale of '{}' is {}, it must be a number above 0", path, scale));
  const Result<std::string> program = find_import_program(path);
  if (!program) return program.error();
  const ImportLimits limits = import_limits(path, asked);
  const ImportProgress onward =
      !progress ? progress : [&progress, most = 0.0](const char* what, double done) mutable {
        return progress(what, most = std::max(most, done));  // a second reading begins anew
      };
  // OpenCASCADE may crash over damaged colours, which nothing needs: then the file is read once more without
  // them.
  for (bool colours = true;; colours = false) {
    const MemoryFile parcel;
    if (parcel.descriptor() < 0)
      return Error{ErrorCode::kInternal,
                   fmt::format("no memory file for the import of '{}': {}", path, std::strerror(errno))};
    const Result<ChildEnd> end = run_import_child(*program, path, scale, limits, parcel.descriptor(), onward,
                                                  folder, tessellation, colours);
    if (!end) return end.error();
    const bool crashed = end->how == ChildEnd::kCrashed ||
                         end->how == ChildEnd::kExited;  // under a sanitizer a crash ends with a code
    if (crashed && colours && is_cad_file(path)) continue;
    if (end->how != ChildEnd::kDone) return refusal(one_line(path), *end, limits);
    Result<Mesh> mesh = read_parcel(parcel.descriptor(), report);
    if (!mesh && mesh.error().code == ErrorCode::kInternal)
      return bad_value(fmt::format("'{}' can't be read: {}", path, mesh.error().sentence));
    if (!colours) report.notes.emplace_back("its colours are damaged and left out");
    return mesh;
  }
}

}  // namespace palpate
