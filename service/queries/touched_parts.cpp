#include "service/queries/touched_parts.h"

#include <algorithm>

namespace palpate {

TouchedParts::Body::Body(const MeshReport& of) : report(&of) {
  std::uint32_t end = 0;
  for (const MeshReport::Part& part : of.parts) ends.push_back(end += part.triangles);
}

void TouchedParts::Body::mark(const std::vector<std::uint32_t>& triangles, std::vector<bool>& touched) const {
  for (const std::uint32_t triangle : triangles)
    if (const auto part = std::upper_bound(ends.begin(), ends.end(), triangle); part != ends.end())
      touched[static_cast<std::size_t>(part - ends.begin())] = true;
}

std::vector<std::string> TouchedParts::Body::names(const std::vector<bool>& touched) const {
  std::vector<std::string> out;
  for (std::size_t i = 0; i < touched.size(); ++i)
    if (touched[i]) out.push_back(report->parts[i].path);
  return out;
}

TouchedParts::TouchedParts(const SceneGeometry& geometry)
    : static_(geometry.mockup_report), mobile_(geometry.tool_report) {}

std::vector<std::string> TouchedParts::statics(const Contacts& contacts) const {
  std::vector<bool> touched(static_.ends.size());
  static_.mark(contacts.cst, touched);
  static_.mark(contacts.est, touched);
  if (contacts.field.max_depth > 0) static_.mark({contacts.field.deepest_static}, touched);
  for (const ContactArea& area : contacts.areas) static_.mark(area.static_ids, touched);
  return static_.names(touched);
}

std::vector<std::string> TouchedParts::mobiles(const Contacts& contacts) const {
  std::vector<bool> touched(mobile_.ends.size());
  mobile_.mark(contacts.cmt, touched);
  mobile_.mark(contacts.imt, touched);
  if (contacts.field.max_depth > 0) mobile_.mark({contacts.field.deepest_mobile}, touched);
  for (const ContactArea& area : contacts.areas) mobile_.mark(area.mobile_ids, touched);
  return mobile_.names(touched);
}

}  // namespace palpate
