#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "compute/host_areas.h"
#include "compute/near_rays.h"
#include "compute/posed_tool.h"
#include "compute/ray_packet.h"
#include "model/scene_geometry.h"

namespace palpate {

/// A sample of an area that has a height, for those who ask what its ray meets.
struct RisenSample {
  std::uint32_t area;
  Int3 point;
  std::uint32_t height;
};

/// Heights of samples over a closed tool, and their sums (docs/EXACTNESS.md section 7, `refined`), on the host. One thread; make() keeps
/// references to its arguments; the rest allocates only when a contact is larger than all before.
class HostHeights {
 public:
  HostHeights(const SceneGeometry& geometry, NearRays& rays, const RunTree& runs)
      : geometry_(&geometry), rays_(&rays), packet_(geometry.tool, runs), order_(runs.order()), places_(kMostPlaces) {}

  /// Traces every counting sample of an area with a direction and adds its height to the area; `risen` gets those with a height.
  /// False: a ray may cross more than kMostPlaces triangles.
  bool sum(PosedTool& tool, const ContactLists& lists, const HostAreas& areas, std::vector<RisenSample>& risen);

  /// From now on heights are along this direction of the world.
  void aim(const NearRays::Turn& turn, const Int3& along) {
    along_ = along;
    rays_->aim(turn, along);
  }
  /// A height, or kNone. `through` goes on beyond V_ext voxels of the tool until something is crossed, for points that need not lie inside it.
  /// False: as sum().
  bool height(PosedTool& tool, const NearRays::Turn& turn, const Int3& p, bool through, std::uint32_t& out);

  /// A sample at `point` of weight `w` (Q30) has height H; `fade` is its H_0.
  static void add(gpu::AreaWork& area, const Int3& point, std::uint32_t height, std::uint32_t w, std::uint32_t fade);

  static constexpr std::size_t kMostPlaces = 4096;   ///< triangles that one ray may cross, beyond which the device takes over (chosen)

 private:
  struct Level {
    std::uint32_t height;
    std::int32_t sign;
    std::uint32_t id;
  };
  void cross(PosedTool& tool, const Int3& p, std::uint32_t id, std::uint32_t stop);
  bool walk(PosedTool& tool, const NearRays::Turn& turn, const Int3& p, bool through);
  std::uint32_t lowest_exit();
  std::uint32_t fade_height(std::uint32_t static_id, const Int3& d, const Int3& m) const;
  const Int3& exit_normal(PosedTool& tool, std::uint32_t exit);
  std::uint32_t fade_of(std::uint32_t static_id, const Int3& d, const Int3& m);

  const SceneGeometry* geometry_;
  NearRays* rays_;
  RayPacket packet_;
  std::span<const std::uint32_t> order_;
  std::vector<std::uint32_t> places_;
  Int3 along_{0};
  std::int64_t most_fade_ = 0;           ///< H_0 of an area's samples is at most this
  std::vector<std::uint32_t> area_of_;   ///< each sample's
  std::vector<std::uint32_t> by_area_;   ///< counting samples, those of an area one after the other
  std::vector<std::uint32_t> first_of_;  ///< of each area, in it
  std::vector<Int3> points_;             ///< of one area's samples
  std::vector<Level> levels_;   ///< crossings of the last ray, by height
  // Neighbouring samples lie on one triangle and leave through one: the last answers.
  std::uint32_t left_ = gpu::kNone;      ///< tool triangle
  Int3 left_normal_{0};                  ///< its direction at this pose
  Int3 least_normal_{0};                 ///< of several that a ray leaves through at once
  std::uint32_t faded_ = gpu::kNone;     ///< static triangle, with m and D …
  Int3 faded_m_{0}, faded_d_{0};
  std::uint32_t fade_ = 0;               ///< … has this H_0
};

}  // namespace palpate
