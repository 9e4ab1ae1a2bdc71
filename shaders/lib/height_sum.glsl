// Adds heights to an area, docs/EXACTNESS.md section 7. The including shader declares `AreaWork areas[]`, writable.
#ifndef PALPATE_LIB_HEIGHT_SUM
#define PALPATE_LIB_HEIGHT_SUM
#include "shaders/lib/plan.glsl"

// What a run of samples adds to one area; `height` and the moments for cp alone. H ≤ 2^31 and w < 2^31: M = (H·w) >> 30 ≤ 2^32, M·s within 2^60; w' < 2^32. Faded heights are w·H or w·H_0·ν ≤ 2^62.6.
struct HeightSum {
  uint32_t rays;
  uint32_t max_height;
  int64_t height;
  int64_t weight;
  int64_t faded;
  int64_t rest;
  int64_t weight_slope;
  int64_t height_slope;
  i64vec3 moment_low;
  i64vec3 moment_high;
};

HeightSum height_sum_empty() { return HeightSum(0u, 0u, 0l, 0l, 0l, 0l, 0l, 0l, i64vec3(0l), i64vec3(0l)); }

// A sample at s of weight w (Q30) has height H. `fade` is its H_0.
void height_sum_add(inout HeightSum sum, ivec3 s, uint32_t height, uint32_t w, uint32_t fade) {
  const int64_t m = int64_t(uint64_t(height) * uint64_t(w) >> 30);
  sum.rays += 1u;
  sum.max_height = max(sum.max_height, height);
  if (CONTACT_POINT) {
    const i64vec3 moment = m * i64vec3(s);
    sum.height += m;
    sum.moment_low += moment & 0xFFFFFFFFl;
    sum.moment_high += moment >> 32;
  }

  const int64_t whole = int64_t(w);
  int64_t weight = whole, slope = whole, faded = int64_t(uint64_t(height) * uint64_t(w) >> 10);   // faded: Q20
  if (fade >= kLeastFade && height / 3u < fade) {   // H < 3 H_0 without leaving 32 bits: floor(H/3) < H_0
    const int64_t one = 1l << 18;
    const int64_t t = int64_t((uint64_t(height) << 18) / uint64_t(fade));   // Q18, below 3
    // 2φ in Q36, |2φ'| in Q18 and its sign, 12ν in Q54. Every term is below 2^63.
    int64_t value, rate, deep;
    bool falls = false;
    if (height < fade) {
      value = t * t * 2l;
      rate = 4l * t;
      deep = 8l * t * t * t;
    } else if (height - fade < fade) {
      value = t * (10l * one - 3l * t) - 5l * one * one;
      falls = 3l * t > 5l * one;
      rate = falls ? 6l * t - 10l * one : 10l * one - 6l * t;
      deep = t * (t * (45l * one - 12l * t) - 30l * one * one) + 5l * one * one * one;
    } else {
      value = t * (t - 6l * one) + 11l * one * one;
      falls = true;
      rate = 6l * one - 2l * t;
      deep = t * (t * (4l * t - 27l * one) + 66l * one * one) - 27l * one * one * one;
    }
    weight = whole * (value >> 6) >> 31;      // w < 2^31, 2φ < 2^32 in Q30
    const int64_t size = whole * rate >> 18;  // |2φ'| ≤ 4
    const int64_t bend = size * t >> 20, step = int64_t((uint64_t(size) << 9) / uint64_t(fade));
    slope = falls ? weight - bend : weight + bend;
    sum.weight_slope += falls ? -step : step;
    const int64_t down = int64_t(fade) * ((deep >> 24) / 12l) >> 20;   // H_0·ν, Q10: H_0 ≤ 2^30, ν ≤ 3 in Q30
    faded = whole * (down >> 20) + (whole * (down & 0xFFFFFl) >> 20);
  }
  sum.weight += weight;
  sum.faded += faded >> 20;
  sum.rest += faded & 0xFFFFFl;
  sum.height_slope += slope;
}

void height_sum_flush(uint32_t area, HeightSum sum) {
  if (sum.rays == 0u) return;
  atomicAdd(areas[area].rays, sum.rays);
  atomicMax(areas[area].max_height, sum.max_height);
  atomicAdd(areas[area].weight_sum, sum.weight);
  atomicAdd(areas[area].faded_sum, sum.faded);
  atomicAdd(areas[area].faded_rest, sum.rest);
  if (sum.weight_slope != 0l) atomicAdd(areas[area].weight_slope, sum.weight_slope);
  atomicAdd(areas[area].height_slope, sum.height_slope);
  if (!CONTACT_POINT) return;
  atomicAdd(areas[area].height_sum, sum.height);
  for (int k = 0; k < 3; ++k) {
    atomicAdd(areas[area].moment_low[k], sum.moment_low[k]);
    atomicAdd(areas[area].moment_high[k], sum.moment_high[k]);
  }
}
#endif
