#pragma once
#include "cpu_ref/frame.h"

namespace palpate::cpu_ref {

/// The pressure field at a pose and what the triangles of CST and EST carry of it (EXACTNESS section 8).
/// `refined`, with contact. Fills `field`, `carriers` and flags.
void sum_field(const Frame& frame, Contacts& out);

}  // namespace palpate::cpu_ref
