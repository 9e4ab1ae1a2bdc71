// The lattice pose, both ways; the file that includes this has `FrameInput frame_input`.
#ifndef PALPATE_POSE_GLSL
#define PALPATE_POSE_GLSL
#ifndef INPUT
#define INPUT(member) frame_input.member   // lib/batch/batch.glsl has it of the invocation's pose
#endif

// (R·v + 2^29) >> 30: a direction or a unit normal of the tool, Q30, in the world. |v|, |R| ≤ 2^30: sums
// within 3 · 2^60.
ivec3 turned(ivec3 v) {
  ivec3 p;
  for (int r = 0; r < 3; ++r) {
    const int64_t sum = int64_t(INPUT(rotation_q30[3 * r])) * int64_t(v.x) +
                        int64_t(INPUT(rotation_q30[3 * r + 1])) * int64_t(v.y) +
                        int64_t(INPUT(rotation_q30[3 * r + 2])) * int64_t(v.z) + (1l << 29);
    p[r] = int32_t(sum >> 30);
  }
  return p;
}

// World lattice point of tool lattice point v (model/lattice/lattice.h). |v| ≤ 2^28.
ivec3 world_from_tool(ivec3 v) { return turned(v) + INPUT(translation); }

// Tool lattice point of world lattice point p (docs/EXACTNESS.md section 4). |p − translation| < 2^31: sums
// within 3 · 2^61.
ivec3 tool_from_world(ivec3 p) {
  const i64vec3 d = i64vec3(p) - i64vec3(INPUT(translation));
  ivec3 q;
  for (int c = 0; c < 3; ++c) {
    const int64_t sum = int64_t(INPUT(rotation_q30[c])) * d.x +
                        int64_t(INPUT(rotation_q30[3 + c])) * d.y +
                        int64_t(INPUT(rotation_q30[6 + c])) * d.z + (1l << 29);
    q[c] = int32_t(sum >> 30);
  }
  return q;
}
#endif
