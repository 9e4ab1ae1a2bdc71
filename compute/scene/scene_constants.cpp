#include "compute/scene/scene_constants.h"

#include "model/contact/field.h"

namespace palpate {
namespace {

gpu::BodyConstants constants_of(const LatticeMesh& mesh, const PreparedGrid& prepared) {
  gpu::BodyConstants out{};
  out.vertices = static_cast<std::uint32_t>(mesh.vertices.size());
  out.triangles = static_cast<std::uint32_t>(mesh.triangles.size());
  out.closed = mesh.closed ? 1 : 0;
  out.has_internal = prepared.has_internal ? 1 : 0;
  out.grid = prepared.grid;
  return out;
}

}  // namespace

gpu::SceneConstants scene_constants(const SceneGeometry& geometry, const Plan& plan,
                                    const PreparedGrid& mockup, const PreparedGrid& tool,
                                    const gpu::GridConstants& fine) {
  gpu::SceneConstants out{};
  out.mockup = constants_of(geometry.mockup, mockup);
  out.tool = constants_of(geometry.tool, tool);
  out.tool_radius = geometry.tool_radius;
  out.lever_shift = lever_shift(geometry.tool_radius);
  out.refined = plan.profile == Profile::kRefined ? 1 : 0;
  if (out.refined != 0) {
    out.mockup_extras = static_cast<std::uint32_t>(geometry.mockup.extra_samples.size());
    out.tool_extras = static_cast<std::uint32_t>(geometry.tool.extra_samples.size());
  }
  out.sample_spacing = geometry.sample_spacing;
  out.contact_samples = geometry.contact_samples;
  out.fine = fine;
  return out;
}

}  // namespace palpate
