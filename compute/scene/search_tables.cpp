#include "compute/scene/search_tables.h"

#include <algorithm>
#include <bit>
#include <numeric>
#include <utility>

#include "compute/scene/exact.h"
#include "compute/scene/shares.h"
#include "shaders/shared/frame.h"

namespace palpate {
namespace {

constexpr std::uint32_t kBricksAShare = 64;  // chosen: milliseconds

using Box = std::array<std::int32_t, 6>;

/// Boxes of what the voxels of a mixed brick list. A product's rounding is far less than the steps by which a
/// tool triangle's box is grown.
void make_boxes(const LatticeMesh& mesh, const PartitionView& lists, std::uint32_t slot,
                std::vector<std::uint8_t>& boxes) {
  const gpu::GridConstants& grid = lists.grid;
  const double per_part = static_cast<double>(kVoxelParts) / grid.size;
  const auto part = [&](std::int32_t at) {
    return static_cast<std::uint8_t>(std::clamp(at, 0, grid.size - 1) * per_part);
  };
  const Int3 brick = brick_at(grid.bricks, lists.mixed_brick[slot]);
  const gpu::Brick& voxels = lists.bricks[slot];
  for (std::uint32_t word = 0; word < 16; ++word) {
    std::uint32_t boundary = voxels.first[word];
    for (std::uint32_t rest = voxels.boundary[word]; rest != 0; rest &= rest - 1, ++boundary) {
      const auto bit = static_cast<std::int32_t>(word << 5) + std::countr_zero(rest);
      const Int3 low = grid.origin + grid.size * (8 * brick + Int3(bit & 7, bit >> 3 & 7, bit >> 6));
      const std::size_t begin = lists.list_begin[boundary], count = lists.list_begin[boundary + 1] - begin;
      for (std::size_t i = 0; i < count; ++i) {
        const std::uint32_t id = lists.list_triangles[begin + i];
        const exact::Box box = exact::box_of({mesh.corner(id, 0), mesh.corner(id, 1), mesh.corner(id, 2)});
        for (std::size_t k = 0; k < 3; ++k) {
          const int axis = static_cast<int>(k);
          boxes[6 * begin + k * count + i] = part(box.low[axis] - low[axis]);
          boxes[6 * begin + (k + 3) * count + i] = part(box.high[axis] - low[axis]);
        }
      }
    }
  }
}

/// A part that meets no triangle of a closed tool lies wholly on one side of it.
std::vector<Box> find_parts(const LatticeMesh& mockup, std::int32_t tool_radius) {
  constexpr std::uint32_t kUnused = UINT32_MAX;  // by no triangle that counts
  std::vector<std::uint32_t> parent(mockup.vertices.size(), kUnused);
  const auto root = [&](std::uint32_t v) {
    if (parent[v] == kUnused) parent[v] = v;
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
  };
  for (std::uint32_t t = 0; t < mockup.triangles.size(); ++t) {
    if (mockup.collapsed(t)) continue;
    const std::uint32_t first = root(mockup.triangles[t][0]);
    for (std::size_t k = 1; k < 3; ++k) parent[root(mockup.triangles[t][k])] = first;
  }
  std::vector<Box> parts;
  std::vector<std::uint32_t> number(mockup.vertices.size(), kUnused);  // of a root's part
  for (std::uint32_t v = 0; v < mockup.vertices.size(); ++v) {
    if (parent[v] == kUnused) continue;
    std::uint32_t& part = number[root(v)];
    if (part == kUnused) {
      part = static_cast<std::uint32_t>(parts.size());
      parts.push_back({INT32_MAX, INT32_MAX, INT32_MAX, INT32_MIN, INT32_MIN, INT32_MIN});
    }
    Box& box = parts[part];
    for (std::size_t k = 0; k < 3; ++k) {
      const std::int32_t at = mockup.vertices[v][static_cast<int>(k)];
      box[k] = std::min(box[k], at);
      box[k + 3] = std::max(box[k + 3], at);
    }
  }
  const std::int64_t most = 2 * std::int64_t{tool_radius} + 2 * gpu::kCloseSteps;
  std::erase_if(parts, [&](const Box& box) {
    return std::int64_t{box[3]} - box[0] > most || std::int64_t{box[4]} - box[1] > most ||
           std::int64_t{box[5]} - box[2] > most;
  });
  parts.shrink_to_fit();
  return parts;
}

}  // namespace

std::vector<std::uint8_t> SearchTables::boxes_of(const LatticeMesh& mesh, const PartitionView& partition) {
  std::vector<std::uint8_t> boxes(6 * std::size_t{partition.grid.list_entries} + kBoxesAtOnce);
  for (std::uint32_t slot = 0; slot < partition.grid.mixed_bricks; ++slot)
    make_boxes(mesh, partition, slot, boxes);
  return boxes;
}

std::shared_ptr<const SearchTables> SearchTables::make(const SceneGeometry& geometry,
                                                       const PartitionView& mockup,
                                                       const std::function<bool()>& go_on) {
  auto out = std::make_shared<SearchTables>();
  out->boxes.resize(6 * std::size_t{mockup.grid.list_entries} + kBoxesAtOnce);
  const std::uint32_t bricks = mockup.grid.mixed_bricks,
                      shares = (bricks + kBricksAShare - 1) / kBricksAShare;
  // The parts are one share, and the longest: the first.
  const bool done = in_shares(
      shares + 1,
      [&](std::uint32_t share) {
        if (share == 0) {
          out->parts = find_parts(geometry.mockup, geometry.tool_radius);
          return;
        }
        for (std::uint32_t slot = (share - 1) * kBricksAShare; slot < std::min(share * kBricksAShare, bricks);
             ++slot)
          make_boxes(geometry.mockup, mockup, slot, out->boxes);
      },
      [&](std::uint32_t) { return go_on(); });
  if (done) out->triangles = TriangleTree::make(geometry.mockup, go_on);
  return done && go_on() ? out : nullptr;
}

}  // namespace palpate
