#pragma once
#include <rapidcheck.h>

#include "tests/properties/asked.h"

/// Random questions in which the bodies mostly touch, often in corners, along edges and in planes. Shrink to
/// fewer and smaller triangles.
namespace palpate::properties {

/// Triangles without order: open, crossing, doubled, some without area. `turns`: any of the 24 quarter turns,
/// else any rotation too.
rc::Gen<Question> soups(bool quarter_turns);

/// Closed bodies, boxes and octahedra, outward: apart, touching, overlapping, nested.
rc::Gen<Question> solids(bool quarter_turns);

void showValue(const Question& question, std::ostream& out);

}  // namespace palpate::properties
