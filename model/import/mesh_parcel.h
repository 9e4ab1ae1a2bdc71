#pragma once
#include <cstddef>
#include <cstdint>
#include <string>

#include "model/mesh/mesh_import.h"

namespace palpate {

/// How palpate-import hands back what it read: a file in memory, in this machine's own byte order, written
/// once and read when the writer is gone.
///
///   header    magic, error code (0: a mesh), counts of vertices, triangles, parts, notes, bytes of text
///   vertices  3 doubles each
///   triangles 3 uint32 each
///   parts     5 uint32 each: first triangle, count, bytes of its path and of its other name,
///             colour (0x1000000: none)
///   notes     1 uint32 each: bytes
///   text      the parts' paths and other names, then the notes; or the error's sentence
///
/// The header is written last, so that a parcel that was not finished has none. Until then its place says how
/// far the importer is.

/// What an importer does, one after the other; a mesh file is only read.
enum class ImportStage : std::uint8_t { kRead, kShapes, kTriangles };
inline constexpr std::size_t kImportStages = 3;

struct HowFar {
  ImportStage stage = ImportStage::kRead;
  double done = 0;  ///< of the stage, in [0, 1]
};

/// The importer's side: 8 bytes in place of the header.
void tell_how_far(int file, const HowFar& far);

/// What it has told last; whatever stands there, it is a stage and in [0, 1]. The beginning where it has told
/// nothing.
HowFar how_far(int file);

/// Largest parcel in bytes that a sound importer makes.
inline constexpr unsigned long long kLargestParcel = 4ull << 30;

/// Writes to the descriptor, which is at its beginning. False: it could not be written.
bool write_parcel(int file, const Result<Mesh>& mesh, const ImportReport& report);

/// Reads what an importer that may have gone mad has left: every count is held against the file's size before
/// anything is allocated, every index, coordinate and name is checked. Error kInternal: not a sound parcel.
/// The writer's own error comes back as it was.
Result<Mesh> read_parcel(int file, ImportReport& report);

}  // namespace palpate
