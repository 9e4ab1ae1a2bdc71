// What the plan of a frame leaves out, as specialisation constants; compute/gpu/frame/plan.cpp sets those
// that differ from these.
#ifndef PALPATE_LIB_PLAN
#define PALPATE_LIB_PLAN
layout(constant_id = 17) const bool INTERNAL = true;        // false: the mock-up has no V_int voxel
// False: all edges of the mock-up are smooth, an area is one zone.
layout(constant_id = 18) const bool ZONES = true;
layout(constant_id = 19) const bool CONTACT_POINT = true;   // false: nobody asks for cp
#endif
