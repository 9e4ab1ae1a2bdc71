#pragma once
#include <functional>
#include <string>

#include "model/import/mesh_parcel.h"
#include "model/mesh/mesh_import.h"

namespace palpate {

/// Told how far reading is.
using TellHowFar = std::function<void(const HowFar& far)>;

/// import_mesh (model/mesh/mesh_import.h) within this process: what palpate-import and palpate-import-cad do
/// with a file. A file can make the library behind it crash, hang or take all memory, so nothing but those
/// programs and the fuzz targets calls this. `folder`: see model/mesh/confined_import.h. `colours`: whether
/// to read them, too; a file can be damaged there alone. palpate-import and palpate-import-cad each have
/// their own.
Result<Mesh> read_mesh(const std::string& path, double scale, ImportReport& report,
                       const std::string& folder = {}, const Tessellation& tessellation = {},
                       const TellHowFar& tell = {}, bool colours = true);

}  // namespace palpate
