#include "compute/native/narrow_phase/contact.h"

namespace palpate {

using namespace gpu;  // names of shaders/shared/frame.h

namespace {

/// Of which set a triangle of C_m is, by its mark.
std::uint32_t set_of(const MobileResult& m) {
  return (m.state & kMobileHit) != 0        ? kMobileHit
         : (m.state & kMobileInternal) != 0 ? kMobileInternal
                                            : kMobileBoundary;
}

}  // namespace

std::unique_ptr<NarrowPhase> NarrowPhase::make(const SceneGeometry& geometry, const SceneTables& scene,
                                               std::span<const std::uint32_t> order, const OpenBodies& open) {
  std::unique_ptr<NarrowPhase> out(new NarrowPhase);
  out->mockup_ = PartitionLookup(scene.mockup);
  out->tool_ = PartitionLookup(scene.tool);
  out->tool_boxes_ = SearchTables::boxes_of(geometry.tool, scene.tool);
  out->tool_triangles_ = TriangleTree::make(geometry.tool, [] { return true; });
  out->search_ = scene.search;
  out->in_tool_ = InsideSearch(geometry.tool, out->tool_, out->tool_boxes_);
  out->in_tool_.use(open.tool);
  out->sets_ = ContactSets::make(geometry, scene, order, out->in_tool_);
  out->mobiles_.resize(geometry.tool.triangles.size());
  InsideSearch in_mockup(geometry.mockup, out->mockup_, scene.search->boxes);
  in_mockup.use(open.mockup);
  out->field_ = PressureField::make(
      geometry, scene.search->triangles, in_mockup, out->tool_triangles_, out->in_tool_, order,
      {.mockup = scene.constants.mockup_has_inside != 0, .tool = scene.constants.tool_has_inside != 0});
  return out;
}

void NarrowPhase::decide(PosedTool& tool, const Candidates& near, FrameHelper* helper, Contacts& out) {
  sets_.decide(tool, near, helper, found_);
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
  mobiles_.clear();  // of a frame that ended for want of memory
  for (const MobileResult& m : found_.mobiles) mobiles_.add(m.id, set_of(m));
  mobiles_.take_all([&](std::uint32_t id, std::uint32_t set) {
    (set == kMobileHit ? out.cmt : set == kMobileInternal ? out.imt : out.bmt).push_back(id);
  });
}

}  // namespace palpate
