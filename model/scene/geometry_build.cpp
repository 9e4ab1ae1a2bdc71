#include "model/scene/geometry_build.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>

#include "model/lattice/lattice_build.h"
#include "model/lattice/triangle.h"
#include "model/lattice/voxel_size.h"
#include "model/mesh/edges.h"
#include "model/mesh/mass.h"
#include "model/mesh/orientation.h"
#include "model/mesh/patches.h"
#include "model/mesh/repeated_faces.h"
#include "model/mesh/weld.h"

namespace palpate {
namespace {

/// A centre of mass farther from the tool's box than this many half diagonals is a mistake in units (chosen).
constexpr double kFarthestCentreOfMass = 16;

void make_normals(LatticeMesh& mesh) {
  const std::size_t count = mesh.triangles.size();
  mesh.unit_normal_q30.assign(count, Int3(0));
  mesh.sample_weight_q30.assign(count, 0);
  mesh.sample_axis.assign(count, 0);
  for (std::uint32_t t = 0; t < count; ++t) {
    if (mesh.collapsed(t)) continue;
    const Long3 raw = raw_normal(mesh, t);
    const int axis = dominant_axis(raw);
    const Vec3 normal(raw);
    const double size = length(normal);
    for (int k = 0; k < 3; ++k)
      mesh.unit_normal_q30[t][k] = static_cast<std::int32_t>(std::nearbyint(normal[k] / size * 0x1p30));
    mesh.sample_weight_q30[t] =
        static_cast<std::uint32_t>(std::nearbyint(size / std::abs(normal[axis]) * 0x1p30));
    mesh.sample_axis[t] = static_cast<std::uint8_t>(axis);
  }
}

/// The place in report.parts of every triangle; makes the parts. Triangles that no part covers are a part
/// without a name.
std::vector<std::uint32_t> list_parts(const Mesh& mesh, const LatticeMesh& built, const Lattice& lattice,
                                      MeshReport& report) {
  std::vector<std::uint32_t> part_of(mesh.triangles.size(), 0xFFFFFFFFu);
  report.parts.clear();
  for (const MeshPart& part : mesh.parts) {
    const std::size_t end =
        std::min(mesh.triangles.size(), std::size_t{part.first_triangle} + part.triangle_count);
    for (std::size_t t = part.first_triangle; t < end; ++t)
      part_of[t] = static_cast<std::uint32_t>(report.parts.size());
    report.parts.push_back({.path = part.path});
  }
  if (std::find(part_of.begin(), part_of.end(), 0xFFFFFFFFu) != part_of.end()) {
    std::replace(part_of.begin(), part_of.end(), 0xFFFFFFFFu,
                 static_cast<std::uint32_t>(report.parts.size()));
    report.parts.emplace_back();
  }
  std::vector<std::uint8_t> has_box(report.parts.size(), 0);
  for (std::uint32_t t = 0; t < part_of.size(); ++t) {
    MeshReport::Part& part = report.parts[part_of[t]];
    ++part.triangles;
    if (built.collapsed(t)) {
      ++part.collapsed;
      continue;
    }
    for (int k = 0; k < 3; ++k) {
      const Vec3 corner = lattice.origin_m + lattice.step_m * Vec3(built.corner(t, k));
      std::uint8_t& has = has_box[part_of[t]];
      part.box_min_m = has ? glm::min(part.box_min_m, corner) : corner;
      part.box_max_m = has ? glm::max(part.box_max_m, corner) : corner;
      has = 1;
    }
  }
  return part_of;
}

void describe_shells(const Orientation& orientation, const std::vector<std::uint32_t>& part_of,
                     const LatticeMesh& mesh, MeshReport& report) {
  std::vector<std::uint32_t> judged(report.parts.size(), 0), sheets(report.parts.size(), 0);
  for (std::uint32_t t = 0; t < part_of.size(); ++t) {
    if (mesh.collapsed(t)) continue;
    const Shell& shell = orientation.shells[orientation.shell_of[t]];
    MeshReport::Part& part = report.parts[part_of[t]];
    ++judged[part_of[t]];
    if (shell.sheet) ++sheets[part_of[t]];
    if (shell.turned) part.turned = true;
    if (!shell.orientable) part.orientable = false;
  }
  for (std::size_t p = 0; p < judged.size(); ++p)
    report.parts[p].sheet = judged[p] > 0 && sheets[p] == judged[p];

  std::size_t turned = 0, turned_triangles = 0, sheet = 0, sheet_triangles = 0, one_sided = 0,
              one_sided_triangles = 0;
  std::size_t disagreeing = 0, loose = 0;
  for (const Shell& shell : orientation.shells) {
    if (shell.turned && shell.triangles == 1)
      ++loose;
    else if (shell.turned)
      ++turned, turned_triangles += shell.triangles;
    if (shell.sheet) ++sheet, sheet_triangles += shell.triangles;
    if (!shell.orientable) ++one_sided, one_sided_triangles += shell.triangles;
    disagreeing += shell.disagreeing;
  }
  const std::size_t all = orientation.shells.size();
  if (disagreeing)
    report.notes.push_back(
        fmt::format("{} triangles were turned to agree with their neighbours", disagreeing));
  if (turned)
    report.notes.push_back(
        fmt::format("{} of {} edge-connected parts were inside out and have been turned round ({} triangles)",
                    turned, all, turned_triangles));
  if (loose)
    report.notes.push_back(fmt::format(
        "{} triangles share no edge with just one other and were turned with their backs to the inside",
        loose));
  if (sheet)
    report.notes.push_back(
        fmt::format("{} of {} edge-connected parts have no inside and count as sheets ({} triangles)", sheet,
                    all, sheet_triangles));
  if (one_sided)
    report.notes.push_back(fmt::format(
        "{} of {} edge-connected parts are one-sided surfaces and were left as given ({} triangles)",
        one_sided, all, one_sided_triangles));
}

void describe_surface(MeshReport& report, const LatticeMesh& mesh) {
  if (report.collapsed)
    report.notes.push_back(
        fmt::format("{} triangles have no area on the lattice and take no part", report.collapsed));
  if (report.duplicate)
    report.notes.push_back(fmt::format("{} triangles repeat another's three corners", report.duplicate));
  if (report.nonmanifold_edges)
    report.notes.push_back(fmt::format("{} edges carry more than two triangles", report.nonmanifold_edges));
  if (mesh.closed && report.open_edges)
    report.notes.push_back(
        fmt::format("{} edges carry one triangle and are met by shorter ones of their neighbours "
                    "(T-junctions): the surface has no gap there",
                    report.open_edges));
  if (!mesh.closed && !report.open_edges)
    report.notes.push_back(
        "the surface is not closed though no edge carries one triangle alone: edges with more than two "
        "triangles don't cancel");
}

Result<Vec3> centre_of_mass(const std::optional<Vec3>& asked, const LatticeMesh& tool,
                            const SurfaceMeasure& measure, const Lattice& tool_lattice, double half_diagonal,
                            MeshReport& report) {
  if (asked) {
    if (!(length(*asked - tool_lattice.origin_m) <= kFarthestCentreOfMass * half_diagonal))
      return bad_value(fmt::format("centre_of_mass ({}, {}, {}) m is not within {} m of the tool's centre",
                                   asked->x, asked->y, asked->z, kFarthestCentreOfMass * half_diagonal));
    return *asked;
  }
  const bool solid = tool.closed && measure.volume > 0;
  if (!solid)
    report.notes.push_back("the tool encloses no volume: its centre of mass is taken as its area's centroid");
  return tool_lattice.origin_m +
         tool_lattice.step_m * (solid ? measure.volume_centroid : measure.area_centroid);
}

}  // namespace

Result<LatticeMesh> build_lattice_mesh(const Mesh& mesh, const Lattice& lattice, const SmoothAngle& angle,
                                       MeshReport& report, const std::function<bool()>& go_on) {
  const Error ended{ErrorCode::kInternal, "loading was cancelled"};
  const auto stop = [&] { return go_on && !go_on(); };
  Result<LatticeMesh> welded = snap_and_weld(mesh, lattice);
  if (!welded) return welded.error();
  if (stop()) return ended;
  LatticeMesh out = std::move(*welded);
  report = {};
  report.triangles = static_cast<std::uint32_t>(out.triangles.size());
  report.vertices = static_cast<std::uint32_t>(out.vertices.size());
  for (const std::uint8_t flags : out.flags) report.collapsed += flags & kTriangleCollapsed ? 1 : 0;

  const EdgeTable edges(out);
  if (stop()) return ended;
  if (const Result<void> bearable = check_crowded_edges(edges, out); !bearable) return bearable.error();
  const std::vector<std::uint32_t> part_of = list_parts(mesh, out, lattice, report);
  describe_shells(orient(edges, part_of, out), part_of, out, report);
  if (stop()) return ended;
  examine_edges(edges, lattice.step_m, part_of, out, report);
  describe_surface(report, out);
  if (stop()) return ended;
  make_normals(out);
  if (const Result<void> found = find_neighbours(edges, angle, out); !found) return found.error();
  mark_repeated_faces(part_of, out);
  find_patches(part_of, out);
  return out;
}

namespace {

/// Whether all that is asked of a predicate stays within kLatticeReach: both grids, and a tool whose sphere
/// meets the mock-up's.
bool within_reach(const SceneGeometry& geometry) {
  std::int64_t reach = 0;
  const auto grid_reach = [](const VoxelGrid& grid, int k) {
    return std::max(-std::int64_t{grid.origin[k]},
                    grid.origin[k] + std::int64_t{grid.size} * kBrickSide * grid.bricks[k]);
  };
  const double gc = length(Vec3(geometry.tool_gc));
  const std::int64_t arm = std::max(geometry.tool_radius, static_cast<std::int32_t>(std::ceil(gc)) + 3);
  for (int k = 0; k < 3; ++k)
    reach = std::max({reach, grid_reach(geometry.mockup_grid, k) + geometry.tool_radius + arm,
                      grid_reach(geometry.tool_grid, k)});
  return reach <= kLatticeReach;
}

/// build_geometry on a lattice that has been chosen.
Result<SceneGeometry> build_on(const Lattice& lattice, const Mesh& mockup, const Mesh& tool,
                               const Box& tool_box, const GeometrySettings& settings,
                               const SmoothAngle& angle, const std::function<bool()>& go_on) {
  SceneGeometry out;
  out.smooth_angle = angle;
  out.lattice = lattice;
  // A multiple of the step too: a tool equal to the mock-up then snaps to the same points.
  out.tool_centre_m = on_lattice(tool_box.centre(), lattice.step_m);
  const Lattice tool_lattice{lattice.step_m, out.tool_centre_m};

  // Both bodies.
  const auto body = [&](const Mesh& mesh, const Lattice& frame, const char* what,
                        MeshReport& report) -> Result<LatticeMesh> {
    Result<LatticeMesh> built = build_lattice_mesh(mesh, frame, out.smooth_angle, report, go_on);
    if (!built && built.error().code == ErrorCode::kInternal) return built;
    if (!built) return bad_value(fmt::format("{}: {}", what, built.error().sentence));
    return built;
  };
  Result<LatticeMesh> mockup_mesh = body(mockup, out.lattice, "mock-up", out.mockup_report);
  if (!mockup_mesh) return mockup_mesh.error();
  out.mockup = std::move(*mockup_mesh);
  Result<LatticeMesh> tool_mesh = body(tool, tool_lattice, "tool", out.tool_report);
  if (!tool_mesh) return tool_mesh.error();
  out.tool = std::move(*tool_mesh);

  // The tool's mass and reach.
  out.tool_surface = measure(out.tool);
  const Result<Vec3> gc = centre_of_mass(settings.centre_of_mass_m, out.tool, out.tool_surface, tool_lattice,
                                         length(tool_box.size()) / 2, out.tool_report);
  if (!gc) return gc.error();
  out.tool_gc_m = *gc;
  double radius = 0;
  for (const Int3& v : out.tool.vertices) radius = std::max(radius, length(Vec3(v)));
  out.tool_radius = static_cast<std::int32_t>(std::ceil(radius)) + 3;
  for (int k = 0; k < 3; ++k)
    out.tool_gc[k] = static_cast<std::int32_t>(
        std::nearbyint((out.tool_gc_m[k] - out.tool_centre_m[k]) / out.lattice.step_m));

  // The grids and the sampling.
  out.mockup_surface = measure(out.mockup);
  const VoxelSubject mockup_subject{out.mockup_surface, out.mockup.box_min, out.mockup.box_max};
  const VoxelSubject tool_subject{out.tool_surface, out.tool.box_min, out.tool.box_max};
  const Result<std::int32_t> size =
      choose_voxel_size(mockup_subject, tool_subject, out.lattice.step_m, settings.voxel_size_m);
  if (!size) return size.error();
  out.mockup_grid = make_grid(out.mockup.box_min, out.mockup.box_max, *size);
  out.tool_grid = make_grid(out.tool.box_min, out.tool.box_max, *size);
  const Result<std::int32_t> auto_size =
      choose_voxel_size(mockup_subject, tool_subject, out.lattice.step_m, std::nullopt);
  const Result<std::int32_t> spacing = choose_sample_spacing(*size, auto_size ? *auto_size : *size,
                                                             out.lattice.step_m, settings.sample_spacing_m);
  if (!spacing) return spacing.error();
  out.sample_spacing = *spacing;
  out.contact_samples = settings.contact_samples;
  const Int3 extent = out.tool.box_max - out.tool.box_min;
  const double side = out.lattice.step_m * std::max({extent.x, extent.y, extent.z});
  out.reference_area_m2 = side * side / 64;  // (side / 8)², chosen
  out.tool_gyration_m = out.lattice.step_m *
                        gyration_radius(out.tool, (out.tool_gc_m - out.tool_centre_m) / out.lattice.step_m);
  for (LatticeMesh* mesh : {&out.mockup, &out.tool}) {
    if (go_on && !go_on()) return Error{ErrorCode::kInternal, "loading was cancelled"};
    const std::vector<Tip> tips = find_tips(out.sample_spacing, *mesh);
    weigh_for_field(out.sample_spacing, tips, *mesh);
    mark_thin_pieces(out.sample_spacing, tips, *mesh);
  }
  count_grid_samples(out.sample_spacing, out.tool);
  return out;
}

}  // namespace

Result<SceneGeometry> build_geometry(const Mesh& mockup, const Mesh& tool, const GeometrySettings& settings,
                                     const std::function<bool()>& go_on) {
  const Result<SmoothAngle> angle = make_smooth_angle(settings.smooth_angle_deg);
  if (!angle) return angle.error();
  const Result<Box> mockup_box = bounding_box(mockup, "mock-up");
  if (!mockup_box) return mockup_box.error();
  const Result<Box> tool_box = bounding_box(tool, "tool");
  if (!tool_box) return tool_box.error();

  // A lattice coarse enough for the tool, its centre of mass and the largest voxel that is likely. What is
  // beyond a limit is clamped here, and refused later in its own words.
  const auto side = [](const Box& box) { return std::max({box.size().x, box.size().y, box.size().z}); };
  const double half_diagonal = length(tool_box->size()) / 2;
  double arm = half_diagonal, voxel = side(*tool_box) / kVoxelsPerTool;
  if (settings.centre_of_mass_m)
    if (const double away = length(*settings.centre_of_mass_m - tool_box->centre()); away > arm)
      arm = std::min(away, kFarthestCentreOfMass * half_diagonal);
  if (settings.voxel_size_m && *settings.voxel_size_m > voxel)
    voxel = std::min(*settings.voxel_size_m, std::max(side(*mockup_box), side(*tool_box)));
  for (int attempt = 0; attempt < 4; ++attempt) {
    const Result<Lattice> lattice = choose_lattice(*mockup_box, arm, voxel);
    if (!lattice) return lattice.error();
    Result<SceneGeometry> built = build_on(*lattice, mockup, tool, *tool_box, settings, *angle, go_on);
    if (!built || within_reach(*built)) return built;
    // Memory asked for larger voxels than a 24th of the tool (a tiny tool in a vast mock-up): make room for
    // them.
    voxel = 1.25 * built->mockup_grid.size * lattice->step_m;
  }
  return bad_value(
      "no lattice holds the mock-up, its grid and the tool: the tool is too small for a mock-up of this "
      "size");
}

}  // namespace palpate
