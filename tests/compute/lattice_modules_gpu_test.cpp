#include "cpu_ref/ray.h"
#include "cpu_ref/samples.h"
#include "cpu_ref/triangle_cube.h"
#include "tests/compute/module_test.h"

namespace palpate {
namespace {

using LatticeModules = ModuleTest;

/// The triangles of a run whose first two buffers are vertices and corners.
class Soup {
 public:
  explicit Soup(const ModuleRun& run)
      : vertices_(values_of<Int3>(run.buffers[0])), corners_(values_of<gpu::uvec3>(run.buffers[1])) {}
  cpu_ref::Triangle operator[](std::uint32_t t) const {
    return {vertices_[corners_[t].x], vertices_[corners_[t].y], vertices_[corners_[t].z]};
  }
  const gpu::uvec3& corners(std::uint32_t t) const { return corners_[t]; }

 private:
  std::vector<Int3> vertices_;
  std::vector<gpu::uvec3> corners_;
};

/// Calls visit(cell) for every cell of a grid, x fastest.
template <class Visit>
void for_each_cell(const Int3& cells, const Visit& visit) {
  for (int z = 0; z < cells.z; ++z)
    for (int y = 0; y < cells.y; ++y)
      for (int x = 0; x < cells.x; ++x) visit(Int3(x, y, z));
}

Int3 cell_of(std::uint32_t number, const Int3& cells) {
  const int i = static_cast<int>(number);
  return {i % cells.x, i / cells.x % cells.y, i / (cells.x * cells.y)};
}

cpu_ref::Box cube(const Int3& low, const Int3& high, std::int32_t growth) {
  cpu_ref::Box box;
  box.min = low - Int3(growth);
  box.max = high + Int3(growth);
  return box;
}

TEST_F(LatticeModules, CellsThatATriangleTouchesAreFound) {
  each("triangle_expand", spirv::triangle_expand, [](const ModuleRun& run, std::vector<Words>& want, auto&) {
    const auto push = push_as<gpu::ExpandPush>(run);
    const Soup soup(run);
    const bool items = push.source == gpu::kSourceItems;
    for (std::uint32_t i = 0; i < push.count; ++i) {
      const std::uint32_t t = items ? run.buffers[3][i] : i;
      const cpu_ref::Triangle triangle = soup[t];
      if (!items) {
        // Bricks that its box, not it, touches.
        std::int64_t bricks = 1;
        for (int k = 0; k < 3; ++k) {
          std::int64_t along = 0;
          for (int b = 0; b < push.bricks[k]; ++b) {
            const std::int32_t low = push.origin[k] + b * push.brick_side - push.growth,
                               high = push.origin[k] + (b + 1) * push.brick_side + push.growth;
            along += triangle.box().min[k] <= high && triangle.box().max[k] >= low ? 1 : 0;
          }
          bricks *= along;
        }
        const bool small = bricks <= gpu::kSmallCells;
        if ((run.buffers[2][t] & gpu::kInfoCollapsed) != 0 || small != (push.source == gpu::kSourceSmall)) {
          if (push.emit == 0) want[5][i] = 0;
          continue;
        }
      }
      std::uint32_t found = 0;
      for_each_cell(push.cells, [&](const Int3& cell) {
        if (items && cell / 8 != cell_of(run.buffers[4][i], push.parents)) return;
        const Int3 low = push.origin + cell * push.side,
                   high = glm::min(low + push.side, push.origin + push.bricks * push.brick_side);
        if (!cpu_ref::triangle_meets_box(triangle, cube(low, high, push.growth))) return;
        if (push.emit != 0) {
          want[6][run.buffers[5][i] + found] = t;
          want[7][run.buffers[5][i] + found] =
              static_cast<std::uint32_t>(cell.x + push.cells.x * (cell.y + push.cells.y * cell.z));
        }
        ++found;
      });
      if (push.emit == 0) want[5][i] = found;
    }
  });
}

TEST_F(LatticeModules, VoxelsThatATriangleTouchesAreMarkedAndListed) {
  each("voxel_list", spirv::voxel_list, [](const ModuleRun& run, std::vector<Words>& want, auto&) {
    const auto push = push_as<gpu::VoxelPush>(run);
    const Soup soup(run);
    auto bricks = values_of<gpu::Brick>(run.buffers[5]);
    for (std::uint32_t i = 0; i < push.count; ++i) {
      const std::uint32_t t = run.buffers[2][i], slot = run.buffers[4][run.buffers[3][i]];
      const Int3 corner = push.origin + 8 * push.size * cell_of(run.buffers[3][i], push.bricks);
      std::uint32_t found = 0;
      for_each_cell(Int3(8), [&](const Int3& voxel) {
        const Int3 low = corner + push.size * voxel;
        if (!cpu_ref::triangle_meets_box(soup[t], cube(low, low + push.size, push.growth))) return;
        const auto bit = static_cast<unsigned>(voxel.x + 8 * voxel.y + 64 * voxel.z);
        if (push.emit == 0) {
          bricks[slot].boundary[bit / 32] |= 1u << bit % 32;
        } else {
          const std::uint32_t number = slot * 512 + bit;  // all are boundary
          want[7][push.out_base + run.buffers[6][i] + found] = t;
          want[8][push.out_base + run.buffers[6][i] + found] = number;
          ++want[9][number];
        }
        ++found;
      });
      if (push.emit == 0) want[6][i] = found;
    }
    want[5] = words_of(bricks);
  });
}

/// Lower corner of a boundary voxel.
template <class Grid>
Int3 low_of(const Grid& grid, const Words& places, const Words& mixed, std::uint32_t voxel) {
  const std::uint32_t place = places[voxel];
  return grid.origin +
         grid.size * (8 * cell_of(mixed[place / 512], grid.bricks) + cell_of(place % 512, Int3(8)));
}

TEST_F(LatticeModules, LinesThroughCentresCrossAsTheReferencesRaysDo) {
  std::size_t crossed = 0;
  each("row_cross", spirv::row_cross, [&](const ModuleRun& run, std::vector<Words>& want, auto&) {
    struct Push {
      gpu::GridPush grid;
      std::uint32_t voxels;
    };
    const auto [grid, voxels] = push_as<Push>(run);
    const Soup soup(run);
    for (std::uint32_t pair = 0; pair < grid.count; ++pair) {
      const cpu_ref::Triangle triangle = soup[run.buffers[2][pair]];
      const std::uint32_t voxel = run.buffers[3][pair];
      const Int3 centre = low_of(grid, run.buffers[4], run.buffers[5], voxel) + grid.size / 2;
      for (std::uint32_t axis = 0; axis < grid.axis; ++axis) {
        const int k = static_cast<int>(axis);
        Int3 along(0);
        along[k] = 1;
        const int facing = cpu_ref::line_passes(centre, along, triangle);
        if (facing == 0) continue;
        // It crosses at centre + s · along with s = side / N_k, in [−size/2, size/2)?
        const cpu_ref::Int128 side = -triangle.side(centre) * facing,
                              half = cpu_ref::Int128{triangle.normal[k]} * facing * (grid.size / 2);
        if (side < -half || side >= half) continue;
        want[6][voxels * axis + voxel] += static_cast<std::uint32_t>(facing);
        ++crossed;
      }
    }
  });
  EXPECT_GT(crossed, 1000u);
}

TEST_F(LatticeModules, HalvesOfVoxelsAreCrossedAsTheReferencesRaysAre) {
  std::size_t crossed = 0;
  each("half_cross", spirv::half_cross, [&](const ModuleRun& run, std::vector<Words>& want, auto&) {
    const auto push = push_as<gpu::GridPush>(run);
    const Soup soup(run);
    Int3 along(0);
    along[static_cast<int>(push.axis)] = 1;
    for (std::uint32_t pair = 0; pair < push.count; ++pair) {
      const std::uint32_t id = run.buffers[3][pair], voxel = run.buffers[4][pair];
      if ((run.buffers[2][id] & (gpu::kInfoCollapsed | gpu::kInfoSheet)) != 0) continue;
      // What a ray from one place meets and one from the next place does not lies between them.
      const Int3 middle = low_of(push, run.buffers[5], run.buffers[6], voxel) + push.size / 2;
      const auto ahead = [&](int half) {
        const auto crossing = cpu_ref::ray_crosses(middle + along * (half * push.size / 2), along, soup[id]);
        return crossing ? crossing->sign : 0;
      };
      const int before = ahead(-1) - ahead(0), behind = ahead(0) - ahead(1);
      want[7][2 * voxel] += static_cast<std::uint32_t>(before);
      want[7][2 * voxel + 1] += static_cast<std::uint32_t>(behind);
      crossed += before != 0 || behind != 0 ? 1 : 0;
    }
  });
  EXPECT_GT(crossed, 500u);
}

TEST_F(LatticeModules, SamplesOfAVoxelAreTheReferences) {
  std::size_t samples = 0, corners = 0;
  each("sample_list", spirv::sample_list, [&](const ModuleRun& run, std::vector<Words>& want, auto&) {
    const auto push = push_as<gpu::SampleListPush>(run);
    const Soup soup(run);
    for (std::uint32_t i = push.first; i < push.first + push.count; ++i) {
      const std::uint32_t t = run.buffers[4][i];
      const cpu_ref::Triangle triangle = soup[t];
      const int k = static_cast<int>(run.buffers[2][t] >> gpu::kInfoAxisShift & 3), u = (k + 1) % 3,
                v = (k + 2) % 3;
      const Int3 low = low_of(push, run.buffers[5], run.buffers[6], run.buffers[3][i]),
                 last = low + (push.size - 1);
      const auto cell = [&](std::int32_t place) {
        return cpu_ref::floor_divide(std::int64_t{place}, std::int64_t{push.spacing});
      };
      std::uint32_t count = 0;
      for (std::int64_t j = cell(low[v]); j <= cell(last[v]); ++j)
        for (std::int64_t i_u = cell(low[u]); i_u <= cell(last[u]); ++i_u) {
          const auto [g_u, g_v] = cpu_ref::sample_of({i_u, j}, push.spacing);
          if (g_u < low[u] || g_u > last[u] || g_v < low[v] || g_v > last[v] ||
              !cpu_ref::projection_holds(triangle, k, g_u, g_v))
            continue;
          const std::int32_t height = cpu_ref::raised(triangle, k, g_u, g_v)[k] - low[k];
          if (height < 0 || height >= push.size) continue;
          if (run.constants[0] != 0) {
            const auto place = static_cast<std::uint32_t>(i_u - cell(low[u]) + (j - cell(low[v])) * 64);
            const std::size_t at = run.buffers[7][i] - push.base + count;
            if (push.wide != 0) {
              want[8][2 * at] = static_cast<std::uint32_t>(height);
              want[8][2 * at + 1] = place;
            } else {
              want[8][at] = static_cast<std::uint32_t>(height) | place << 20;
            }
          }
          ++count;
        }
      samples += count;
      if (run.constants[0] == 0) {
        want[7][i] = count;
        continue;
      }
      bool corner = true;
      for (int axis = 0; axis < 3; ++axis)
        corner = corner && triangle[0][axis] >= low[axis] && triangle[0][axis] <= last[axis];
      corners += corner ? 1 : 0;
      want[7][i] +=
          (corner ? gpu::kSampleCorner : 0) + (static_cast<std::uint32_t>(k) << gpu::kSampleAxisShift);
    }
  });
  EXPECT_GT(samples, 1000u);
  EXPECT_GT(corners, 50u);
}

}  // namespace
}  // namespace palpate
