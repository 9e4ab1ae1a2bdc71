#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <utility>
#include <vector>

/// What `palpate query --export-geometry` wrote, read by a program that shares no line with palpate. Lattice
/// steps throughout.
namespace second_opinion {

using Point = std::array<std::int32_t, 3>;
using Triangle = std::array<Point, 3>;
using Pairs = std::vector<std::pair<std::uint32_t, std::uint32_t>>;  ///< static, mobile; ascending

enum VoxelClass : std::uint8_t { kExternal = 0, kBoundary = 1, kInternal = 2 };

struct Voxels {
  std::int32_t size = 0;
  Point origin{};
  std::array<std::size_t, 3> counts{};
  std::vector<std::uint8_t> classes;  ///< x fastest
};

/// Static triangles by id; throws std::runtime_error with one sentence when a file is missing or of the wrong
/// length.
std::vector<Triangle> read_triangles(const std::filesystem::path& path);
Pairs read_pairs(const std::filesystem::path& path);
Voxels read_voxels(const std::filesystem::path& directory);

}  // namespace second_opinion
