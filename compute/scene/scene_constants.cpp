#include "compute/scene/scene_constants.h"

#include "model/contact/field.h"

namespace palpate {
namespace {

gpu::BodyConstants constants_of(const LatticeMesh& mesh, const gpu::GridConstants& grid) {
  gpu::BodyConstants out{};
  out.vertices = static_cast<std::uint32_t>(mesh.vertices.size());
  out.triangles = static_cast<std::uint32_t>(mesh.triangles.size());
  out.closed = mesh.closed ? 1 : 0;
  out.grid = grid;
  return out;
}

}  // namespace

gpu::SceneConstants scene_constants(const SceneGeometry& geometry, const Plan& plan,
                                    const PreparedGrids& prepared) {
  gpu::SceneConstants out{};
  out.mockup = constants_of(geometry.mockup, prepared.mockup);
  out.tool = constants_of(geometry.tool, prepared.tool);
  out.tool_radius = geometry.tool_radius;
  out.lever_shift = lever_shift(geometry.tool_radius);
  out.refined = plan.profile == Profile::kRefined ? 1 : 0;
  if (out.refined != 0) {
    out.mockup_extras = static_cast<std::uint32_t>(geometry.mockup.extra_samples.size());
    out.tool_extras = static_cast<std::uint32_t>(geometry.tool.extra_samples.size());
  }
  out.sample_spacing = geometry.sample_spacing;
  out.contact_samples = geometry.contact_samples;
  out.mockup_has_inside = prepared.mockup_has_inside ? 1 : 0;
  out.tool_has_inside = prepared.tool_has_inside ? 1 : 0;
  out.fine = prepared.fine;
  return out;
}

}  // namespace palpate
