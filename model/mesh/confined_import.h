#pragma once
#include <functional>
#include <string>

#include "model/mesh/mesh_import.h"

namespace palpate {

/// import_mesh (model/mesh/mesh_import.h) of a stranger's file: other files that it names in turn (a glTF's
/// buffers, an OBJ's materials) are opened only below `folder`, a real path, with all symbolic links
/// followed. An empty folder: anywhere.
Result<Mesh> import_mesh_below(const std::string& folder, const std::string& path, double scale,
                               ImportReport& report, const ImportLimits& limits = {},
                               const ImportProgress& progress = {}, const Tessellation& tessellation = {});

}  // namespace palpate
