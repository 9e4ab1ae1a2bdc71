#pragma once
#include <string>
#include <vector>

#include "model/mesh.h"
#include "model/result.h"

namespace palpate {

/// What import met and did, for `info`.
struct ImportReport {
  std::string file;
  std::vector<std::string> notes;   ///< "dropped 12 line primitives", "split 3 polygons as fans", …
};

/// Reads any format assimp knows (STL, OBJ, PLY, OFF, glTF/GLB, DAE, 3MF, …), flattened depth-first with node
/// transforms applied and coordinates multiplied by `scale` (metres per file unit).
/// Errors (kBadValue): missing file, unreadable, no triangle, a coordinate that is not finite, truncated.
Result<Mesh> import_mesh(const std::string& path, double scale, ImportReport& report);

/// The triangles of the node named `part` (a full path, or a name that is unique) and all nodes below it.
Result<Mesh> take_part(const Mesh& mesh, const std::string& part, const std::string& file);

/// All but the named nodes and what is below them.
Result<Mesh> without_parts(const Mesh& mesh, const std::vector<std::string>& parts, const std::string& file);

}  // namespace palpate
