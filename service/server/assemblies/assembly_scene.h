#pragma once
#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <variant>

#include "service/server/assemblies/assembly_store.h"

namespace palpate {

/// Writes a scene of an assembly's files into the new folder `folder`: scene.json, path.csv if `path` is not
/// empty, the mesh files that the scene names, and the company of those. `linked`: by hard links where the
/// file system has them, for a folder that nobody edits. The answer: bytes on disk. What was written before a
/// problem stays, for the caller to remove. 400: the scene names a file that is none of the assembly's, or is
/// none that read_scene() takes.
std::variant<std::uint64_t, Problem> write_assembly_scene(const Assembly& assembly,
                                                          const nlohmann::json& scene,
                                                          const std::string& path,
                                                          const std::filesystem::path& folder, bool linked);

}  // namespace palpate
