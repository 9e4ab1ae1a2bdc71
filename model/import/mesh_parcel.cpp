#include "model/import/mesh_parcel.h"

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <span>

#include "model/files/one_line.h"
#include "model/lattice/lattice_build.h"
#include "model/mesh/weld.h"

namespace palpate {
namespace {

constexpr std::array<char, 8> kMagic{'p', 'a', 'l', 'p', 'm', 's', 'h', '3'};
constexpr std::uint64_t kMostText = 1u << 28, kMostNotes = 1000;
constexpr std::uint32_t kNoColour = 1u << 24;

struct Header {
  std::array<char, 8> magic = kMagic;
  std::uint64_t error = 0, vertices = 0, triangles = 0, parts = 0, notes = 0, text = 0;
};
struct PartEntry {
  std::uint32_t first = 0, count = 0, path_bytes = 0, also_bytes = 0, colour = kNoColour;
};
constexpr double kMillionths = 1e6;
struct StepEntry {
  std::array<char, 3> mark{'f', 'a', 'r'};
  std::uint8_t stage = 0;
  std::uint32_t millionths = 0;
};
static_assert(sizeof(StepEntry) == 8 && sizeof(StepEntry) <= sizeof(Header));
static_assert(sizeof(Header) == 56 && sizeof(PartEntry) == 20 && sizeof(Vec3) == 24);

/// Moves all bytes at an offset that goes on; pread and pwrite may stop half-way.
template <class Call, class Byte>
bool move_all(Call call, int file, std::span<Byte> bytes, off_t& at) {
  while (!bytes.empty()) {
    const ssize_t moved = call(file, bytes.data(), bytes.size(), at);
    if (moved < 0 && errno == EINTR) continue;
    if (moved <= 0) return false;
    at += moved;
    bytes = bytes.subspan(static_cast<std::size_t>(moved));
  }
  return true;
}

template <class T>
bool put(int file, const std::vector<T>& values, off_t& at) {
  return move_all(::pwrite, file, std::as_bytes(std::span(values)), at);
}

template <class T>
bool take(int file, std::vector<T>& values, std::size_t count, off_t& at) {
  values.resize(count);
  return move_all(::pread, file, std::as_writable_bytes(std::span(values)), at);
}

Error unsound(const char* what) {
  return {ErrorCode::kInternal, std::string("the importer's answer is unsound: ") + what};
}

bool is_one_line(std::string_view text) {
  return std::none_of(text.begin(), text.end(),
                      [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; });
}

/// Cuts the next piece off the text; false if there is less, or it would break a line.
bool take_text(std::string_view& text, std::uint32_t size, std::string& out) {
  if (size > text.size() || !is_one_line(text.substr(0, size))) return false;
  out = text.substr(0, size);
  text.remove_prefix(size);
  return true;
}

/// Reads and checks the header, and that the file has exactly the bytes that its counts take.
Result<Header> read_header(int file) {
  Header header;
  off_t at = 0;
  struct stat status {};
  if (::fstat(file, &status) != 0 ||
      !move_all(::pread, file, std::as_writable_bytes(std::span(&header, 1)), at) || header.magic != kMagic)
    return unsound("it has no header");
  if (header.vertices > 3 * kMaxTriangles || header.triangles > kMaxTriangles ||
      header.parts > header.triangles || header.notes > kMostNotes || header.text > kMostText)
    return unsound("it counts more than there can be");
  const std::uint64_t size = sizeof(Header) + header.vertices * sizeof(Vec3) + header.triangles * 12 +
                             header.parts * sizeof(PartEntry) + header.notes * 4 + header.text;
  if (static_cast<std::uint64_t>(status.st_size) != size)
    return unsound("it has another size than its counts take");
  return header;
}

/// What the importer promises of a mesh (model/mesh/mesh.h), which nobody behind it checks again.
const char* wrong_with(const Mesh& mesh) {
  if (mesh.triangles.empty()) return "it has no triangle";
  for (const Vec3& point : mesh.vertices)
    for (int k = 0; k < 3; ++k)
      if (!(std::abs(point[k]) <= kLargestCoordinate)) return "a coordinate is out of bounds";
  for (const auto& triangle : mesh.triangles)
    for (const std::uint32_t vertex : triangle)
      if (vertex >= mesh.vertices.size()) return "a triangle has a vertex that does not exist";
  std::size_t next = 0;
  for (const MeshPart& part : mesh.parts) {
    if (part.first_triangle != next || part.triangle_count > mesh.triangles.size() - next)
      return "its parts don't follow each other";
    next += part.triangle_count;
  }
  return next == mesh.triangles.size() ? nullptr : "its parts don't cover it";
}

}  // namespace

void tell_how_far(int file, const HowFar& far) {
  StepEntry entry;
  entry.stage = static_cast<std::uint8_t>(far.stage);
  entry.millionths = static_cast<std::uint32_t>(kMillionths * std::clamp(far.done, 0.0, 1.0));
  off_t start = 0;
  move_all(::pwrite, file, std::as_bytes(std::span(&entry, 1)), start);
}

HowFar how_far(int file) {
  StepEntry entry;
  off_t start = 0;
  if (!move_all(::pread, file, std::as_writable_bytes(std::span(&entry, 1)), start) ||
      entry.mark != StepEntry{}.mark)
    return {};
  return {static_cast<ImportStage>(std::min<std::size_t>(entry.stage, kImportStages - 1)),
          std::min(entry.millionths / kMillionths, 1.0)};
}

bool write_parcel(int file, const Result<Mesh>& result, const ImportReport& report) {
  Header header;
  std::string text;
  std::vector<PartEntry> parts;
  std::vector<std::uint32_t> notes;
  const Mesh none, &mesh = result ? *result : none;
  if (!result) {
    header.error = static_cast<std::uint64_t>(result.error().code);
    text = one_line(result.error().sentence);
  }
  for (const MeshPart& part : mesh.parts) {
    parts.push_back({part.first_triangle, part.triangle_count, static_cast<std::uint32_t>(part.path.size()),
                     static_cast<std::uint32_t>(part.also.size()), part.colour.value_or(kNoColour)});
    text += part.path + part.also;
  }
  if (result)
    for (const std::string& note : report.notes) {
      notes.push_back(static_cast<std::uint32_t>(note.size()));
      text += note;
    }
  header.vertices = mesh.vertices.size(), header.triangles = mesh.triangles.size(),
  header.parts = parts.size();
  header.notes = notes.size(), header.text = text.size();
  off_t at = sizeof header, start = 0;
  return put(file, mesh.vertices, at) && put(file, mesh.triangles, at) && put(file, parts, at) &&
         put(file, notes, at) && move_all(::pwrite, file, std::as_bytes(std::span(text)), at) &&
         move_all(::pwrite, file, std::as_bytes(std::span(&header, 1)), start);
}

Result<Mesh> read_parcel(int file, ImportReport& report) {
  const Result<Header> header = read_header(file);
  if (!header) return header.error();
  Mesh mesh;
  std::vector<PartEntry> parts;
  std::vector<std::uint32_t> notes;
  std::vector<char> characters;
  off_t at = sizeof(Header);
  if (!take(file, mesh.vertices, header->vertices, at) ||
      !take(file, mesh.triangles, header->triangles, at) || !take(file, parts, header->parts, at) ||
      !take(file, notes, header->notes, at) || !take(file, characters, header->text, at))
    return unsound("it can't be read");
  std::string_view text(characters.data(), characters.size());
  if (header->error != 0) {
    if (header->error > static_cast<std::uint64_t>(ErrorCode::kNoDevice) || text.empty() ||
        !is_one_line(text))
      return unsound("its error is none");
    return Error{static_cast<ErrorCode>(header->error), std::string(text)};
  }
  for (const PartEntry& entry : parts) {
    MeshPart& part = mesh.parts.emplace_back(MeshPart{{}, entry.first, entry.count, {}});
    if (!take_text(text, entry.path_bytes, part.path) || !take_text(text, entry.also_bytes, part.also))
      return unsound("a part has no sound path");
    if (entry.colour > kNoColour) return unsound("a part has no sound colour");
    if (entry.colour != kNoColour) part.colour = entry.colour;
  }
  for (const std::uint32_t size : notes)
    if (!take_text(text, size, report.notes.emplace_back())) return unsound("a note is not one line");
  if (!text.empty()) return unsound("it has text left over");
  if (const char* wrong = wrong_with(mesh)) return unsound(wrong);
  return mesh;
}

}  // namespace palpate
