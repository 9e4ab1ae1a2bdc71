// Nodes of the union-find (lib/union_find.glsl): where no zones are joined, their half of the buffer isn't
// there.
#ifndef PALPATE_LIB_UNION_NODES
#define PALPATE_LIB_UNION_NODES
#include "shaders/lib/plan.glsl"
uint32_t area_node(uint32_t slot) { return ZONES ? 2u * slot : slot; }
uint32_t zone_node(uint32_t slot) { return 2u * slot + 1u; }   // only where there are ZONES
uint32_t slot_of_node(uint32_t node) { return ZONES ? node >> 1 : node; }
#endif
