#include "service/cli/export_geometry.h"

#include <fmt/format.h>

#include <bit>
#include <cstdint>
#include <filesystem>

#include "service/cli/text_output.h"

namespace palpate {
namespace {

static_assert(std::endian::native == std::endian::little, "the exported files are little-endian");

/// Numbers as they stand in a file.
template <class Number>
std::string_view bytes_of(const std::vector<Number>& numbers) {
  return {reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(Number)};
}

/// Nine integers a triangle, in the order of their ids; a collapsed one keeps its place.
template <class ToWorld>
Result<void> write_triangles(const std::filesystem::path& path, const LatticeMesh& mesh,
                             const ToWorld& to_world) {
  std::vector<std::int32_t> words;
  words.reserve(mesh.triangles.size() * 9);
  for (std::uint32_t triangle = 0; triangle < mesh.triangles.size(); ++triangle)
    for (int k = 0; k < 3; ++k) {
      const Int3 corner = to_world(mesh.corner(triangle, k));
      words.insert(words.end(), {corner.x, corner.y, corner.z});
    }
  return write_text(path, bytes_of(words));
}

}  // namespace

Result<void> export_geometry(const std::string& directory, const SceneGeometry& geometry,
                             const CollisionBackend& backend, const std::vector<Pose>& poses,
                             std::vector<std::string>& notes) {
  const std::filesystem::path root = directory;
  std::error_code error;
  std::filesystem::create_directories(root, error);
  if (error)
    return bad_value(fmt::format("{}: the directory can't be made ({})", directory, error.message()));

  const auto gone = [&](const std::string& name) {
    std::error_code ignored;
    return std::filesystem::remove(root / name, ignored);
  };
  for (std::size_t i = 0;;
       ++i) {  // a pose beyond the lattice has no corners, one that was interrupted no pairs
    const bool corners = gone(fmt::format("tool_{}.i32", i)), pairs = gone(fmt::format("pairs_{}.u32", i));
    if (!corners && !pairs) break;
  }

  const Lattice& lattice = geometry.lattice;
  if (auto done = write_text(root / "lattice.json",
                             fmt::format("{{\"step_m\":{},\"origin_m\":[{},{},{}]}}\n", lattice.step_m,
                                         lattice.origin_m.x, lattice.origin_m.y, lattice.origin_m.z));
      !done)
    return done;
  if (auto done = write_triangles(root / "static.i32", geometry.mockup, [](const Int3& v) { return v; });
      !done)
    return done;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const Result<LatticePose> pose = to_lattice(poses[i], geometry);
    if (!pose) return pose.error();
    if (pose->beyond_lattice) {
      notes.push_back(fmt::format("pose {} is beyond the lattice and free of contact: no tool_{}.i32", i, i));
      continue;
    }
    const auto path = root / fmt::format("tool_{}.i32", i);
    auto done = write_triangles(path, geometry.tool, [&](const Int3& v) { return transform(*pose, v); });
    if (!done) return done;
  }

  const Result<VoxelPartition> partition = backend.partition(false);
  if (!partition) return partition.error();
  const VoxelGrid& grid = partition->grid;
  const Int3 counts = grid.voxels();
  if (auto done =
          write_text(root / "voxels.json",
                     fmt::format("{{\"size\":{},\"origin\":[{},{},{}],\"counts\":[{},{},{}]}}\n", grid.size,
                                 grid.origin.x, grid.origin.y, grid.origin.z, counts.x, counts.y, counts.z));
      !done)
    return done;
  static_assert(sizeof(VoxelClass) == 1);
  return write_text(root / "voxels.u8", bytes_of(partition->classes));
}

Result<void> export_pairs(const std::string& directory, const CollisionBackend& backend, std::size_t pose) {
  const auto pairs = backend.pairs();
  if (!pairs) return pairs.error();
  std::vector<std::uint32_t> words;
  words.reserve(2 * pairs->size());
  for (const auto& [static_id, mobile_id] : *pairs) words.insert(words.end(), {static_id, mobile_id});
  return write_text(std::filesystem::path(directory) / fmt::format("pairs_{}.u32", pose), bytes_of(words));
}

}  // namespace palpate
