#include <set>

#include "cpu_ref/ray.h"
#include "cpu_ref/samples.h"
#include "cpu_ref/triangle_cube.h"
#include "cpu_ref/triangle_triangle.h"
#include "tests/compute/module_test.h"

namespace palpate {
namespace {

using LatticeModules = ModuleTest;

/// The triangles of a run whose first two buffers are vertices and corners.
class Soup {
 public:
  explicit Soup(const ModuleRun& run) : vertices_(values_of<Int3>(run.buffers[0])), corners_(values_of<gpu::uvec3>(run.buffers[1])) {}
  cpu_ref::Triangle operator[](std::uint32_t t) const { return {vertices_[corners_[t].x], vertices_[corners_[t].y], vertices_[corners_[t].z]}; }
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
            const std::int32_t low = push.origin[k] + b * push.brick_side - push.growth, high = push.origin[k] + (b + 1) * push.brick_side + push.growth;
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
        const Int3 low = push.origin + cell * push.side, high = glm::min(low + push.side, push.origin + push.bricks * push.brick_side);
        if (!cpu_ref::triangle_meets_box(triangle, cube(low, high, push.growth))) return;
        if (push.emit != 0) {
          want[6][run.buffers[5][i] + found] = t;
          want[7][run.buffers[5][i] + found] = static_cast<std::uint32_t>(cell.x + push.cells.x * (cell.y + push.cells.y * cell.z));
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
          const std::uint32_t number = slot * 512 + bit;   // all are boundary
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
  return grid.origin + grid.size * (8 * cell_of(mixed[place / 512], grid.bricks) + cell_of(place % 512, Int3(8)));
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
        const cpu_ref::Int128 side = -triangle.side(centre) * facing, half = cpu_ref::Int128{triangle.normal[k]} * facing * (grid.size / 2);
        if (side < -half || side >= half) continue;
        want[6][voxels * axis + voxel] += static_cast<std::uint32_t>(facing);
        ++crossed;
      }
    }
  });
  EXPECT_GT(crossed, 1000u);
}

TEST_F(LatticeModules, SamplesOfAVoxelAreTheReferences) {
  std::size_t samples = 0, corners = 0;
  each("sample_list", spirv::sample_list, [&](const ModuleRun& run, std::vector<Words>& want, auto&) {
    const auto push = push_as<gpu::SampleListPush>(run);
    const Soup soup(run);
    for (std::uint32_t i = push.first; i < push.first + push.count; ++i) {
      const std::uint32_t t = run.buffers[4][i];
      const cpu_ref::Triangle triangle = soup[t];
      const int k = static_cast<int>(run.buffers[2][t] >> gpu::kInfoAxisShift & 3), u = (k + 1) % 3, v = (k + 2) % 3;
      const Int3 low = low_of(push, run.buffers[5], run.buffers[6], run.buffers[3][i]), last = low + (push.size - 1);
      const auto from = [&](int axis) { return -cpu_ref::floor_divide(-std::int64_t{low[axis]}, std::int64_t{push.spacing}) * push.spacing; };
      std::uint32_t count = 0;
      for (std::int64_t g_v = from(v); g_v <= last[v]; g_v += push.spacing)
        for (std::int64_t g_u = from(u); g_u <= last[u]; g_u += push.spacing) {
          if (!cpu_ref::projection_holds(triangle, k, g_u, g_v)) continue;
          const std::int32_t height = cpu_ref::raised(triangle, k, g_u, g_v)[k] - low[k];
          if (height < 0 || height >= push.size) continue;
          if (run.constants[0] != 0) {
            const auto place = static_cast<std::uint32_t>((g_u - from(u)) / push.spacing + (g_v - from(v)) / push.spacing * 64);
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
      for (int axis = 0; axis < 3; ++axis) corner = corner && triangle[0][axis] >= low[axis] && triangle[0][axis] <= last[axis];
      corners += corner ? 1 : 0;
      want[7][i] += (corner ? gpu::kSampleCorner : 0) + (static_cast<std::uint32_t>(k) << gpu::kSampleAxisShift);
    }
  });
  EXPECT_GT(samples, 1000u);
  EXPECT_GT(corners, 50u);
}

TEST_F(LatticeModules, ABoxTakesTheTenthsThatItReaches) {
  each("seam_box", spirv::seam_box, [](const ModuleRun& run, std::vector<Words>& want, auto&) {
    const auto push = push_as<gpu::GridPush>(run);
    const Soup soup(run);
    for (std::uint32_t i = 0; i < push.count; ++i) {
      const cpu_ref::Box box = soup[run.buffers[3][i]].box();
      const Int3 low = low_of(push, run.buffers[4], run.buffers[5], run.buffers[2][i]);
      want[6][i] = 0;
      for (int k = 0; k < 3; ++k)
        for (int tenth = 0; tenth < 10; ++tenth) {
          // Half-open, but the last one.
          const std::int32_t begin = low[k] + tenth * push.size / 10, end = low[k] + (tenth + 1) * push.size / 10;
          const bool reached = (box.max[k] >= begin || tenth == 0) && (box.min[k] < end || tenth == 9);
          if (reached) want[6][i] |= 1u << (10 * k + tenth);
        }
    }
  });
}

/// Whether two triangles that share no edge touch in more than a common corner; and how many corners they share.
struct Touch {
  int common = 0;
  bool touches = false;
  Touch(const Soup& soup, std::uint32_t s, std::uint32_t t) {
    int of_s = 0, of_t = 0;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        if (soup.corners(s)[i] == soup.corners(t)[j]) ++common, of_s = i, of_t = j;
    const cpu_ref::Triangle a = soup[s], b = soup[t];
    touches = common == 0 ? cpu_ref::triangles_intersect(a, b)
                          : common == 1 && (cpu_ref::segment_meets_triangle(a[(of_s + 1) % 3], a[(of_s + 2) % 3], b) ||
                                            cpu_ref::segment_meets_triangle(b[(of_t + 1) % 3], b[(of_t + 2) % 3], a));
  }
};

TEST_F(LatticeModules, CandidatesForSeamsAreAllThatTouchAndNoneThatCannot) {
  std::size_t candidates = 0, full = 0;
  each("seam_find", spirv::seam_find, [&](const ModuleRun& run, std::vector<Words>& want, std::vector<Words>& got) {
    using Pair = std::array<std::uint32_t, 2>;
    const auto push = push_as<gpu::SeamPush>(run);
    const Soup soup(run);
    const auto normals = values_of<Int3>(run.buffers[2]);
    std::set<Pair> may, must;
    for (std::uint32_t i = push.first; i < push.first + push.count; ++i) {
      const std::uint32_t first = i + 1 + push.round * gpu::kSeamSpan, s = run.buffers[4][i];
      for (std::uint32_t j = first; j < std::min(first + gpu::kSeamSpan, run.buffers[3][run.buffers[8][i] + 1]); ++j) {
        const std::uint32_t t = run.buffers[4][j], both = run.buffers[7][i] & run.buffers[7][j];
        const Long3 a(normals[s]), b(normals[t]);
        bool near = a.x * b.x + a.y * b.y + a.z * b.z >= push.least_cosine;
        for (int k = 0; k < 3; ++k) near = near && (both >> (10 * k) & 1023) != 0;
        if (!near || !soup[s].box().meets(soup[t].box())) continue;
        const Touch touch(soup, s, t);
        if (touch.common > 1) continue;
        may.insert({s, t});
        if (touch.common == 0 || touch.touches) must.insert({s, t});
      }
    }
    const std::uint32_t found = got[5][0];
    candidates += found;
    EXPECT_GE(found, must.size());
    EXPECT_LE(found, may.size());
    std::set<Pair> listed;
    std::size_t others = 0;
    for (const Pair& pair : values_of<Pair>(got[6])) {
      if (pair == Pair{lattice_cases::kUntouched, lattice_cases::kUntouched}) {
        ++others;
        continue;
      }
      listed.insert(pair);
      EXPECT_TRUE(may.contains(pair)) << pair[0] << ", " << pair[1];
    }
    const std::size_t written = std::min(found, push.capacity);
    EXPECT_EQ(listed.size(), written);   // each once
    EXPECT_EQ(others, want[6].size() / 2 - written);
    full += found > push.capacity ? 1 : 0;
    EXPECT_TRUE(found > push.capacity || std::includes(listed.begin(), listed.end(), must.begin(), must.end()));
    want[5] = got[5];
    want[6] = got[6];
  });
  EXPECT_GT(candidates, 1000u);
  EXPECT_EQ(full, 1u);
}

TEST_F(LatticeModules, PairsThatTouchAlongASeamAreTheReferences) {
  std::size_t touching = 0;
  each("seam_test", spirv::seam_test, [&](const ModuleRun& run, std::vector<Words>& want, auto&) {
    const Soup soup(run);
    for (std::uint32_t i = 0; i < run.push[0]; ++i) {
      const std::uint32_t s = run.buffers[2][2 * i], t = run.buffers[2][2 * i + 1];
      want[3][i] = Touch(soup, s, t).touches ? 1 : 0;
      touching += want[3][i];
    }
  });
  EXPECT_GT(touching, 500u);
}

}  // namespace
}  // namespace palpate
