#pragma once
#include <string>

#include "model/mesh/mesh_import.h"

namespace palpate {

/// How palpate-import and palpate-import-cad are called: FILE SCALE MEMORY_BYTES SECONDS FOLDER ASKER
/// DEFLECTION_M ANGLE_DEG PART COLOURS (0 or 1), the parcel on this descriptor, standard error a pipe.
inline constexpr int kParcelDescriptor = 3;
/// The exit code by which palpate-import says that an allocation failed.
inline constexpr int kOutOfMemoryExit = 12;

/// What became of it.
struct ChildEnd {
  enum How { kDone, kOutOfMemory, kOutOfTime, kCrashed, kExited, kStopped } how = kDone;
  int detail = 0;          ///< signal of a crash, exit code
  std::string last_words;  ///< the last line on its standard error; printable
};

/// Runs `program` on a file until it ends, its limits do, or `progress` says no; it and what it started are
/// gone afterwards. Its parcel is then in the file `parcel`, and how far it is before
/// (model/import/mesh_parcel.h). Starts it by posix_spawn: other threads (a Vulkan driver's) may exist. No
/// descriptor is inherited but its own four. `folder`: see model/mesh/confined_import.h; `colours`: see
/// model/import/mesh_read.h. Error kInternal: it can't be started.
Result<ChildEnd> run_import_child(const std::string& program, const std::string& path, double scale,
                                  const ImportLimits& limits, int parcel, const ImportProgress& progress,
                                  const std::string& folder = {}, const Tessellation& tessellation = {},
                                  bool colours = true);

}  // namespace palpate
