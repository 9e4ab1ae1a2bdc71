#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "compute/host_areas.h"
#include "compute/host_heights.h"
#include "compute/posed_tool.h"
#include "model/scene_geometry.h"

namespace palpate {

/// What follows the heights of a contact (docs/EXACTNESS.md section 7, `refined`), on the host: needles, and who pierces whom. One thread; keeps
/// references to the constructor's arguments; allocates only when a contact is larger than all before.
class HostFollow {
 public:
  explicit HostFollow(const SceneGeometry& geometry) : geometry_(&geometry) {}

  /// Areas with CST and a direction but without a height take their needle samples. `risen` gets those that look for pierced areas.
  /// False: left to the device (HostHeights::height()).
  bool needles(PosedTool& tool, HostHeights& heights, const ContactLists& lists, const HostAreas& areas, std::span<const gpu::ContactPair> pairs,
               std::uint32_t area_count, std::vector<RisenSample>& risen);

  /// Of every area, those whose surfaces its rays leave first, each once.
  void pierces(const ContactLists& lists, std::uint32_t area_count, std::vector<RisenSample>& risen, std::vector<gpu::AreaPierce>& out);

 private:
  struct Facing {
    std::uint32_t area;
    exact::Corners corners;
    Int3 low, high;
  };
  void take_vertices(PosedTool& tool, const ContactLists& lists);
  void find_facing(const ContactLists& lists, std::uint32_t own, std::uint32_t area_count, std::span<const RisenSample> rays);

  const SceneGeometry* geometry_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> vertices_;   ///< area, tool vertex
  std::vector<std::uint32_t> slots_, first_slot_;                   ///< C_s by area, or CST of one; where each area's begin
  std::vector<Facing> facing_;                                      ///< triangles of other areas that rays of one area may leave
};

}  // namespace palpate
