// What a way through voxels crosses of what they list, shared out among a team. The including shader has
// body_list_begin (WORDS) and
//   bool CORNERS(uint32_t entry, bool sheets, out ivec3 a, out ivec3 b, out ivec3 c)   false where the entry does
//                                                                                     not count
//   bool STEP(inout Walk walk, out uint32_t boundary)   to the next piece; of its voxel the compact index, or
//                                                       kNoVoxel where nothing is listed. False: it has ended.
//   LISTED_CROSSINGS(body_crossings, body_corners, body_step)   int32_t body_crossings(walk, sheets): the
//                                                               invocation's part of the sum.
// Floats say it first. What they leave open is asked outside of their loops, for llvmpipe goes through a loop's
// body once where nobody wants it, too.
#ifndef PALPATE_LIB_LISTED_CROSSINGS
#define PALPATE_LIB_LISTED_CROSSINGS
#include "shaders/lib/budget.glsl"
#include "shaders/lib/segment.glsl"
#include "shaders/lib/segment_estimate.glsl"
#include "shaders/lib/team.glsl"

// Along an axis of a grid, from face to face.
struct Walk {
  ivec3 from, to;   // the present piece
  ivec3 voxel;      // the next one
  ivec3 at;         // where the piece ends, in the grid's frame
  int axis;
  int32_t up;       // 0: down the axis, 1: up
};

// A perturbed segment that crosses a triangle touches its closed box.
#define LISTED_CROSSINGS(NAME, CORNERS, STEP)                                                            \
  int32_t NAME(Walk walk, bool sheets) {                                                                 \
    uint32_t entry = 0u, last = 0u;                                                                      \
    int32_t net = 0;                                                                                     \
    bool more = true;                                                                                    \
    while ((more || entry < last) && !spent(1u)) {                                                       \
      uint32_t unsure = kNone;                                                                           \
      ivec3 a, b, c;                                                                                     \
      while (unsure == kNone && (more || entry < last) && !spent(1u)) {                                  \
        if (entry >= last) {                                                                             \
          uint32_t boundary;                                                                             \
          more = STEP(walk, boundary);                                                                   \
          if (more && boundary != kNoVoxel && walk.from != walk.to) {                                    \
            entry = body_list_begin(boundary) + team_part();                                             \
            last = body_list_begin(boundary + 1u);                                                       \
          }                                                                                              \
        }                                                                                                \
        const ivec3 low = min(walk.from, walk.to), high = max(walk.from, walk.to);                       \
        while (unsure == kNone && entry < last && !spent(1u)) {                                          \
          if (CORNERS(entry, sheets, a, b, c) && all(lessThanEqual(min(min(a, b), c), high)) &&           \
              all(greaterThanEqual(max(max(a, b), c), low))) {                                           \
            const int32_t crossing = segment_estimate(walk.from, walk.to, a, b, c);                      \
            if (crossing == kUnsure)                                                                     \
              unsure = entry;                                                                            \
            else                                                                                         \
              net += crossing;                                                                           \
          }                                                                                              \
          entry += LANES;                                                                                \
        }                                                                                                \
      }                                                                                                  \
      if (unsure != kNone) {                                                                             \
        CORNERS(unsure, sheets, a, b, c);                                                                \
        net += segment_crossing(walk.from, walk.to, a, b, c);                                            \
      }                                                                                                  \
    }                                                                                                    \
    return net;                                                                                          \
  }
#endif
