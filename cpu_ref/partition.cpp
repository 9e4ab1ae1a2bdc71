#include "cpu_ref/partition.h"

#include <algorithm>
#include <string>

#include "cpu_ref/touched_voxels.h"

namespace palpate::cpu_ref {
namespace {

// Beside the three classes, a voxel under way is one of these, plus its ballots of non-zero winding (0 to 3).
constexpr VoxelClass kUndecided{8};  ///< not V_bnd; enclosed, once V_ext is known
constexpr VoxelClass kCounted{16};   ///< its component's ballots are being counted

bool undecided(VoxelClass c) { return c >= kUndecided && c < kCounted; }
bool counted(VoxelClass c) { return c == kCounted; }

void list_boundary(const LatticeMesh& mesh, std::int32_t grow, Partition& out) {
  std::vector<std::pair<std::uint64_t, std::uint32_t>> touched;  // voxel, triangle
  for (std::uint32_t id = 0; id < mesh.triangles.size(); ++id) {
    if (mesh.collapsed(id)) continue;
    for_each_touched_voxel(
        triangle_of(mesh, id), out.grid, grow, [](const Int3&, const Int3&) { return true; },
        [&](const Int3& voxel) { touched.emplace_back(out.number(voxel), id); });
  }
  std::sort(touched.begin(), touched.end());
  for (const auto& [voxel, triangle] : touched) {
    if (out.boundary_voxels.empty() || out.boundary_voxels.back() != voxel) {
      out.boundary_voxels.push_back(voxel);
      out.list_begin.push_back(out.list_triangles.size());
      out.classes.set(out.voxel(voxel), VoxelClass::kBoundary);
    }
    out.list_triangles.push_back(triangle);
  }
  out.list_begin.push_back(out.list_triangles.size());
}

/// Calls visit(voxel) for one voxel of every uniform brick and for every voxel of the others.
template <class Visit>
void for_each_piece(const BrickClasses& classes, const Visit& visit) {
  for (std::size_t brick = 0; brick < classes.brick_count(); ++brick) {
    const Int3 first = classes.first_voxel(brick);
    const int side = classes.uniform(brick) ? 1 : kBrickSide;
    for (int z = 0; z < side; ++z)
      for (int y = 0; y < side; ++y)
        for (int x = 0; x < side; ++x) visit(first + Int3(x, y, z));
  }
}

/// Gives every enclosed component the class of its vote. Returns whether any is V_int.
bool count_votes(int directions, const Ballots& ballots, BrickClasses& classes) {
  bool any_internal = false;
  for_each_piece(classes, [&](const Int3& start) {
    if (!undecided(classes.at(start))) return;
    std::uint64_t cast = 0, non_zero = 0;
    classes.flood(start, kCounted, undecided, [&](const Int3& voxel, VoxelClass c, int voxels) {
      const std::size_t brick = classes.brick_of(voxel);
      cast += static_cast<std::uint64_t>(voxels * directions);
      non_zero += classes.uniform(brick)
                      ? ballots.of_brick[brick]
                      : static_cast<std::uint64_t>(c) - static_cast<std::uint64_t>(kUndecided);
    });
    const bool internal = non_zero > cast - non_zero;
    any_internal = any_internal || internal;
    classes.flood(start, internal ? VoxelClass::kInternal : VoxelClass::kExternal, counted,
                  [](const Int3&, VoxelClass, int) {});
  });
  return any_internal;
}

}  // namespace

Result<Partition> make_partition(const LatticeMesh& mesh, const VoxelGrid& grid, std::int32_t grow,
                                 const Progress& progress) {
  const Int128 bricks = Int128{grid.bricks.x} * grid.bricks.y * grid.bricks.z;
  if (bricks > Int128{kMaxBricks})
    return bad_value("The voxel grid has " + std::to_string(grid.bricks.x) + " x " +
                     std::to_string(grid.bricks.y) + " x " + std::to_string(grid.bricks.z) +
                     " bricks of 512 voxels, which is more than the CPU reference keeps (" +
                     std::to_string(kMaxBricks) + "): choose larger voxels.");
  const Error stopped{ErrorCode::kUsage, "Preparation was cancelled."};
  const auto go_on = [&](double done) { return !progress || progress("voxel partition", done); };

  Partition partition;
  partition.grid = grid;
  partition.classes = BrickClasses(grid.bricks, kUndecided);
  BrickClasses& classes = partition.classes;
  if (!go_on(0)) return stopped;
  list_boundary(mesh, grow, partition);
  if (!go_on(0.5)) return stopped;
  // The grid's outermost layer has no V_bnd voxel (its margins see to that): all of the border hangs
  // together.
  classes.flood(Int3(0), VoxelClass::kExternal, undecided, [](const Int3&, VoxelClass, int) {});
  const int directions = mesh.closed ? 1 : 3;
  Ballots ballots;
  ballots.of_brick.assign(classes.brick_count(), 0);
  for (int axis = 0; axis < directions; ++axis) cast_ballots(mesh, grid, axis, kUndecided, classes, ballots);
  if (!go_on(0.8)) return stopped;
  partition.has_internal = count_votes(directions, ballots, classes);
  if (!go_on(1)) return stopped;
  return partition;
}

Int3 Partition::voxel(std::uint64_t number) const {
  const Int3 n = grid.voxels();
  const auto nx = static_cast<std::uint64_t>(n.x), ny = static_cast<std::uint64_t>(n.y);
  return Int3(static_cast<int>(number % nx), static_cast<int>(number / nx % ny),
              static_cast<int>(number / nx / ny));
}

Int3 Partition::holding(const Int3& point) const {
  Int3 voxel;
  for (int k = 0; k < 3; ++k)
    voxel[k] =
        static_cast<int>(floor_divide(std::int64_t{point[k]} - grid.origin[k], std::int64_t{grid.size}));
  return voxel;
}

bool Partition::in_grid(const Int3& voxel) const {
  const Int3 n = grid.voxels();
  for (int k = 0; k < 3; ++k)
    if (voxel[k] < 0 || voxel[k] >= n[k]) return false;
  return true;
}

VoxelClass Partition::class_of(const Int3& point) const {
  const Int3 voxel = holding(point);
  return in_grid(voxel) ? classes.at(voxel) : VoxelClass::kExternal;
}

std::span<const std::uint32_t> Partition::listed(std::uint64_t number) const {
  const auto found = std::lower_bound(boundary_voxels.begin(), boundary_voxels.end(), number);
  if (found == boundary_voxels.end() || *found != number) return {};
  const auto i = static_cast<std::size_t>(found - boundary_voxels.begin());
  return std::span(list_triangles).subspan(list_begin[i], list_begin[i + 1] - list_begin[i]);
}

bool Partition::block_is_external(const Int3& begin, const Int3& end) const {
  const std::size_t brick = classes.brick_of(begin);
  return brick == classes.brick_of(end - Int3(1)) && classes.uniform(brick) &&
         classes.at(begin) == VoxelClass::kExternal;
}

Long3 Partition::to_nearest_external(const Int3& point) const {
  const Int3 size = grid.voxels();
  const Int3 home = glm::clamp(holding(point), Int3(0), size - Int3(1));
  const int last_shell = std::max({size.x, size.y, size.z});
  Int128 nearest = -1;
  std::uint64_t nearest_number = 0;
  // Cubic shells round the voxel nearest to the point. A voxel of shell r is at least (r − ½) voxels away.
  for (int shell = 0; shell <= last_shell; ++shell) {
    const Int128 least = Int128{2 * shell - 1} * grid.size;
    if (nearest >= 0 && shell > 0 && nearest < least * least) break;
    const Int3 low = glm::max(home - Int3(shell), Int3(0)),
               high = glm::min(home + Int3(shell), size - Int3(1));
    for (int z = low.z; z <= high.z; ++z)
      for (int y = low.y; y <= high.y; ++y) {
        const bool on_shell = std::abs(z - home.z) == shell || std::abs(y - home.y) == shell;
        for (int x = low.x; x <= high.x; ++x) {
          if (!on_shell && std::abs(x - home.x) != shell) {  // skip the shell's inside
            x = std::max(x, home.x + shell - 1);
            continue;
          }
          if (classes.at(Int3(x, y, z)) != VoxelClass::kExternal) continue;
          const std::uint64_t voxel_number = number(Int3(x, y, z));
          const Long3 away = difference(centre(Int3(x, y, z)), point) * std::int64_t{2};
          const Int128 distance = dot(away, away);
          if (nearest < 0 || distance < nearest || (distance == nearest && voxel_number < nearest_number)) {
            nearest = distance;
            nearest_number = voxel_number;
          }
        }
      }
  }
  return difference(centre(voxel(nearest_number)), point);  // the grid's border is V_ext: there is always one
}

Result<VoxelPartition> Partition::dense() const {
  const Int3 n = grid.voxels();
  const Int128 count = Int128{n.x} * n.y * n.z;
  if (count > Int128{kMaxDenseVoxels})
    return bad_value("The voxel grid has " + std::to_string(n.x) + " x " + std::to_string(n.y) + " x " +
                     std::to_string(n.z) + " voxels, too many to list one by one (limit " +
                     std::to_string(kMaxDenseVoxels) + ").");
  VoxelPartition out{grid, {}, boundary_voxels, list_begin, list_triangles};
  out.classes.reserve(static_cast<std::size_t>(count));
  for (int z = 0; z < n.z; ++z)
    for (int y = 0; y < n.y; ++y)
      for (int x = 0; x < n.x; ++x) out.classes.push_back(classes.at(Int3(x, y, z)));
  return out;
}

std::uint64_t Partition::memory_bytes() const {
  return classes.memory_bytes() + boundary_voxels.capacity() * sizeof(std::uint64_t) +
         list_begin.capacity() * sizeof(std::uint64_t) + list_triangles.capacity() * sizeof(std::uint32_t);
}

}  // namespace palpate::cpu_ref
