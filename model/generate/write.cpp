#include <bit>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <glm/geometric.hpp>
#include <string_view>
#include <system_error>

#include "model/files/path_file.h"
#include "model/generate.h"

namespace palpate {
namespace {

static_assert(std::endian::native == std::endian::little,
              "binary STL is little-endian, and written as it stands in memory");

Result<void> write_file(const std::filesystem::path& path, std::string_view bytes) {
  std::ofstream out(path, std::ios::binary | std::ios::trunc);
  out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  out.close();
  if (!out) return bad_value(path.string() + " cannot be written");
  return {};
}

/// Binary STL: 80 bytes, a count, then for each triangle a normal and three corners in single precision and
/// two zero bytes. Corners equal in double stay equal, so the body stays closed.
std::string stl_bytes(const Mesh& mesh) {
  const auto count = static_cast<std::uint32_t>(mesh.triangles.size());
  std::string out(84 + 50 * mesh.triangles.size(), '\0');
  constexpr std::string_view kTitle = "palpate, metres";  // not "solid", which means a text file
  std::memcpy(out.data(), kTitle.data(), kTitle.size());
  std::memcpy(out.data() + 80, &count, 4);
  char* at = out.data() + 84;
  for (const auto& [i, j, k] : mesh.triangles) {
    const Vec3 &a = mesh.vertices[i], &b = mesh.vertices[j], &c = mesh.vertices[k];
    Vec3 normal = glm::cross(b - a, c - a);
    const double length = glm::length(normal);
    if (length > 0) normal /= length;
    float values[12];
    float* value = values;
    for (const Vec3& v : {normal, a, b, c})
      for (int axis = 0; axis < 3; ++axis) *value++ = static_cast<float>(v[axis]);
    std::memcpy(at, values, sizeof values);
    at += 50;
  }
  return out;
}

std::string scene_text(const GeneratedScene& scene, const std::string& name) {
  constexpr std::string_view kAxes[] = {"fx", "fy", "fz", "tx", "ty", "tz"};
  std::string actuated, stages;
  for (std::size_t i = 0; i < 6; ++i)
    if (scene.actuated[i]) actuated += (actuated.empty() ? "\"" : ", \"") + std::string(kAxes[i]) + "\"";
  for (const std::string& stage : scene.stage_names)
    stages += (stages.empty() ? "\"" : ", \"") + stage + "\"";
  return "{\n"
         "  \"description\": \"Made by palpate generate " +
         name +
         "\",\n"
         "  \"static\": [{\"mesh\": \"mockup.stl\", \"units\": \"m\"}],\n"
         "  \"tool\": {\"mesh\": \"tool.stl\", \"units\": \"m\"},\n"
         "  \"device\": {\n"
         "    \"driver\": \"simulated\",\n"
         "    \"path\": \"path.csv\",\n" +
         (scene.guide.empty() ? "" : "    \"guide\": \"guide.csv\",\n") + "    \"actuated\": [" + actuated +
         "],\n"
         "    \"stages\": [" +
         stages +
         "]\n"
         "  }\n"
         "}\n";
}

}  // namespace

Result<void> write_stl(const std::filesystem::path& file, const Mesh& mesh) {
  return write_file(file, stl_bytes(mesh));
}

Result<void> write_generated(const GeneratedScene& scene, const std::string& name,
                             const std::string& directory) {
  const std::filesystem::path folder(directory);
  std::error_code fault;
  std::filesystem::create_directories(folder, fault);
  if (!std::filesystem::is_directory(folder, fault))
    return bad_value(directory + " is no directory and cannot be made one");
  if (auto done = write_stl(folder / "mockup.stl", scene.mockup); !done) return done;
  if (auto done = write_stl(folder / "tool.stl", scene.tool); !done) return done;
  if (auto done = write_file(folder / "path.csv", path_text(scene.path, !scene.guide.empty())); !done)
    return done;
  if (!scene.guide.empty())
    if (auto done = write_file(folder / "guide.csv", guide_text(scene.guide)); !done) return done;
  return write_file(folder / "scene.json", scene_text(scene, name));
}

}  // namespace palpate
