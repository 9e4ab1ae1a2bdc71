#pragma once
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "compute/native/broad_phase/candidates.h"
#include "compute/native/broad_phase/posed_tool.h"
#include "compute/native/force/field.h"
#include "compute/native/frame_helper.h"
#include "compute/native/narrow_phase/id_marks.h"
#include "compute/native/narrow_phase/sets.h"
#include "compute/scene/partition_lookup.h"
#include "compute/scene/scene_tables.h"
#include "compute/scene/search_tables.h"
#include "model/bytes_of.h"

namespace palpate {

/// A whole contact, from the lists of what is near to the field (docs/EXACTNESS.md sections 3, 4 and 8).
/// `refined`. One thread and its helper; make() keeps references to its arguments; solve() allocates only
/// when a contact is larger than all before.
class NarrowPhase {
 public:
  /// `open`: what is known of bodies that are not closed.
  static std::unique_ptr<NarrowPhase> make(const SceneGeometry& geometry, const SceneTables& scene,
                                           std::span<const std::uint32_t> order, const OpenBodies& open);

  /// Fills sets (where `out.lists`), pairs, contact and the field of an `out` that is clear. `helper` may be
  /// null. `stage(name, looks)` is called at the end of each stage, as Contacts::StageTime has it.
  template <class Stage>
  void solve(PosedTool& tool, const Ignored* ignored, const Candidates& near, FrameHelper* helper,
             Contacts& out, Stage stage) {
    decide(tool, near, helper, out);
    stage("sets", near.pairs.count + near.touch.count + near.swallowed.count + near.open.count +
                      found_.statics.size() + found_.mobiles.size() + found_.samples.size());
    if (!out.contact) return;
    const std::uint64_t before = field_.looks();
    field_.sum(tool.pose(), sets_, found_, {.ignored = ignored, .carriers = out.lists}, helper, out);
    stage("field",
          field_.looks() - before + found_.mobiles.size() + found_.samples.size() + found_.statics.size());
  }
  /// After solve().
  std::span<const gpu::ContactPair> pairs() const { return found_.pairs; }
  std::uint64_t bytes() const {
    return sizeof *this + bytes_of(tool_boxes_) + tool_triangles_.bytes() + mobiles_.bytes() +
           in_tool_.bytes() + sets_.bytes() + field_.bytes() + found_.bytes();
  }

 private:
  NarrowPhase() = default;
  void decide(PosedTool& tool, const Candidates& near, FrameHelper* helper, Contacts& out);

  PartitionLookup mockup_, tool_;
  std::vector<std::uint8_t> tool_boxes_;  ///< SearchTables::boxes_of
  TriangleTree tool_triangles_;
  std::shared_ptr<const SearchTables> search_;
  IdMarks mobiles_;  ///< C_m by id, where lists are wanted
  InsideSearch in_tool_;
  ContactSets sets_;
  PressureField field_;
  FoundSets found_;
};

}  // namespace palpate
