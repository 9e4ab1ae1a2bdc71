// Helpers over `AreaWork areas[]`, which the including shader declares.
#ifndef PALPATE_LIB_AREA
#define PALPATE_LIB_AREA
#include "shaders/lib/direction.glsl"

// The sum of static normals, sheets with their side.
i64vec3 static_sum(uint32_t area) {
  return vector_of(areas[area].fixed_sum) +
         (areas[area].sheet_sign < 0 ? -vector_of(areas[area].sheet_sum) : vector_of(areas[area].sheet_sum));
}

// The sum over CST alone, for areas without counting samples.
i64vec3 bare_sum(uint32_t area) {
  if (areas[area].samples != 0u) return i64vec3(0l);
  return vector_of(areas[area].bare_fixed) +
         (areas[area].sheet_sign < 0 ? -vector_of(areas[area].bare_sheet) : vector_of(areas[area].bare_sheet));
}
#endif
