#include "compute/gpu/prepare/search_tables.h"

#include <cstring>
#include <utility>

#include "compute/scene/brick_bits.h"
#include "compute/scene/occupied_cubes.h"
#include "compute/scene/search_tables.h"
#include "compute/scene/triangle_tree.h"
#include "shaders/shared/frame.h"
#include "shaders/shared/scene.h"

namespace palpate {

std::vector<std::uint32_t> occupied_words(const PartitionView& mockup) {
  constexpr std::size_t kLevelWords = 5;  // of lib/broad_phase/occupied.glsl
  std::vector<BrickBits> levels(1);
  levels.front().make(mockup, BrickBits::Of::kOccupied);
  const auto one_brick = [](const BrickBits& bits) { return bits.size() == Int3(1); };
  while (!one_brick(levels.back())) levels.push_back(levels.back().coarser());

  std::vector<std::uint32_t> words(1 + kLevelWords * levels.size());
  words[0] = static_cast<std::uint32_t>(levels.size());
  for (std::size_t level = 0; level < levels.size(); ++level) {
    OccupiedCubes cubes;
    cubes.make(levels[level]);
    const std::size_t head = 1 + kLevelWords * level;
    for (std::size_t k = 0; k < 3; ++k)
      words[head + k] = static_cast<std::uint32_t>(levels[level].size()[static_cast<int>(k)]);
    words[head + 3] = static_cast<std::uint32_t>(words.size());
    words.insert(words.end(), cubes.places().begin(), cubes.places().end());
    words[head + 4] = static_cast<std::uint32_t>(words.size());
    for (const OccupiedCubes::Cubes& place : cubes.cubes())
      for (const BrickBits::Block& size : place)
        for (const std::uint64_t plane : size) {
          words.push_back(static_cast<std::uint32_t>(plane));
          words.push_back(static_cast<std::uint32_t>(plane >> 32));
        }
  }
  return words;
}

std::vector<std::uint32_t> tree_words(const LatticeMesh& mesh, const std::function<bool()>& go_on) {
  using namespace gpu;
  static_assert(sizeof(TriangleTree::Boxes) == 4 * kTreeGroupWords);
  const TriangleTree tree = TriangleTree::make(mesh, go_on, TriangleTree::kNotSolid, false);
  std::vector<std::uint32_t> words(kTreeHeaderWords + kTreeGroupWords * tree.boxes.size());
  words[kTreeTriangles] = static_cast<std::uint32_t>(tree.order.size());
  words[kTreeLevels] = static_cast<std::uint32_t>(tree.level_begin.size());
  words[kTreeOrder] = static_cast<std::uint32_t>(words.size());
  for (std::uint32_t level = 0; level < tree.level_begin.size(); ++level) {
    words[kTreeBegin + level] = kTreeHeaderWords + kTreeGroupWords * tree.level_begin[level];
    words[kTreeNodes + level] = tree.nodes(level);
  }
  if (!tree.boxes.empty())
    std::memcpy(words.data() + kTreeHeaderWords, tree.boxes.data(), sizeof tree.boxes[0] * tree.boxes.size());
  words.insert(words.end(), tree.order.begin(), tree.order.end());
  return words;
}

std::vector<std::uint32_t> list_boxes(const LatticeMesh& mesh, const PartitionView& mockup) {
  constexpr std::uint32_t kBits = 5, kShift = 3;  // of 256 parts to 32
  static_assert(kVoxelParts >> kShift == gpu::kListParts && gpu::kListParts == 1 << kBits);
  const std::vector<std::uint8_t> boxes = SearchTables::boxes_of(mesh, mockup);
  std::vector<std::uint32_t> words(mockup.grid.list_entries);
  for (std::uint32_t voxel = 0; voxel < mockup.grid.boundary_voxels; ++voxel) {
    const std::size_t begin = mockup.list_begin[voxel], count = mockup.list_begin[voxel + 1] - begin;
    for (std::size_t i = 0; i < count; ++i)
      for (std::uint32_t k = 0; k < 6; ++k)
        words[begin + i] |= std::uint32_t{boxes[6 * begin + k * count + i]} >> kShift << kBits * k;
  }
  return words;
}

}  // namespace palpate
