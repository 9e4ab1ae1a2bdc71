#pragma once
#include "model/contacts.h"
#include "shaders/shared/frame.h"

namespace palpate {

/// What a finished frame left in mapped memory.
struct FrameOutput {
  const gpu::FrameResult* result = nullptr;
  const gpu::StaticResult* statics = nullptr;
  const gpu::MobileResult* mobiles = nullptr;
  const gpu::AreaMember* members = nullptr;
  const gpu::AreaPierce* pierces = nullptr;
};

/// Puts a frame's output in the order that Contacts asks for: ids ascending, areas by id, zones by first id. Writes all of `out`
/// but its times, reusing its memory. A frame that overflowed becomes a truncated one without areas, and
/// without sets unless they were complete. Where Contacts::lists is false, sets, zones and mobile ids stay empty.
void decode(const FrameOutput& output, Contacts& out);

/// Empties all of `out` but its times: free of contact.
void clear(Contacts& out);

}  // namespace palpate
