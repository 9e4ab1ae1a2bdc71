#include "compute/gpu/prepare/search_tables.h"

#include <algorithm>
#include <cstring>
#include <initializer_list>
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
  constexpr std::size_t kTexel = 4;  // words
  static_assert(sizeof(TriangleTree::Boxes) == 4 * kTexel * kTreeGroupTexels);
  const TriangleTree tree = TriangleTree::make(mesh, go_on, TriangleTree::kNotSolid, false);
  const std::size_t triangles = tree.order.size(),
                    order = kTreeHeadTexels + kTreeGroupTexels * tree.boxes.size(),
                    records = order + (triangles + kTexel - 1) / kTexel;
  std::vector<std::uint32_t> words(kTexel * (records + kTreeRecordTexels * triangles));
  const auto set = [&](std::size_t texel, std::initializer_list<std::size_t> what) {
    std::transform(what.begin(), what.end(), words.begin() + static_cast<std::ptrdiff_t>(kTexel * texel),
                   [](std::size_t word) { return static_cast<std::uint32_t>(word); });
  };
  set(0, {triangles, tree.level_begin.size(), order, records});
  for (std::uint32_t level = 0; level < tree.level_begin.size(); ++level)
    set(kTreeLevel + level,
        {kTreeHeadTexels + kTreeGroupTexels * tree.level_begin[level], tree.nodes(level)});
  if (!tree.boxes.empty())
    std::memcpy(words.data() + kTexel * kTreeHeadTexels, tree.boxes.data(),
                sizeof tree.boxes[0] * tree.boxes.size());
  std::copy(tree.order.begin(), tree.order.end(),
            words.begin() + static_cast<std::ptrdiff_t>(kTexel * order));
  auto to = words.begin() + static_cast<std::ptrdiff_t>(kTexel * records);
  for (const std::uint32_t id : tree.order)
    for (int corner = 0; corner < 3; ++corner) {
      for (int k = 0; k < 3; ++k) *to++ = static_cast<std::uint32_t>(mesh.corner(id, corner)[k]);
      *to++ = static_cast<std::uint32_t>(mesh.unit_normal_q30[id][corner]);
    }
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
