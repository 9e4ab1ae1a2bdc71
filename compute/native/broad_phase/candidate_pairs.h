#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "compute/native/broad_phase/candidates.h"
#include "compute/native/broad_phase/listed_boxes.h"
#include "compute/native/broad_phase/turned_boxes.h"
#include "compute/native/frame_helper.h"
#include "compute/scene/exact.h"
#include "compute/scene/scene_tables.h"
#include "model/bytes_of.h"

namespace palpate {

/// Goes from tool triangles near a brick to the voxels that they may touch and to the static triangles whose
/// boxes theirs meet. The device decides both exactly. Any number of threads, each with what it has Seen;
/// nothing but make() and Seen's resize() allocates.
class CandidatePairs {
 public:
  /// Which static triangles a thread has taken for its present tool triangle.
  class alignas(kOwnLines) Seen {
   public:
    void resize(std::size_t statics) { by_.resize(statics); }
    std::uint64_t bytes() const { return bytes_of(by_); }
    std::uint64_t looks = 0;  ///< voxels and their list entries that it has looked at

   private:
    friend class CandidatePairs;
    std::vector<std::uint32_t> by_;  ///< by static triangle: the last tool triangle that took it
    std::uint32_t looker_ = 0;       ///< number of the present one
  };

  static CandidatePairs make(const SceneTables& scene);

  /// A tool triangle at a pose.
  struct Triangle {
    std::uint32_t place;           ///< in the order of clusters
    BrickBits::Range voxels;       ///< that its corners' box, grown by more than kCloseSteps, meets
    Int3 corner;                   ///< one of its corners
    std::array<double, 3> normal;  ///< raw, rounded once
    double normal_size;            ///< sum of its components' sizes
    ListLook look;                 ///< from the last voxel
    float half_facing;             ///< from a part's low corner to its middle along the normal, half parts
    double half_parts;             ///< half parts of a voxel, to be multiplied with normal · steps
    std::array<std::int32_t, 6>
        parts;  ///< low and high of the same box, in parts of a voxel from the grid's origin on
  };
  /// Lane `i` of `boxes` is the box of `corners`, in the world. False: collinear, it meets nothing.
  bool begin(const exact::Corners& corners, std::uint32_t place, const EightRanges& boxes, std::size_t i,
             Seen& seen, Triangle& out) const;
  /// Appends what lies in one brick. False: a list had no room.
  bool take(Triangle& triangle, const Int3& brick, std::uint32_t slot, Seen& seen, Candidates& lists) const;

 private:
  bool off_plane(const Triangle& triangle, const Int3& low, std::int32_t side) const;
  bool take_brick(Triangle& triangle, const Int3& brick, std::uint32_t slot, Seen& seen,
                  Candidates& lists) const;
  bool take_list(Triangle& triangle, const Int3& voxel, std::uint32_t boundary, Seen& seen,
                 Candidates& lists) const;

  gpu::GridConstants grid_{};
  double per_part_ = 0;  ///< parts of a voxel a step
  float slack_ = 0;      ///< of a test against a plane, half parts
  std::span<const gpu::Brick> bricks_;
  std::span<const std::uint32_t> list_begin_, list_triangles_;
  std::span<const std::uint8_t> boxes_;  ///< SearchTables::boxes
};

}  // namespace palpate
