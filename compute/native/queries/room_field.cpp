#include "compute/native/queries/room_field.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <memory>
#include <utility>

#include "compute/native/prepare/touched_voxels.h"
#include "compute/native/processor.h"
#include "compute/scene/partition.h"
#include "compute/scene/shares.h"
#include "model/lattice/voxel_size.h"
#include "model/scene/geometry_build.h"

namespace palpate::native {
namespace {

namespace plain {
constexpr std::size_t kWidth = 4;
#include "compute/native/queries/room_simd.h"
}  // namespace plain
#if PALPATE_TWO_CODES
PALPATE_SECOND_CODE_BEGIN
namespace second {
constexpr std::size_t kWidth = 8;
#include "compute/native/queries/room_simd.h"
}  // namespace second
PALPATE_SECOND_CODE_END
#endif

constexpr std::int32_t kFar = 8;           // cells, beyond which a brick's cells are told no more
constexpr float kPerCell = 16;             // what a byte counts
constexpr std::size_t kBricksAShare = 64;  // chosen: a millisecond
constexpr std::int32_t kWindow = 24;       // a brick and its neighbours, cells
constexpr std::int32_t kCellsAVoxel = 4;   // chosen: with half of them a free pose takes three times as long
constexpr std::uint64_t kMostBricks = std::uint64_t{1} << 20;                       // chosen: 4 MiB of places
constexpr std::uint64_t kMostBytes = std::uint64_t{1} << 26, kBytesATriangle = 64;  // of cells; chosen
constexpr std::int32_t kNoBrick = 1 << 20;                                          // is touched
constexpr std::uint64_t kCellBytes = 512;                                           // of a brick

/// What lies in cells that are `steps` apart along an axis is apart by so many cells at least.
constexpr std::int32_t between(std::int32_t steps) { return steps == 0 ? 0 : std::abs(steps) - 1; }

constexpr std::int16_t kNone = kFar * kFar;

using Row = std::array<std::int16_t, 8>;

/// Rows along x, y and z of a brick and its neighbours.
struct Window {
  std::array<std::uint32_t, kWindow * kWindow> rows{};  ///< row y + 24 z: a bit for each cell that is touched
  std::array<Row, kWindow * kWindow> along_x{};
  std::array<Row, 8 * kWindow> along_y{};
  std::array<bool, kWindow> plane{};  ///< by z: whether any is
};

void widen(const Row& from, std::int32_t step, Row& best) {
  const auto more = static_cast<std::int16_t>(between(step) * between(step));
  for (std::size_t x = 0; x < 8; ++x) best[x] = std::min(best[x], static_cast<std::int16_t>(from[x] + more));
}

/// Gaps of a brick's cells to the nearest touched one, sixteenths of a cell, rounded down.
void gaps_of(Window& w, std::array<std::uint8_t, 512>& out) {
  for (std::size_t row = 0; row < w.rows.size(); ++row) {
    if (row % kWindow == 0) w.plane[row / kWindow] = false;
    if (w.rows[row] == 0) continue;
    w.plane[row / kWindow] = true;
    for (std::int32_t x = 0; x < 8; ++x) {
      const std::uint32_t left = w.rows[row] & ((2u << (x + 8)) - 1), right = w.rows[row] >> (x + 8);
      std::int32_t least = kFar + 1;
      if (left != 0) least = std::min(least, x + 8 - (31 - std::countl_zero(left)));
      if (right != 0) least = std::min(least, std::countr_zero(right));
      w.along_x[row][static_cast<std::size_t>(x)] =
          static_cast<std::int16_t>(between(least) * between(least));
    }
  }
  for (std::int32_t z = 0; z < kWindow; ++z) {
    if (!w.plane[static_cast<std::size_t>(z)]) continue;
    for (std::int32_t y = 0; y < 8; ++y) {
      Row best;
      best.fill(kNone);
      for (std::int32_t step = -kFar; step <= kFar; ++step) {
        const auto row = static_cast<std::size_t>(y + 8 + step + kWindow * z);
        if (w.rows[row] != 0) widen(w.along_x[row], step, best);
      }
      w.along_y[static_cast<std::size_t>(y + 8 * z)] = best;
    }
  }
  for (std::int32_t z = 0; z < 8; ++z)
    for (std::int32_t y = 0; y < 8; ++y) {
      Row best;
      best.fill(kNone);
      for (std::int32_t step = -kFar; step <= kFar; ++step)
        if (w.plane[static_cast<std::size_t>(z + 8 + step)])
          widen(w.along_y[static_cast<std::size_t>(y + 8 * (z + 8 + step))], step, best);
      for (std::size_t x = 0; x < 8; ++x)
        out[x + 8 * static_cast<std::size_t>(y + 8 * z)] =
            static_cast<std::uint8_t>(kPerCell * std::sqrt(static_cast<float>(best[x])));
    }
}

/// How many bricks each is from the nearest of those at 0, counted along the axis where it is most: chamfer.
void count_bricks(const Int3& size, std::vector<std::int32_t>& bricks) {
  const auto pass = [&](std::int32_t way) {
    const auto in_order = [&](std::int32_t i, std::int32_t n) { return way > 0 ? i : n - 1 - i; };
    for (std::int32_t k = 0; k < size.z; ++k)
      for (std::int32_t j = 0; j < size.y; ++j)
        for (std::int32_t i = 0; i < size.x; ++i) {
          const Int3 at(in_order(i, size.x), in_order(j, size.y), in_order(k, size.z));
          std::int32_t& own = bricks[static_cast<std::size_t>(at.x) +
                                     static_cast<std::size_t>(size.x) *
                                         (static_cast<std::size_t>(at.y) +
                                          static_cast<std::size_t>(size.y) * static_cast<std::size_t>(at.z))];
          if (own == 0) continue;
          for (std::int32_t n = 0; n < 13; ++n) {  // of its neighbours those that were before it
            const Int3 by = at + way * Int3(n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1);
            if (by.x < 0 || by.y < 0 || by.z < 0 || by.x >= size.x || by.y >= size.y || by.z >= size.z)
              continue;
            own = std::min(
                own, 1 + bricks[static_cast<std::size_t>(by.x) +
                                static_cast<std::size_t>(size.x) *
                                    (static_cast<std::size_t>(by.y) +
                                     static_cast<std::size_t>(size.y) * static_cast<std::size_t>(by.z))]);
          }
        }
  };
  pass(1);
  pass(-1);
}

VoxelGrid grid_of(const LatticeMesh& mesh, std::int32_t cell) {
  return make_grid(mesh.box_min, mesh.box_max, cell);
}
std::int32_t finest_cell(const SceneGeometry& geometry) {
  return std::max(geometry.mockup_grid.size / kCellsAVoxel & ~1, kSmallestVoxel);
}
std::uint64_t most_bricks_near(const LatticeMesh& mesh) {
  return (kMostBytes + kBytesATriangle * mesh.triangles.size()) / kCellBytes;
}

}  // namespace

std::uint64_t RoomField::most_bytes(const SceneGeometry& geometry) {
  const std::uint64_t bricks = std::min<std::uint64_t>(
      brick_count(grid_of(geometry.mockup, finest_cell(geometry)).bricks), kMostBricks);
  return kCellBytes * std::min(bricks, most_bricks_near(geometry.mockup)) + sizeof(std::int32_t) * bricks +
         sizeof(float) * DistanceLattice::kMostNodes;
}

std::uint64_t RoomField::most_bytes_made(const SceneGeometry& geometry) {
  const std::uint64_t kept = most_bytes(geometry);
  return kept + kept / 4 + sizeof(std::uint32_t) * kMostBricks;  // touched voxels, and lists of bricks
}

/// The finest cells that fit are taken: with cells of twice the side, a quarter of the memory, a pose that is
/// free and near takes three times as long.
RoomField RoomField::of(const SceneGeometry& geometry, const TriangleTree& tree) {
  const LatticeMesh& mesh = geometry.mockup;
  DistanceLattice lattice(mesh, tree, 2.0 * geometry.tool_radius);
  for (std::int32_t cell = finest_cell(geometry);; cell *= 2) {
    const VoxelGrid grid = grid_of(mesh, cell);
    // Ends: no side has more than 2^30 steps, so cells of 2^25 make 5 bricks along it, and 125 always fit.
    if (brick_count(grid.bricks) > kMostBricks) continue;
    std::vector<std::uint32_t> touched = touched_bricks(mesh, grid);
    std::vector<std::int32_t> away(touched.size());
    for (std::size_t brick = 0; brick < away.size(); ++brick)
      away[brick] = touched[brick] != 0 ? 0 : kNoBrick;
    touched = {};
    count_bricks(grid.bricks, away);
    const auto near = static_cast<std::uint64_t>(
        std::count_if(away.begin(), away.end(), [](std::int32_t bricks) { return bricks <= 1; }));
    if (near <= most_bricks_near(mesh)) return {mesh, grid, std::move(away), near, std::move(lattice)};
  }
}

RoomField::RoomField(const LatticeMesh& mesh, const VoxelGrid& grid, std::vector<std::int32_t> away,
                     std::size_t count, DistanceLattice lattice)
    : grid_(grid),
      per_cell_(1.0 / grid.size),
      place_(std::move(away)),
      near_(count),
      lattice_(std::move(lattice)) {
  const Int3& size = grid_.bricks;
  std::vector<std::uint32_t> near;
  near.reserve(count);
  for (std::size_t brick = 0; brick < place_.size(); ++brick) {
    if (place_[brick] > 1) {
      place_[brick] = -8 * (place_[brick] - 1);
      continue;
    }
    place_[brick] = static_cast<std::int32_t>(near.size());
    near.push_back(static_cast<std::uint32_t>(brick));
  }
  const std::vector<BrickBits> bits = touched_voxels(mesh, grid, place_, count);
  const auto fill = [&](std::uint32_t share) {
    const auto window = std::make_unique<Window>();
    for (std::size_t n = share * kBricksAShare; n < std::min((share + 1) * kBricksAShare, count); ++n) {
      window->rows.fill(0);
      const Int3 at = brick_at(size, near[n]);
      for (std::int32_t k = 0; k < 27; ++k) {
        const Int3 by(k % 3, k / 3 % 3, k / 9), b = at + by - 1;
        if (b.x < 0 || b.y < 0 || b.z < 0 || b.x >= size.x || b.y >= size.y || b.z >= size.z) continue;
        const std::int32_t place =
            place_[static_cast<std::size_t>(b.x) +
                   static_cast<std::size_t>(size.x) *
                       (static_cast<std::size_t>(b.y) +
                        static_cast<std::size_t>(size.y) * static_cast<std::size_t>(b.z))];
        if (place < 0) continue;
        for (std::int32_t z = 0; z < 8; ++z)
          for (std::int32_t y = 0; y < 8; ++y) {
            const std::uint32_t word =
                bits[static_cast<std::size_t>(place)][static_cast<std::size_t>(y >> 2 | z << 1)];
            window->rows[static_cast<std::size_t>(8 * by.y + y + kWindow * (8 * by.z + z))] |=
                (word >> (8 * (y & 3)) & 0xFF) << (8 * by.x);
          }
      }
      gaps_of(*window, near_[n]);
    }
  };
  in_shares(static_cast<std::uint32_t>((count + kBricksAShare - 1) / kBricksAShare), fill,
            [](std::uint32_t) { return true; });
}

RoomField::Turn RoomField::turn(const LatticePose& pose, double tool_radius) const {
  Turn out;
  double far = tool_radius;
  for (std::size_t r = 0; r < 3; ++r) {
    const int axis = static_cast<int>(r);
    for (std::size_t c = 0; c < 3; ++c)
      out.rotation[r][c] = static_cast<float>(pose.rotation_q30[r][c] * 0x1p-30 * per_cell_);
    const double at = static_cast<double>(pose.translation[axis]) - grid_.origin[axis];
    out.at[r] = static_cast<float>(at * per_cell_);
    far = std::max(far, std::abs(at));
  }
  // A vertex is rounded by a step at most. Of a place, in each axis, entries, the centre and their products
  // are rounded by 2^-24 of the tool's radius each, sums and the place by as much of both: below 16 of them.
  out.slack = static_cast<float>(2 + (far + tool_radius) * 0x1p-19);
  return out;
}

void RoomField::rooms(const Turn& turn, const EightSpheres& spheres, EightFloats& squared) const {
  std::int32_t cell[3][kLanes];
  const float end[3] = {static_cast<float>(8 * grid_.bricks.x), static_cast<float>(8 * grid_.bricks.y),
                        static_cast<float>(8 * grid_.bricks.z)};
#if PALPATE_TWO_CODES
  if (has_second_code())
    second::cells_of(turn, end, spheres, cell, squared.data());
  else
#endif
    plain::cells_of(turn, end, spheres, cell, squared.data());
  for (std::size_t i = 0; i < kLanes; ++i) {
    const std::int32_t x = cell[0][i], y = cell[1][i], z = cell[2][i],
                       place = place_[static_cast<std::size_t>(
                           (x >> 3) + grid_.bricks.x * ((y >> 3) + grid_.bricks.y * (z >> 3)))];
    const float gap =
        place >= 0
            ? (1 / kPerCell) * static_cast<float>(near_[static_cast<std::size_t>(
                                   place)][static_cast<std::size_t>((x & 7) | (y & 7) << 3 | (z & 7) << 6)])
            : static_cast<float>(-place);
    squared[i] += gap * gap;
  }
}

double RoomField::room(const Turn& turn, float squared, float radius) const {
  return std::sqrt(static_cast<double>(squared)) * grid_.size * (1 - 0x1p-20) - radius - turn.slack;
}

std::array<double, 3> RoomField::centre(const Turn& turn, const EightSpheres& spheres, std::size_t i) const {
  std::array<double, 3> at{};
  for (std::size_t r = 0; r < 3; ++r) {
    double cells = turn.at[r];
    for (std::size_t c = 0; c < 3; ++c)
      cells += static_cast<double>(turn.rotation[r][c]) * spheres.centre[c][i];
    at[r] = grid_.origin[static_cast<int>(r)] + cells * grid_.size;
  }
  return at;
}

double RoomField::far_room(const Turn& turn, const EightSpheres& spheres, std::size_t i,
                           float squared) const {
  const double known = static_cast<double>(squared) * grid_.size * grid_.size;
  return std::sqrt(std::max(known, lattice_.squared(centre(turn, spheres, i)))) * (1 - 0x1p-20) -
         spheres.radius[i] - turn.slack;
}

double RoomField::room_at(const std::array<double, 3>& point) const {
  double away = 0;
  std::size_t brick[3], cell[3];
  for (std::size_t k = 0; k < 3; ++k) {
    const int axis = static_cast<int>(k);
    const double at = (point[k] - grid_.origin[axis]) * per_cell_, end = 8 * grid_.bricks[axis];
    const double within = std::min(std::max(at, 0.0), end);
    away += (at - within) * (at - within);
    const auto number = static_cast<std::size_t>(std::min(within, end - 1));
    brick[k] = number >> 3;
    cell[k] = number & 7;
  }
  const std::int32_t place =
      place_[brick[0] + static_cast<std::size_t>(grid_.bricks.x) *
                            (brick[1] + static_cast<std::size_t>(grid_.bricks.y) * brick[2])];
  const double gap =
      place >= 0
          ? (1.0 / kPerCell) * near_[static_cast<std::size_t>(place)][cell[0] | cell[1] << 3 | cell[2] << 6]
          : -static_cast<double>(place);
  const double room = (away == 0 ? gap : std::sqrt(away + gap * gap)) * grid_.size;
  if (away == 0 && place >= 0) return room;
  return std::max(room, std::sqrt(lattice_.squared(point)));
}

double RoomField::detail_steps() const { return static_cast<double>(kFar) * grid_.size; }

/// By balls about the middles of longest edges, which a triangle that is not beyond by one is cut at. A
/// ball's middle is a point of the triangle: where it is not beyond, no smaller ball about it will be.
bool RoomField::all_beyond(const exact::Corners& triangle, double steps) const {
  struct Part {
    std::array<std::array<double, 3>, 3> corner;
  };
  constexpr std::size_t kMostParts = 12, kMostBalls = 24;  // chosen: by then it is no cheaper than to look
  Part parts[kMostParts];
  for (std::size_t c = 0; c < 3; ++c)
    for (std::size_t k = 0; k < 3; ++k) parts[0].corner[c][k] = triangle[c][static_cast<int>(k)];
  std::size_t count = 1;
  for (std::size_t balls = 0; count != 0; ++balls) {
    if (balls == kMostBalls || count == kMostParts) return false;
    const Part part = parts[--count];
    std::size_t longest = 0;
    double most = -1;
    for (std::size_t e = 0; e < 3; ++e) {
      double sum = 0;
      for (std::size_t k = 0; k < 3; ++k) {
        const double d = part.corner[(e + 1) % 3][k] - part.corner[e][k];
        sum += d * d;
      }
      if (sum > most) {
        most = sum;
        longest = e;
      }
    }
    const auto &a = part.corner[longest], &b = part.corner[(longest + 1) % 3],
               &c = part.corner[(longest + 2) % 3];
    std::array<double, 3> middle;
    double third = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      middle[k] = 0.5 * (a[k] + b[k]);
      third += (c[k] - middle[k]) * (c[k] - middle[k]);
    }
    const double room = room_at(middle) * (1 - 0x1p-40) - 1 - steps;
    if (room <= 0) return false;
    const double radius = std::max(0.25 * most, third);
    if (radius < room * room) continue;
    parts[count++] = {{a, middle, c}};
    parts[count++] = {{middle, b, c}};
  }
  return true;
}

}  // namespace palpate::native
