#include "compute/native/prepare/scene.h"

#include <algorithm>
#include <utility>

#include "compute/native/prepare/partition_build.h"
#include "compute/native/prepare/sample_lists.h"
#include "compute/scene/scene_constants.h"
#include "compute/scene/search_tables.h"
#include "compute/scene/tool_solid.h"
#include "model/mesh/orientation.h"
#include "model/scene/geometry_build.h"

namespace palpate::native {
namespace {

constexpr std::uint64_t kMostSampleBytes = std::uint64_t{1} << 30;  // chosen

/// The mock-up's samples; null where they are too many. False: cancelled.
bool make_samples(const SceneGeometry& geometry, const Progress& progress, Scene& out) {
  const auto told = [&](double from, double part) {
    return
        [&progress, from, part](double done) { return !progress || progress("samples", from + part * done); };
  };
  EntrySamples by_entry;
  auto samples = std::make_shared<VoxelSamples>();
  Listing listing = list_samples(geometry.mockup, out.mockup, geometry.sample_spacing, kMostSampleBytes,
                                 told(0.6, 0.25), by_entry);
  if (listing == Listing::kDone)
    listing = list_points(geometry.mockup, out.mockup, geometry.sample_spacing, told(0.85, 0.15),
                          std::move(by_entry), *samples);
  if (listing == Listing::kDone) out.samples = std::move(samples);
  return listing != Listing::kCancelled;
}

}  // namespace

SceneTables Scene::tables() const {
  SceneTables out;
  out.constants = constants;
  out.mockup = mockup;
  out.tool = tool;
  out.fine = finest();
  out.fine_exit = fine_exit;
  out.tool_near = tool_near;
  out.samples = samples;
  out.search = search;
  return out;
}

void Scene::know(const SceneGeometry& geometry) {
  if (mockup_shells) {
    auto made = std::make_shared<OpenInside>();
    made->shells = mockup_shells;
    open.mockup = std::move(made);
  }
  if (tool_shells)
    open.tool =
        OpenInside::make(geometry.tool, tool, SearchTables::boxes_of(geometry.tool, tool), tool_shells);
}

std::uint64_t Scene::bytes() const {
  return mockup.bytes() + tool.bytes() + fine.bytes() +
         4 * (std::uint64_t{fine_exit.size()} + tool_near.size()) + (samples ? samples->bytes() : 0) +
         (search ? search->bytes() : 0) + open.bytes();
}

std::uint64_t most_sample_bytes(const SceneGeometry& geometry) {
  constexpr double kMoreSamples = 1.1,
                   kMoreVoxels = 1.5;  // over what areas let expect, as of a scene's lists
  const double voxel = geometry.mockup_grid.size, spacing = geometry.sample_spacing,
               area = geometry.mockup_surface.area,
               words = geometry.mockup_grid.size > VoxelSamples::kNarrowVoxel ? 8 : 4,
               most = static_cast<double>(kMostSampleBytes) / words,  // with more of them none is kept
      samples = std::min(kMoreSamples * area / (spacing * spacing), most),
               corners = static_cast<double>(geometry.mockup.triangles.size());
  // By entry there are words alone, twice while they are joined; then these, and points with what belongs to
  // them.
  return static_cast<std::uint64_t>(2 * words * samples + 6 * (samples + corners) + 2 * corners +
                                    sizeof(VoxelSamples::Begin) * kMoreVoxels * area / (voxel * voxel));
}

Result<Scene> prepare_scene(const SceneGeometry& geometry, const Plan& plan, const Progress& progress) {
  Scene out;
  const char* what = "voxel lists";
  double done = 0;
  const GoOn go_on = [&] { return !progress || progress(what, done); };
  const auto at = [&](const char* stage, double share) {
    what = stage;
    done = share;
    return go_on();
  };

  auto mockup = make_partition(geometry.mockup, geometry.mockup_grid, 0, "mock-up", go_on);
  if (!mockup) return mockup.error();
  out.mockup = std::move(*mockup);

  if (!at("tool", 0.3)) return cancelled();
  const auto of_tool = [&](const VoxelGrid& grid) {
    return make_partition(geometry.tool, grid, gpu::kToolVoxelGrowth, "tool", go_on);
  };
  auto tool = of_tool(geometry.tool_grid);
  if (!tool) return tool.error();
  out.tool = std::move(*tool);
  if (const std::int32_t size = fine_voxel_size(geometry, out.tool.grid); size != 0) {
    auto fine = of_tool(make_grid(geometry.tool.box_min, geometry.tool.box_max, size));
    if (!fine) return fine.error();
    out.fine = std::move(*fine);
  }
  out.tool_near = near_tool(out.finest(), out.tool.grid.size);
  if (geometry.tool.closed) out.fine_exit = ways_out(out.finest());

  if (!at("search", 0.4)) return cancelled();
  out.search = SearchTables::make(geometry, out.mockup, go_on);
  if (!out.search) return cancelled();
  bool mockup_has_inside = geometry.mockup.closed;
  if (!geometry.mockup.closed) {
    out.mockup_shells = OpenInside::count_shells(geometry.mockup, out.mockup, out.search->boxes, go_on);
    if (!out.mockup_shells) return cancelled();
    mockup_has_inside =
        out.mockup.has_internal || (has_faces(geometry.mockup) && out.mockup_shells->bounds_inside());
  }
  bool tool_has_inside = geometry.tool.closed;
  if (!geometry.tool.closed && has_faces(geometry.tool)) {
    out.tool_shells = OpenInside::count_shells(geometry.tool, out.tool,
                                               SearchTables::boxes_of(geometry.tool, out.tool), go_on);
    if (!out.tool_shells) return cancelled();
    tool_has_inside = out.tool.has_internal || out.tool_shells->bounds_inside();
    if (!tool_has_inside) out.tool_shells = nullptr;
  }
  if (tool_has_inside)
    if (!make_samples(geometry, progress, out)) return cancelled();

  out.constants = scene_constants(geometry, plan,
                                  {.mockup = out.mockup.grid,
                                   .tool = out.tool.grid,
                                   .fine = out.finest().grid,
                                   .mockup_has_inside = mockup_has_inside,
                                   .tool_has_inside = tool_has_inside});
  out.know(geometry);
  if (!at("prepared", 1)) return cancelled();
  return out;
}

}  // namespace palpate::native
