#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "model/scene/scene.h"

namespace palpate {

/// What `palpate generate NAME` can make: "contacts" (chapter 4.1) and "disassembly" (chapter 4.2).
struct GeneratedScene {
  Mesh mockup;  ///< world frame, m
  Mesh tool;    ///< tool frame, m
  std::vector<PathPoint> path;
  std::vector<GuidePoint> guide;  ///< empty for free motion
  std::vector<std::string> stage_names;
  std::array<bool, 6> actuated{};
};

/// `triangles` and `tool_triangles` are met within 2 %, each 1,000 to 10,000,000 (0: the chapter's counts).
/// Deterministic: the same bytes on every machine. Errors: unknown name, count out of range.
Result<GeneratedScene> generate_scene(const std::string& name, std::uint64_t triangles,
                                      std::uint64_t tool_triangles);

/// What generate_scene() takes as a name.
std::vector<std::string> generator_names();

/// Binary STL of a mesh, in metres. Errors: the file can't be written.
Result<void> write_stl(const std::filesystem::path& file, const Mesh& mesh);

/// Writes mock-up and tool (binary STL or PLY), path, guide and scene.json to `directory`, which is made if
/// missing.
Result<void> write_generated(const GeneratedScene& scene, const std::string& name,
                             const std::string& directory);

}  // namespace palpate
