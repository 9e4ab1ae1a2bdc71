#pragma once
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "model/import_program.h"
#include "model/mesh.h"
#include "model/result.h"

namespace palpate {

/// What import met and did, for `info`.
struct ImportReport {
  std::string file;
  std::vector<std::string> notes;   ///< "dropped 12 line primitives", "split 3 polygons as fans", …
};

/// What reading one mesh file may cost. 0: by the file's size, see import_limits.
struct ImportLimits {
  std::uint64_t memory_bytes = 0;   ///< of address space
  double seconds = 0;               ///< of processor time; four times as much by the clock
};

/// `asked`, with the usual limits in place of zeros: 2 GiB and 20 bytes for each byte of the file (200 of a 3MF, which is packed), 20 s
/// and 1 s for each MiB. Measured: docs/IMPORT.md.
ImportLimits import_limits(const std::string& path, const ImportLimits& asked);

/// Reads any format assimp knows (STL, OBJ, PLY, OFF, glTF/GLB, DAE, 3MF, …), flattened depth-first with node
/// transforms applied and coordinates multiplied by `scale` (metres per file unit).
///
/// Mesh files are strangers' and the library that reads them is large, so a process of its own does it (the program palpate-import):
/// whatever happens there is an error here, and nothing stays running. It is asked often whether to `go_on`; false ends it.
/// Errors (kBadValue): missing file, unreadable, no triangle, a coordinate that is not finite, truncated; the importer crashed, or
/// wanted more memory or time than its limits. kInternal: palpate-import is missing or can't be started; ended by `go_on`.
Result<Mesh> import_mesh(const std::string& path, double scale, ImportReport& report, const ImportLimits& limits = {},
                         const std::function<bool()>& go_on = {});

/// The triangles of the node named `part` (a full path, or a name that is unique) and all nodes below it.
Result<Mesh> take_part(const Mesh& mesh, const std::string& part, const std::string& file);

/// All but the named nodes and what is below them.
Result<Mesh> without_parts(const Mesh& mesh, const std::vector<std::string>& parts, const std::string& file);

}  // namespace palpate
