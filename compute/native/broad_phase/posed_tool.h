#pragma once
#include <cstdint>
#include <vector>

#include "compute/scene/exact.h"
#include "model/bytes_of.h"
#include "model/lattice/lattice.h"
#include "model/lattice/lattice_mesh.h"

namespace palpate {

/// The tool's triangles at a pose, each moved when it is first asked for. A triangle's corners() are one
/// thread's at a time, different ones' any number's; only the constructor allocates.
class PosedTool {
 public:
  explicit PosedTool(const LatticeMesh& tool)
      : tool_(&tool), moved_(tool.triangles.size()), corners_(tool.triangles.size()) {}

  void begin(const LatticePose& pose) {
    pose_ = pose;
    if (++now_ != 0) return;
    moved_.assign(moved_.size(), 0);  // once in 2^32 frames
    now_ = 1;
  }
  const LatticePose& pose() const { return pose_; }
  /// World lattice, exact; valid until the next begin().
  const exact::Corners& corners(std::uint32_t id) {
    if (moved_[id] != now_) {
      moved_[id] = now_;
      for (int k = 0; k < 3; ++k)
        corners_[id][static_cast<std::size_t>(k)] = transform(pose_, tool_->corner(id, k));
    }
    return corners_[id];
  }
  /// Of a triangle that corners() has moved since begin(): any number of threads.
  const exact::Corners& moved(std::uint32_t id) const { return corners_[id]; }
  std::uint64_t bytes() const { return bytes_of(moved_) + bytes_of(corners_); }

 private:
  const LatticeMesh* tool_;
  LatticePose pose_{};
  std::uint32_t now_ = 0;
  std::vector<std::uint32_t> moved_;  ///< by triangle: the frame it was last moved in
  std::vector<exact::Corners> corners_;
};

}  // namespace palpate
