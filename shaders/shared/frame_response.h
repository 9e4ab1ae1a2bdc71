// What the response half of a frame keeps in profile `paper`: areas, directions, heights, sums.
// docs/EXACTNESS.md sections 5 to 7; the results that go to the host are in frame.h.
//
// Area numbers run from 0 to ResponseState::areas − 1 in no particular order; the host sorts by id. A slot is
// a position in C_s.
#ifndef PALPATE_SHARED_FRAME_RESPONSE_H
#define PALPATE_SHARED_FRAME_RESPONSE_H
#include "shaders/shared/base.h"
#include "shaders/shared/frame.h"

PALPATE_SHARED_BEGIN

// ---- bindings and dispatches
// ---------------------------------------------------------------------------------------------

PALPATE_CONSTANT int32_t kBindResponseState = 72;  // ResponseState, one
PALPATE_CONSTANT int32_t kBindAreas = 73;          // AreaWork[kMaxFrameAreas]
PALPATE_CONSTANT int32_t kBindSlotAreas = 74;      // uint32_t[C_s]: area number, kNone beyond the capacity
PALPATE_CONSTANT int32_t kBindMobileAreas =
    75;  // uint32_t[tool triangles], valid for C_m: the area that has it although no sphere holds it; kNone:
         // the areas whose spheres hold it have it
PALPATE_CONSTANT int32_t kBindParents =
    82;  // uint32_t[2 · C_s], without zones [C_s]: union-find, lib/union_find.glsl

PALPATE_CONSTANT uint32_t kDispatchAreaMembers =
    22u;  // some area needs mobile normals: an invocation a member

// ---- structs
// -------------------------------------------------------------------------------------------------------------

struct ResponseState {
  uint32_t areas;  // given out; beyond kMaxFrameAreas the frame is truncated
};

// One area. Sums are of whole frames' terms, in any order.
struct AreaWork {
  int64_t static_sum[3];  // Σ n̂ over C_s
  int64_t mobile_sum[3];  // Σ n̂'; n_c takes it with a minus
  int64_t height_sum;
  int64_t voxel_sum[3];
  ivec3 box_low, box_high;  // of the corners of its triangles
  ivec3 direction;          // D
  uint32_t id;              // smallest static id
  uint32_t zones;
  uint32_t flags;  // ContactFlag bits
  uint32_t rays;
  uint32_t max_height;
  uint32_t voxel_count;
  uint32_t padding;  // whole 8 bytes
};
PALPATE_ASSERT_SIZE(AreaWork, 144);

// ContactFlag of model/contact/contacts.h.
PALPATE_CONSTANT uint32_t kAreaFlagCancelled = 1u << 0;
PALPATE_CONSTANT uint32_t kAreaFlagNoDirection = 1u << 3;

PALPATE_SHARED_END
#endif
