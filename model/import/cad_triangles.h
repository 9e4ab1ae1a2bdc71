#pragma once
#include <string>
#include <vector>

#include "model/import/cad_bodies.h"
#include "model/import/mesh_read.h"

namespace palpate {

/// What lengths of a CAD file are in.
struct FileUnit {
  double metres;     ///< per unit of the shapes
  const char* name;  ///< of what they come in, for sentences: "m", or "file units" where nobody says which
};

/// Triangles of the bodies' faces, a part a body, metres. `file` is for sentences; what became of the faces
/// goes to `report`. Errors: kBadValue, no faces, or more triangles or larger coordinates than a mesh may
/// have.
Result<Mesh> triangles_of(const std::vector<Body>& bodies, const std::string& file, const FileUnit& unit,
                          const Tessellation& tessellation, ImportReport& report, const TellHowFar& tell);

}  // namespace palpate
