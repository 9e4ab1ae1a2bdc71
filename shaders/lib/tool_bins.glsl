// The grid of bins over the tool's shadow along x. The including file has frame_input and the constant BINS_BITS.
#ifndef PALPATE_TOOL_BINS_GLSL
#define PALPATE_TOOL_BINS_GLSL
layout(constant_id = 1) const uint32_t BINS_BITS = 0u;   // 2^BINS_BITS bins along y and along z

// The bin of a point within [tool_low, tool_high], as (y, z).
uvec2 bin_place(ivec3 p) { return uvec2(p.yz - frame_input.tool_low.yz) >> uint32_t(frame_input.bin_shift); }
uint32_t bin_number(uvec2 place) { return place.x << BINS_BITS | place.y; }
#endif
