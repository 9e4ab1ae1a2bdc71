#include "compute/native/queries/room_field.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstring>
#include <utility>

#include "compute/native/processor.h"
#include "compute/scene/partition.h"
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

constexpr std::int32_t kFar = 8;            // cells, beyond which a brick's cells are told no more
constexpr std::uint32_t kPerCell = 16;      // what a byte counts
constexpr float kACount = 1.0f / kPerCell;  // cells
constexpr std::int32_t kWindow = 24;        // a brick and its neighbours, cells
constexpr std::int32_t kCellsAVoxel = 4;    // chosen: with half of them a free pose takes three times as long
constexpr std::uint64_t kMostBricks = std::uint64_t{1} << 20;                       // chosen: 4 MiB of places
constexpr std::uint64_t kMostBytes = std::uint64_t{1} << 26, kBytesATriangle = 64;  // of cells; chosen
constexpr std::int32_t kNoBrick = 1 << 20;                                          // is touched
constexpr std::uint64_t kBrickBytes = 512 + sizeof(BrickBits);                      // of one that is near
constexpr std::int32_t kNew = -(1 << 29),
                       kTaken = 2 * kNew;  // what is far is a few million cells off at most

/// What lies in cells that are `steps` apart along an axis is apart by so many cells at least.
constexpr std::int32_t between(std::int32_t steps) { return steps == 0 ? 0 : std::abs(steps) - 1; }

constexpr std::uint8_t kNone = kFar * kFar;

/// Squared cells of eight rows along x, the next y each: of a brick and one z.
using Plane = std::array<std::uint8_t, 64>;

/// A brick and its neighbours.
struct Window {
  /// Row y + 24 z: a bit for each cell along x that is touched.
  std::array<std::uint32_t, kWindow * kWindow> rows{};
  std::array<std::uint8_t, 8 * kWindow * kWindow> along_x;  ///< of the rows, from the brick's own x
  std::array<Plane, kWindow> along_y;                       ///< by z, from its own x and y
  std::array<bool, kWindow> touched{};                      ///< by z: whether any is
};

/// By byte: 255 where it has a bit, else 0.
constexpr auto kSpread = [] {
  std::array<std::uint64_t, 256> out{};
  for (std::size_t byte = 0; byte < 256; ++byte)
    for (std::size_t bit = 0; bit < 8; ++bit)
      if ((byte >> bit & 1) != 0) out[byte] |= std::uint64_t{0xFF} << 8 * bit;
  return out;
}();
static_assert(std::endian::native == std::endian::little);

/// Of squared cells the cells, in sixteenths, rounded down.
constexpr auto kRoots = [] {
  std::array<std::uint8_t, kNone + 1> out{};
  for (std::size_t square = 0; square < out.size(); ++square)
    while ((out[square] + 1u) * (out[square] + 1u) <= kPerCell * kPerCell * square) ++out[square];
  return out;
}();

/// Squared gaps along a row: of the brick's eight cells, which are the middle ones of 24.
std::uint64_t gaps_along(std::uint32_t row) {
  constexpr std::uint64_t kEach = 0x0101010101010101;
  std::uint64_t out = kNone * kEach;
  for (std::int32_t step = 1; step <= kFar; ++step) {
    row |= row << 1 | row >> 1;  // what is no more than so many steps from a touched one
    const std::int32_t here = between(step), next = between(step + 1);
    out -= kSpread[row >> 8 & 0xFF] & static_cast<std::uint64_t>(next * next - here * here) * kEach;
  }
  return out;
}

void widen(const std::uint8_t* from, std::int32_t step, Plane& best) {
  const auto more = static_cast<std::uint8_t>(between(step) * between(step));
  for (std::size_t i = 0; i < best.size(); ++i)
    best[i] = std::min(best[i], static_cast<std::uint8_t>(from[i] + more));
}

/// Gaps of a brick's cells to the nearest touched one, sixteenths of a cell, rounded down.
void gaps_of(Window& w, std::array<std::uint8_t, 512>& out) {
  for (std::size_t z = 0; z < kWindow; ++z) {
    const std::uint32_t* const rows = &w.rows[kWindow * z];
    w.touched[z] = std::any_of(rows, rows + kWindow, [](std::uint32_t row) { return row != 0; });
    if (!w.touched[z]) continue;
    for (std::size_t y = 0; y < kWindow; ++y) {
      const std::uint64_t gaps = gaps_along(rows[y]);
      std::memcpy(&w.along_x[8 * (y + kWindow * z)], &gaps, sizeof gaps);
    }
    w.along_y[z].fill(kNone);
    for (std::int32_t step = -kFar; step <= kFar; ++step)
      widen(&w.along_x[8 * (static_cast<std::size_t>(8 + step) + kWindow * z)], step, w.along_y[z]);
  }
  for (std::int32_t z = 0; z < 8; ++z) {
    Plane best;
    best.fill(kNone);
    for (std::int32_t step = -kFar; step <= kFar; ++step)
      if (const auto from = static_cast<std::size_t>(z + 8 + step); w.touched[from])
        widen(w.along_y[from].data(), step, best);
    for (std::size_t i = 0; i < best.size(); ++i)
      out[static_cast<std::size_t>(z) * best.size() + i] = kRoots[best[i]];
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
  return (kMostBytes + kBytesATriangle * mesh.triangles.size()) / kBrickBytes;
}

}  // namespace

std::uint64_t RoomField::most_bytes(const SceneGeometry& geometry) {
  const std::uint64_t bricks = std::min<std::uint64_t>(
      brick_count(grid_of(geometry.mockup, finest_cell(geometry)).bricks), kMostBricks);
  return kBrickBytes * std::min(bricks, most_bricks_near(geometry.mockup)) + sizeof(std::int32_t) * bricks +
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
      near_(std::make_unique_for_overwrite<Cells[]>(count)),
      lattice_(std::move(lattice)) {
  std::int32_t number = 0;
  for (std::int32_t& place : place_) place = place > 1 ? -8 * (place - 1) : number++;
  touched_ = touched_voxels(mesh, grid, place_, count);
  for (std::int32_t& place : place_)
    if (place >= 0) place = kNew - place;
}

/// The cells of a brick that is near.
void RoomField::work_out(std::size_t brick, Cells& out) const {
  const Int3& size = grid_.bricks;
  const Int3 at = brick_at(size, brick);
  Window window;
  for (std::int32_t k = 0; k < 27; ++k) {
    const Int3 by(k % 3, k / 3 % 3, k / 9), b = at + by - 1;
    if (b.x < 0 || b.y < 0 || b.z < 0 || b.x >= size.x || b.y >= size.y || b.z >= size.z) continue;
    const std::size_t other =
        static_cast<std::size_t>(b.x) +
        static_cast<std::size_t>(size.x) * (static_cast<std::size_t>(b.y) +
                                            static_cast<std::size_t>(size.y) * static_cast<std::size_t>(b.z));
    const std::int32_t place = std::atomic_ref(place_[other]).load(std::memory_order_relaxed);
    if (place < 0 && place > kNew) continue;
    const auto number =
        static_cast<std::size_t>(place >= 0 ? place : (place > kTaken ? kNew : kTaken) - place);
    for (std::int32_t z = 0; z < 8; ++z)
      for (std::int32_t y = 0; y < 8; ++y) {
        const std::uint32_t word = touched_[number][static_cast<std::size_t>(y >> 2 | z << 1)];
        window.rows[static_cast<std::size_t>(8 * by.y + y + kWindow * (8 * by.z + z))] |=
            (word >> (8 * (y & 3)) & 0xFF) << (8 * by.x);
      }
  }
  gaps_of(window, out);
}

/// Cells from one that is near or far to the nearest touched one, at least.
inline float RoomField::gap(std::size_t brick, std::size_t cell) const {
  const std::int32_t place = std::atomic_ref(place_[brick]).load(std::memory_order_acquire);
  if (place >= 0) return kACount * static_cast<float>(near_[static_cast<std::size_t>(place)][cell]);
  if (place > kNew) return static_cast<float>(-place);
  return gap_of_new(brick, place, cell);
}

/// Nobody waits: while one thread works a brick out others do so for themselves.
float RoomField::gap_of_new(std::size_t brick, std::int32_t place, std::size_t cell) const {
  const std::atomic_ref shared(place_[brick]);
  if (place > kTaken &&
      shared.compare_exchange_strong(place, place - kNew + kTaken, std::memory_order_relaxed)) {
    const std::int32_t number = kNew - place;
    Cells& cells = near_[static_cast<std::size_t>(number)];
    work_out(brick, cells);
    shared.store(number, std::memory_order_release);
    return kACount * static_cast<float>(cells[cell]);
  }
  Cells own;
  work_out(brick, own);
  return kACount * static_cast<float>(own[cell]);
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
    const std::int32_t x = cell[0][i], y = cell[1][i], z = cell[2][i];
    const float cells =
        gap(static_cast<std::size_t>((x >> 3) + grid_.bricks.x * ((y >> 3) + grid_.bricks.y * (z >> 3))),
            static_cast<std::size_t>((x & 7) | (y & 7) << 3 | (z & 7) << 6));
    squared[i] += cells * cells;
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
  const std::size_t number = brick[0] + static_cast<std::size_t>(grid_.bricks.x) *
                                            (brick[1] + static_cast<std::size_t>(grid_.bricks.y) * brick[2]);
  const double cells = gap(number, cell[0] | cell[1] << 3 | cell[2] << 6);
  const double room = (away == 0 ? cells : std::sqrt(away + cells * cells)) * grid_.size;
  const std::int32_t place = std::atomic_ref(place_[number]).load(std::memory_order_relaxed);
  if (away == 0 && (place >= 0 || place <= kNew)) return room;
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
