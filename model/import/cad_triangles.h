#pragma once
#include <string>
#include <vector>

#include "model/import/cad_bodies.h"
#include "model/import/mesh_read.h"

namespace palpate {

/// Triangles of the bodies' faces, a part a body, metres. `file` is for sentences, `unit_m` metres per unit
/// of the shapes; what became of the faces goes to `report`. Errors: kBadValue, no faces, or more triangles
/// or larger coordinates than a mesh may have.
Result<Mesh> triangles_of(const std::vector<Body>& bodies, const std::string& file, double unit_m,
                          const Tessellation& tessellation, ImportReport& report, const TellHowFar& tell);

}  // namespace palpate
