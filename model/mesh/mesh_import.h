#pragma once
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "model/mesh/import_program.h"
#include "model/mesh/mesh.h"
#include "model/result.h"

namespace palpate {

/// What import met and did, for `info`.
struct ImportReport {
  std::string file;
  std::vector<std::string> notes;  ///< "dropped 12 line primitives", "split 3 polygons as fans", …
};

/// What reading one mesh file may cost. 0: by the file's size, see import_limits.
struct ImportLimits {
  std::uint64_t memory_bytes = 0;  ///< of address space
  double seconds = 0;              ///< of processor time; four times as much by the clock
};

/// `asked`, with the usual limits in place of zeros: 2 GiB and 20 bytes for each byte of the file (100 of a
/// CAD file), 20 s and 1 s for each MiB (60 s and 10 s for a CAD file, whose triangles are made). Measured:
/// docs/IMPORT.md.
ImportLimits import_limits(const std::string& path, const ImportLimits& asked);

/// Asked often while a file is read: what is done now, and how much of the import has been, in [0, 1] and
/// never less than before. False ends it.
using ImportProgress = std::function<bool(const char* what, double done)>;

/// How the curved surfaces of a CAD file (STEP, IGES, BREP) become triangles; mesh files don't ask.
struct Tessellation {
  double deflection_m = 0;  ///< the farthest that a triangle may lie from its surface, after `scale`; 0: a
                            ///< kDeflectionsPerSide-th of the longest side of `part`
  double angle_deg = 15;    ///< most between neighbouring triangles of a surface (chosen: half of the usual
                            ///< smooth angle, so that a cylinder stays one zone)
  std::string part = {};    ///< what a deflection of 0 is measured by; empty: all that the file has
  bool operator==(const Tessellation&) const = default;
};

/// 4 to a sample's spacing of a tool with `auto` samples, 4 of which are a voxel, 24 of which are its longest
/// side.
inline constexpr double kDeflectionsPerSide = 4 * 4 * 24;

/// Whether a file is for the program palpate-import-cad, by its ending: STEP, IGES, BREP.
bool is_cad_file(const std::string& path);

/// Whether a file's coordinates come in metres, for it states its unit: STEP, IGES, 3MF.
bool states_unit(const std::string& path);

/// Whether they come in metres, because the file states its unit or its format has one (COLLADA, glTF), which
/// exporters don't always keep to.
bool comes_in_metres(const std::string& path);

/// Reads any format assimp knows (STL, OBJ, PLY, OFF, glTF/GLB, DAE, 3MF, …), and STEP, IGES and BREP where
/// the build has OpenCASCADE, flattened depth-first with node transforms applied and coordinates multiplied
/// by `scale` (metres per file unit; of STEP, IGES and 3MF, which come in metres, a mere factor).
///
/// Mesh files are strangers' and the libraries that read them are large, so a process of its own does it (the
/// programs palpate-import and palpate-import-cad): whatever happens there is an error here, and nothing
/// stays running. `progress` may end it. Errors (kBadValue): missing file, unreadable, no triangle, a
/// coordinate that is not finite, truncated; the importer crashed, or wanted more memory or time than its
/// limits; a CAD file, and palpate-import-cad is missing. kInternal: palpate-import is missing or can't be
/// started; ended by `progress`.
Result<Mesh> import_mesh(const std::string& path, double scale, ImportReport& report,
                         const ImportLimits& limits = {}, const ImportProgress& progress = {},
                         const Tessellation& tessellation = {});

/// The path of the node that `name` names: a full path, the last name of one path alone, the other name
/// (MeshPart::also) of one part alone, or a part's number as `info` prints it, "#3". Error kBadValue: none or
/// several; the sentence has the nearest names, and `file`.
Result<std::string> find_node(const std::vector<MeshPart>& parts, const std::string& name,
                              const std::string& file);

/// Whether a path is `node` or below it.
bool is_below(const std::string& path, const std::string& node);

/// The triangles of the node that `part` names (find_node) and all nodes below it.
Result<Mesh> take_part(const Mesh& mesh, const std::string& part, const std::string& file);

/// All but the named nodes and what is below them.
Result<Mesh> without_parts(const Mesh& mesh, const std::vector<std::string>& parts, const std::string& file);

}  // namespace palpate
