#include "compute/native/narrow_phase/open_inside.h"

#include <utility>
#include <vector>

#include "compute/native/narrow_phase/inside_search.h"
#include "compute/scene/brick_bits.h"
#include "compute/scene/tool_solid.h"

namespace palpate {

std::shared_ptr<const OpenShells> OpenInside::count_shells(const LatticeMesh& mesh, const PartitionView& view,
                                                           std::span<const std::uint8_t> boxes,
                                                           const OpenShells::GoOn& go_on) {
  const PartitionLookup partition(view);
  const InsideSearch search(mesh, partition, boxes);
  auto made = OpenShells::make(
      view, [&](const Int3& voxel, std::uint32_t boundary) { return search.halves_of(voxel, boundary); },
      go_on);
  return made ? std::make_shared<const OpenShells>(std::move(*made)) : nullptr;
}

std::shared_ptr<const OpenInside> OpenInside::make(const LatticeMesh& mesh, const PartitionView& view,
                                                   std::span<const std::uint8_t> boxes,
                                                   std::shared_ptr<const OpenShells> shells) {
  auto out = std::make_shared<OpenInside>();
  out->shells = std::move(shells);
  const PartitionLookup partition(view);
  InsideSearch search(mesh, partition, boxes);
  out->crossings = MiddleCrossings(mesh, view);
  search.use(out);  // it has no cells yet
  out->cells =
      InsideCells(mesh, view, boxes, [&](const Int3& point, const Int3& voxel, std::uint32_t boundary) {
        return search.shells_at(point, voxel, boundary) > 0;
      });
  BrickBits may, all;
  if (!out->cells.spread(view, may, all)) return out;
  const Int3 n = kNearParts * 8 * view.grid.bricks;
  SolidCubes solid(n, static_cast<double>(view.grid.size) / kNearParts);
  for (int z = 0; z < n.z; ++z)
    for (int y = 0; y < n.y; ++y)
      for (int x = 0; x < n.x; ++x) {
        static_assert(InsideCells::kCells == 2 * kNearParts);
        const BrickBits::Block& cells = may.bits(may.number(x >> 2, y >> 2, z >> 2));
        const auto plane = static_cast<std::size_t>(2 * (z & 3));
        constexpr std::uint64_t kFour = 0x303;  // two by two cells
        if (((cells[plane] | cells[plane + 1]) >> (2 * (x & 3) + 16 * (y & 3)) & kFour) != 0)
          solid.add(x, y, z);
      }
  out->near = solid.near(near_distance(view.grid.size));
  return out;
}

}  // namespace palpate
