#pragma once
#include <string>
#include <string_view>

namespace palpate {

// What the importer behind us would swallow in silence, or choke on: counts that the file can't hold, a file cut short,
// nodes that contain themselves. Each returns what is wrong, as the rest of a sentence that begins with the file's
// name ("is cut short: …"), or nothing. None allocates by what the file claims. Not checked: what is told apart later (indices, finite
// coordinates) and other formats.

std::string distrust_stl(std::string_view bytes);
std::string distrust_off(std::string_view bytes);
std::string distrust_ply(std::string_view bytes);
std::string distrust_gltf(std::string_view bytes, const std::string& path);   ///< .gltf and .glb
std::string distrust_dae(std::string_view bytes);

}  // namespace palpate
