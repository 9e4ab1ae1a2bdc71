#pragma once
#include <string>

#include "model/mesh/mesh_import.h"

namespace palpate {

/// read_mesh() of a 3MF file, through lib3mf: all that its build names, objects of components and of other
/// models in the package (production extension) included. In metres, for a 3MF states its unit; `scale` is a
/// factor on that. Adds to `report`. Errors (kBadValue): no 3MF, broken, no triangle, a coordinate out of
/// bounds.
Result<Mesh> read_3mf(const std::string& path, double scale, ImportReport& report);

}  // namespace palpate
