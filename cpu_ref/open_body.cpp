#include "cpu_ref/open_body.h"

#include <algorithm>
#include <array>

#include "cpu_ref/direction.h"
#include "cpu_ref/ray.h"

namespace palpate::cpu_ref {
namespace {

constexpr int kNear = 8;  // voxels (docs/EXACTNESS.md section 4)

}  // namespace

VoxelClass OpenBody::kind_of(const Int3& voxel) const {
  return partition_.in_grid(voxel) ? partition_.classes.at(voxel) : VoxelClass::kExternal;
}

/// Σ of the signs of the crossings between a lattice point and another, with triangles that bound a solid.
int OpenBody::crossed(const Int3& from, const Int3& to) const {
  if (from == to) return 0;
  const Int3 direction = to - from;
  std::vector<std::uint32_t> candidates;
  tree_.along_ray(from, direction, candidates);
  int net = 0;
  for (const std::uint32_t t : candidates) {
    if (mesh_.collapsed(t) || is_sheet(mesh_, t)) continue;
    const Triangle triangle = triangle_of(mesh_, t);
    // What is crossed beyond the end is crossed from there, too.
    const auto crossing = ray_crosses(from, direction, triangle);
    if (crossing && !ray_crosses(to, direction, triangle)) net += crossing->sign;
  }
  return net;
}

/// How many shells a voxel's middle is in. Of a V_bnd voxel six walks to the next voxels that are not V_bnd
/// say so; the one that says least is right, a near one before all that are far.
int OpenBody::shells(const Int3& voxel) {
  if (kind_of(voxel) != VoxelClass::kBoundary) return kind_of(voxel) == VoxelClass::kInternal ? 1 : 0;
  const auto [known, first] = shells_.try_emplace(partition_.number(voxel), 0);
  if (!first) return known->second;
  struct Said {
    bool far;
    int shells;
  };
  std::array<Said, 6> said{};
  for (std::size_t i = 0; i < 6; ++i) {
    const int axis = static_cast<int>(i / 2), step = i % 2 == 0 ? 1 : -1;
    Int3 end = voxel;
    VoxelClass kind = VoxelClass::kBoundary;
    int length = 0;
    for (; kind == VoxelClass::kBoundary; ++length) {
      end[axis] += step;
      kind = kind_of(end);
    }
    Int3 until = partition_.centre(voxel);
    until[axis] += step * length * partition_.grid.size;
    said[i] = {length > kNear,
               crossed(partition_.centre(voxel), until) + (kind == VoxelClass::kInternal ? 1 : 0)};
  }
  return known->second = std::min_element(said.begin(), said.end(), [](const Said& a, const Said& b) {
                           return a.far != b.far ? b.far : a.shells < b.shells;
                         })->shells;
}

int OpenBody::shells_at(const Int3& point) {
  const Int3 voxel = partition_.holding(point);
  if (kind_of(voxel) != VoxelClass::kBoundary) return shells(voxel);
  return shells(voxel) + crossed(point, partition_.centre(voxel));
}

bool OpenBody::has_inside() {
  if (partition_.has_internal) return true;
  const auto bounds = [&](std::uint32_t t) { return !mesh_.collapsed(t) && !is_sheet(mesh_, t); };
  std::uint32_t face = 0;
  while (face < mesh_.triangles.size() && !bounds(face)) ++face;
  if (face == mesh_.triangles.size()) return false;
  std::size_t inside = 0, in_doubt = 0;
  for (const std::uint64_t number : partition_.boundary_voxels) {
    const Int3 voxel = partition_.voxel(number);
    if (shells(voxel) > 0) ++inside;
    if (is_doubted(voxel)) ++in_doubt;
  }
  const std::size_t all = partition_.boundary_voxels.size();
  return 8 * inside >= all || 16 * in_doubt <= all;
}

/// Whether a neighbour and a voxel say different things of one of the two.
bool OpenBody::is_doubted(const Int3& voxel) {
  for (int z = -1; z <= 1; ++z)
    for (int y = -1; y <= 1; ++y)
      for (int x = -1; x <= 1; ++x) {
        const Int3 to(x, y, z);
        if (to != Int3(0) && (says_less(voxel + to, voxel) || says_less(voxel, voxel + to))) return true;
      }
  return false;
}

bool OpenBody::inside(const Int3& point) { return shells_at(point) > 0; }

/// What lies between the middles of two neighbours, the first of a smaller number: along x, then y, then z.
int OpenBody::way(Int3 from, const Int3& to) {
  int net = 0;
  for (int k = 0; k < 3; ++k) {
    if (from[k] == to[k]) continue;
    const bool up = from[k] < to[k];
    Int3 next = from;
    next[k] = to[k];
    const Int3& low = up ? from : next;
    const Int3& high = up ? next : from;
    const auto [known, first] =
        ways_.try_emplace(3 * partition_.number(low) + static_cast<std::uint64_t>(k), 0);
    if (first) known->second = crossed(partition_.centre(low), partition_.centre(high));
    net += up ? known->second : -known->second;
    from = next;
  }
  return net;
}

/// Whether a voxel's middle is, as a neighbour sees it, in fewer shells than as it sees itself.
bool OpenBody::says_less(const Int3& voxel, const Int3& than) {
  if (kind_of(voxel) != VoxelClass::kBoundary && kind_of(than) != VoxelClass::kBoundary) return false;
  const int here = shells(than), there = shells(voxel);
  return partition_.number(than) < partition_.number(voxel) ? there + way(than, voxel) < here
                                                            : there < here + way(voxel, than);
}

std::uint32_t OpenBody::sure(std::uint32_t weight, const Int3& point) {
  if (shells_at(point) != 1) return weight;
  const Int3 own = partition_.holding(point);
  const std::int64_t size = partition_.grid.size;
  const Int3 in = point - (partition_.grid.origin + partition_.grid.size * own);
  std::int64_t nearest = size;  // twice the way to the nearest of those who say less
  for (int z = -1; z <= 1; ++z)
    for (int y = -1; y <= 1; ++y)
      for (int x = -1; x <= 1; ++x) {
        const Int3 to(x, y, z);
        std::int64_t distance = 0;
        for (int k = 0; k < 3; ++k)
          distance = std::max(distance, to[k] == 0 ? 0 : to[k] < 0 ? in[k] : size - in[k]);
        if (to != Int3(0) && 2 * distance < nearest && says_less(own + to, own)) nearest = 2 * distance;
      }
  if (nearest == size) return weight;
  return static_cast<std::uint32_t>((weight * (nearest * ((std::int64_t{1} << 31) / size))) >> 31);
}

/// About: a table's entries lie in nodes of their own.
std::uint64_t OpenBody::memory_bytes() const {
  return (shells_.size() + ways_.size()) * (sizeof(std::pair<const std::uint64_t, int>) + 2 * sizeof(void*));
}

}  // namespace palpate::cpu_ref
