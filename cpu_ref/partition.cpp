#include "cpu_ref/partition.h"

#include <algorithm>
#include <string>

#include "cpu_ref/touched_voxels.h"

namespace palpate::cpu_ref {
namespace {

// Beside the three classes, a voxel under way is one of these, plus its ballots of non-zero winding (0 to 3).
constexpr VoxelClass kUndecided{8};    ///< not V_bnd; enclosed, once V_ext is known
constexpr VoxelClass kCounted{16};     ///< enclosed, its component's ballots are being counted

/// Visits the voxels connected through faces with `start` for which inside(class) holds; mark(class&) must end that.
template <class Inside, class Mark>
void flood(const Int3& size, std::vector<VoxelClass>& classes, std::uint64_t start, const Inside& inside, const Mark& mark) {
  const auto nx = static_cast<std::uint64_t>(size.x), ny = static_cast<std::uint64_t>(size.y), nz = static_cast<std::uint64_t>(size.z);
  std::vector<std::uint64_t> seeds{start};
  while (!seeds.empty()) {
    const std::uint64_t seed = seeds.back();
    seeds.pop_back();
    if (!inside(classes[seed])) continue;
    // A whole run along x at once, then one seed for each run that touches it from the four rows beside it.
    const std::uint64_t row = seed / nx, row_begin = row * nx, y = row % ny, z = row / ny;
    std::uint64_t begin = seed, end = seed + 1;
    while (begin > row_begin && inside(classes[begin - 1])) --begin;
    while (end < row_begin + nx && inside(classes[end])) ++end;
    for (std::uint64_t v = begin; v < end; ++v) mark(classes[v]);
    const auto look_at = [&](bool exists, std::uint64_t shift) {   // unsigned wrap-around takes a row back too
      if (!exists) return;
      for (std::uint64_t v = begin; v < end; ++v)
        if (inside(classes[v + shift]) && (v == begin || !inside(classes[v + shift - 1]))) seeds.push_back(v + shift);
    };
    look_at(y > 0, ~nx + 1);
    look_at(y + 1 < ny, nx);
    look_at(z > 0, ~(nx * ny) + 1);
    look_at(z + 1 < nz, nx * ny);
  }
}

void list_boundary(const LatticeMesh& mesh, std::int32_t grow, Partition& partition) {
  VoxelPartition& out = partition.voxels;
  std::vector<std::pair<std::uint64_t, std::uint32_t>> touched;   // voxel, triangle
  for (std::uint32_t id = 0; id < mesh.triangles.size(); ++id) {
    if (mesh.collapsed(id)) continue;
    for_each_touched_voxel(
        triangle_of(mesh, id), out.grid, grow, [](const Int3&, const Int3&) { return true; },
        [&](const Int3& voxel) { touched.emplace_back(partition.number(voxel), id); });
  }
  std::sort(touched.begin(), touched.end());
  for (const auto& [voxel, triangle] : touched) {
    if (out.boundary_voxels.empty() || out.boundary_voxels.back() != voxel) {
      out.boundary_voxels.push_back(voxel);
      out.list_begin.push_back(out.list_triangles.size());
      out.classes[voxel] = VoxelClass::kBoundary;
    }
    out.list_triangles.push_back(triangle);
  }
  out.list_begin.push_back(out.list_triangles.size());
}

/// Everything connected to the grid's border is V_ext.
void flood_external(const Int3& size, std::vector<VoxelClass>& classes) {
  const auto undecided = [](VoxelClass c) { return c == kUndecided; };
  const auto external = [](VoxelClass& c) { c = VoxelClass::kExternal; };
  const auto number = [&](int x, int y, int z) {
    return static_cast<std::uint64_t>(x) +
           static_cast<std::uint64_t>(size.x) * (static_cast<std::uint64_t>(y) + static_cast<std::uint64_t>(size.y) * static_cast<std::uint64_t>(z));
  };
  for (int z = 0; z < size.z; ++z)
    for (int y = 0; y < size.y; ++y) {
      const bool face = z == 0 || z == size.z - 1 || y == 0 || y == size.y - 1;
      for (int x = 0; x < size.x; x += face || size.x == 1 ? 1 : size.x - 1)
        if (undecided(classes[number(x, y, z)])) flood(size, classes, number(x, y, z), undecided, external);
    }
}

/// Gives every enclosed component the class of its vote. Returns whether any is V_int.
bool count_votes(const Int3& size, int directions, std::vector<VoxelClass>& classes) {
  const auto enclosed = [](VoxelClass c) { return c >= kUndecided && c < kCounted; };
  const auto counted = [](VoxelClass c) { return c >= kCounted; };
  bool any_internal = false;
  for (std::uint64_t v = 0; v < classes.size(); ++v) {
    if (!enclosed(classes[v])) continue;
    std::uint64_t ballots = 0, non_zero = 0;
    flood(size, classes, v, enclosed, [&](VoxelClass& c) {
      const int winding_ballots = static_cast<int>(c) - static_cast<int>(kUndecided);
      ballots += static_cast<std::uint64_t>(directions);
      non_zero += static_cast<std::uint64_t>(winding_ballots);
      c = kCounted;
    });
    const bool internal = non_zero > ballots - non_zero;
    any_internal = any_internal || internal;
    flood(size, classes, v, counted, [&](VoxelClass& c) { c = internal ? VoxelClass::kInternal : VoxelClass::kExternal; });
  }
  return any_internal;
}

void mark_external_bricks(Partition& partition) {
  const Int3 bricks = partition.voxels.grid.bricks, size = partition.voxels.grid.voxels();
  partition.brick_is_external.assign(static_cast<std::size_t>(bricks.x) * static_cast<std::size_t>(bricks.y) * static_cast<std::size_t>(bricks.z), true);
  std::uint64_t v = 0;
  for (int z = 0; z < size.z; ++z)
    for (int y = 0; y < size.y; ++y)
      for (int x = 0; x < size.x; ++x, ++v)
        if (partition.voxels.classes[v] != VoxelClass::kExternal) {
          const std::int64_t brick = x / kBrickSide + std::int64_t{bricks.x} * (y / kBrickSide + std::int64_t{bricks.y} * (z / kBrickSide));
          partition.brick_is_external[static_cast<std::size_t>(brick)] = false;
        }
}

}  // namespace

Result<Partition> make_partition(const LatticeMesh& mesh, const VoxelGrid& grid, std::int32_t grow, const Progress& progress) {
  const Int3 size = grid.voxels();
  const Int128 count = Int128{size.x} * size.y * size.z;
  if (count > Int128{kMaxVoxels})
    return bad_value("The voxel grid has " + std::to_string(size.x) + " x " + std::to_string(size.y) + " x " + std::to_string(size.z) +
                     " voxels, which is more than the CPU reference keeps (" + std::to_string(kMaxVoxels) + "): choose larger voxels.");
  const Error stopped{ErrorCode::kUsage, "Preparation was cancelled."};
  const auto go_on = [&](double done) { return !progress || progress("voxel partition", done); };

  Partition partition;
  partition.voxels.grid = grid;
  std::vector<VoxelClass>& classes = partition.voxels.classes;
  classes.assign(static_cast<std::size_t>(count), kUndecided);
  if (!go_on(0)) return stopped;
  list_boundary(mesh, grow, partition);
  if (!go_on(0.5)) return stopped;
  flood_external(size, classes);
  if (std::find(classes.begin(), classes.end(), kUndecided) != classes.end()) {
    const int directions = mesh.closed ? 1 : 3;
    for (int axis = 0; axis < directions; ++axis) cast_ballots(mesh, grid, axis, kUndecided, classes);
    if (!go_on(0.8)) return stopped;
    partition.has_internal = count_votes(size, directions, classes);
  }
  mark_external_bricks(partition);
  if (!go_on(1)) return stopped;
  return partition;
}

Int3 Partition::voxel(std::uint64_t number) const {
  const Int3 n = voxels.grid.voxels();
  const auto nx = static_cast<std::uint64_t>(n.x), ny = static_cast<std::uint64_t>(n.y);
  return Int3(static_cast<int>(number % nx), static_cast<int>(number / nx % ny), static_cast<int>(number / nx / ny));
}

Int3 Partition::holding(const Int3& point) const {
  Int3 voxel;
  for (int k = 0; k < 3; ++k)
    voxel[k] = static_cast<int>(floor_divide(std::int64_t{point[k]} - voxels.grid.origin[k], std::int64_t{voxels.grid.size}));
  return voxel;
}

bool Partition::in_grid(const Int3& voxel) const {
  const Int3 n = voxels.grid.voxels();
  for (int k = 0; k < 3; ++k)
    if (voxel[k] < 0 || voxel[k] >= n[k]) return false;
  return true;
}

VoxelClass Partition::class_of(const Int3& point) const {
  const Int3 voxel = holding(point);
  return in_grid(voxel) ? voxels.classes[number(voxel)] : VoxelClass::kExternal;
}

std::span<const std::uint32_t> Partition::listed(std::uint64_t number) const {
  const auto found = std::lower_bound(voxels.boundary_voxels.begin(), voxels.boundary_voxels.end(), number);
  if (found == voxels.boundary_voxels.end() || *found != number) return {};
  const auto i = static_cast<std::size_t>(found - voxels.boundary_voxels.begin());
  return std::span(voxels.list_triangles).subspan(voxels.list_begin[i], voxels.list_begin[i + 1] - voxels.list_begin[i]);
}

bool Partition::block_is_external(const Int3& begin, const Int3& end) const {
  const Int3 brick = begin / kBrickSide, last = (end - Int3(1)) / kBrickSide, bricks = voxels.grid.bricks;
  return brick == last && brick_is_external[static_cast<std::size_t>(brick.x + std::int64_t{bricks.x} * (brick.y + std::int64_t{bricks.y} * brick.z))];
}

Long3 Partition::to_nearest_external(const Int3& point) const {
  const Int3 size = voxels.grid.voxels();
  const Int3 home = glm::clamp(holding(point), Int3(0), size - Int3(1));
  const int last_shell = std::max({size.x, size.y, size.z});
  Int128 nearest = -1;
  std::uint64_t nearest_number = 0;
  // Cubic shells round the voxel nearest to the point. A voxel of shell r is at least (r − ½) voxels away.
  for (int shell = 0; shell <= last_shell; ++shell) {
    const Int128 least = Int128{2 * shell - 1} * voxels.grid.size;
    if (nearest >= 0 && shell > 0 && nearest < least * least) break;
    const Int3 low = glm::max(home - Int3(shell), Int3(0)), high = glm::min(home + Int3(shell), size - Int3(1));
    for (int z = low.z; z <= high.z; ++z)
      for (int y = low.y; y <= high.y; ++y) {
        const bool on_shell = std::abs(z - home.z) == shell || std::abs(y - home.y) == shell;
        for (int x = low.x; x <= high.x; ++x) {
          if (!on_shell && std::abs(x - home.x) != shell) {   // skip the shell's inside
            x = std::max(x, home.x + shell - 1);
            continue;
          }
          const std::uint64_t voxel_number = number(Int3(x, y, z));
          if (voxels.classes[voxel_number] != VoxelClass::kExternal) continue;
          const Long3 away = difference(centre(Int3(x, y, z)), point) * std::int64_t{2};
          const Int128 distance = dot(away, away);
          if (nearest < 0 || distance < nearest || (distance == nearest && voxel_number < nearest_number)) {
            nearest = distance;
            nearest_number = voxel_number;
          }
        }
      }
  }
  return difference(centre(voxel(nearest_number)), point);   // the grid's border is V_ext: there is always one
}

std::uint64_t Partition::memory_bytes() const {
  return voxels.classes.capacity() * sizeof(VoxelClass) + voxels.boundary_voxels.capacity() * sizeof(std::uint64_t) +
         voxels.list_begin.capacity() * sizeof(std::uint64_t) + voxels.list_triangles.capacity() * sizeof(std::uint32_t) +
         brick_is_external.capacity() / 8;
}

}  // namespace palpate::cpu_ref
