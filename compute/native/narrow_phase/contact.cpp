#include "compute/native/narrow_phase/contact.h"

namespace palpate {

using namespace gpu;   // names of shaders/shared/frame.h

Result<std::unique_ptr<HostContact>> HostContact::make(VulkanDevice& device, const SceneGeometry& geometry, const PreparedScene& scene, std::span<const std::uint32_t> order) {
  std::unique_ptr<HostContact> out(new HostContact);
  if (auto r = out->mockup_.read(device, scene.mockup.partition); !r) return r.error();
  if (auto r = out->tool_.read(device, scene.tool.partition); !r) return r.error();
  auto boxes = SearchTables::boxes_of(device, geometry.tool, scene.tool.partition);
  if (!boxes) return boxes.error();
  out->tool_boxes_ = std::move(*boxes);
  out->tool_triangles_ = TriangleTree::make(geometry.tool, [] { return true; });
  out->search_ = scene.search;
  out->in_tool_ = InsideSearch(geometry.tool, out->tool_, out->tool_boxes_);
  auto sets = HostSets::make(device, geometry, scene, order, out->in_tool_);
  if (!sets) return sets.error();
  out->sets_ = std::move(*sets);
  out->statics_.resize(geometry.mockup.triangles.size());
  const BodyConstants& tool = scene.constants.tool;
  out->field_ = HostField::make(geometry, scene.search->triangles, InsideSearch(geometry.mockup, out->mockup_, scene.search->boxes), out->tool_triangles_, tool.closed != 0 || tool.has_internal != 0);
  return out;
}

void HostContact::decide(PosedTool& tool, const NearLists& near, FrameHelper* helper, Contacts& out) {
  sets_.decide(tool, near, statics_, helper, found_);
  out.contact = found_.state.contact != 0;
  out.pairs = found_.pairs.size();
  if (!out.lists) return;
  for (const StaticResult& s : found_.statics) {
    if ((s.state & kStaticHit) != 0) {
      out.cst.push_back(s.id);
      continue;
    }
    if ((s.state & kStaticListed) != 0) out.bst.push_back(s.id);
    if ((s.state & kStaticSampled) != 0) out.est.push_back(s.id);
  }
  for (const MobileResult& m : found_.mobiles)
    ((m.state & kMobileHit) != 0 ? out.cmt : (m.state & kMobileInternal) != 0 ? out.imt : out.bmt).push_back(m.id);
}

}  // namespace palpate
