// Adds heights to an area, docs/EXACTNESS.md section 7. The including shader declares `AreaWork areas[]`, writable.
#ifndef PALPATE_LIB_HEIGHT_SUM
#define PALPATE_LIB_HEIGHT_SUM

// What a run of samples adds to one area. H ≤ 2^31 and w < 2^31: M = (H·w) >> 30 ≤ 2^32, M·s within 2^60.
struct HeightSum {
  uint32_t rays;
  uint32_t max_height;
  int64_t weight;
  int64_t height;
  i64vec3 moment_low;
  i64vec3 moment_high;
};

HeightSum height_sum_empty() { return HeightSum(0u, 0u, 0l, 0l, i64vec3(0l), i64vec3(0l)); }

// A sample at s of weight w (Q30) has height H.
void height_sum_add(inout HeightSum sum, ivec3 s, uint32_t height, uint32_t w) {
  const int64_t m = int64_t(uint64_t(height) * uint64_t(w) >> 30);
  const i64vec3 moment = m * i64vec3(s);
  sum.rays += 1u;
  sum.max_height = max(sum.max_height, height);
  sum.weight += int64_t(w);
  sum.height += m;
  sum.moment_low += moment & 0xFFFFFFFFl;
  sum.moment_high += moment >> 32;
}

void height_sum_flush(uint32_t area, HeightSum sum) {
  if (sum.rays == 0u) return;
  atomicAdd(areas[area].rays, sum.rays);
  atomicMax(areas[area].max_height, sum.max_height);
  atomicAdd(areas[area].weight_sum, sum.weight);
  atomicAdd(areas[area].height_sum, sum.height);
  for (int k = 0; k < 3; ++k) {
    atomicAdd(areas[area].moment_low[k], sum.moment_low[k]);
    atomicAdd(areas[area].moment_high[k], sum.moment_high[k]);
  }
}
#endif
