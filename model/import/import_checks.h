#pragma once
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace palpate {

// What the importer behind us would swallow in silence, or choke on: counts that the file can't hold, a file
// cut short, nodes that contain themselves. Each returns what is wrong, as the rest of a sentence that begins
// with the file's name ("is cut short: …"), or nothing. None allocates by what the file claims. Not checked:
// what is told apart later (indices, finite coordinates) and other formats.

constexpr char kBlankOfName =
    '\x1F';  ///< in a name, for a blank, at which the library behind us would end it

bool is_stl_text(std::string_view bytes);  ///< as distrust_stl() takes it
std::string distrust_stl(std::string_view bytes);
std::string distrust_off(std::string_view bytes);
std::string distrust_ply(std::string_view bytes);
std::string distrust_gltf(std::string_view bytes, const std::string& path);  ///< .gltf and .glb
std::string distrust_dae(std::string_view bytes);
std::string distrust_obj(std::string_view bytes);

/// How many triangles the meshes must have that the importer makes of a glTF, by the name that it gives them:
/// of those that the scene's nodes name, all of one name together. Names of which that can't be told are
/// missing. For a file that distrust_gltf() has nothing against.
std::map<std::string, std::uint64_t> faces_of_gltf(std::string_view bytes);

}  // namespace palpate
