#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "model/contact/contacts.h"
#include "model/scene/scene_geometry.h"

namespace palpate {

/// Which named parts of a scene touch. Made once for a scene; `geometry` must outlive it.
class TouchedParts {
 public:
  /// `geometry` outlives it.
  explicit TouchedParts(const SceneGeometry& geometry);

  /// Paths of the parts whose triangles are in contact: of CST, EST and the areas, and what the deepest
  /// sample of the tool lies in; each once, in the order of the scene.
  std::vector<std::string> statics(const Contacts& contacts) const;
  /// Paths of the tool's parts, likewise: of CMT, IMT and the areas, and what the mock-up's deepest lies in.
  std::vector<std::string> mobiles(const Contacts& contacts) const;

 private:
  /// The triangle behind each part's last.
  struct Body {
    const MeshReport* report;
    std::vector<std::uint32_t> ends;
    explicit Body(const MeshReport& of);
    std::vector<std::string> names(const std::vector<bool>& touched) const;
    void mark(const std::vector<std::uint32_t>& triangles, std::vector<bool>& touched) const;
  };
  Body static_, mobile_;
};

}  // namespace palpate
