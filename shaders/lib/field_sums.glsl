// Adds a workgroup's pushes to the field (docs/EXACTNESS.md section 8). Who speaks for a team puts its terms
// side by side in shared memory; then each of the first ones adds up one kind of term over the workgroup, and goes to
// the buffer only where the bin, or the carrier, changes: neighbours mostly share theirs.
// The including shader has scene, frame_input, int64_t field_work[] and carrier_work[] (both writable).
#ifndef PALPATE_LIB_FIELD_SUMS
#define PALPATE_LIB_FIELD_SUMS
#include "shaders/shared/frame_field.h"
#include "shaders/lib/team.glsl"
#include "shaders/lib/wide_integer.glsl"

layout(constant_id = 8) const bool CARRIERS = true;   // somebody wants to know what each triangle carries

// A sample inside the other body.
struct Push {
  ivec3 at;            // world lattice
  ivec3 along;         // n
  ivec3 against;       // u
  uint32_t depth;
  uint32_t weight;     // the sample's own, Q24
  uint32_t counted;    // of it; 0: none pushes, but its depth counts
  bool sheet;
  uint32_t static_id, mobile;
  uint32_t slot;       // of the carrier; kNone: none carries it
};

const uint32_t kTerms = kFieldBinWords + kCarrierSumWords;
// Of teams; one more, so that kinds side by side lie in different banks.
const uint32_t kTermsApart = kTeams + 1u;
shared int64_t terms[kTerms * kTermsApart];
shared uint32_t term_bins[kTeams], term_slots[kTeams];
shared uint64_t deepest[2u * kTeams];
shared uint32_t any_sheet;

void put_term(uint32_t kind, int64_t term) { terms[kind * kTermsApart + team()] = term; }

// Three sums of terms that may not fit 64 bits, as low and high halves.
void put_wide(uint32_t kind, i64vec3 term) {
  for (uint32_t k = 0u; k < 3u; ++k) {
    put_term(kind + k, term[k] & 0xFFFFFFFFl);
    put_term(kind + 3u + k, term[k] >> 32);
  }
}

// (p·x) >> 10 of the whole product: a small p keeps its last bits. p ≥ 0.
i64vec3 product_q10(int64_t p, i64vec3 x) { return (p >> 10) * x + (((p & 1023l) * x) >> 10); }

// Of the bins of all poses.
uint32_t bin_of(ivec3 n) {
  const int32_t least = 444764242;   // tan 22.5° in Q30
  const ivec3 digit = 1 + ivec3(greaterThan(n, ivec3(least))) - ivec3(lessThan(n, ivec3(-least)));
  return kFieldBinCount * frame_pose + uint32_t(digit.x + 3 * digit.y + 9 * digit.z);
}

// A word of the pose's field.
uint32_t field_word(uint32_t word) { return kFieldWords * frame_pose + word; }

// The first one of a bin.
uint32_t word_of_bin(uint32_t bin) {
  if (!BATCH) return kFieldBinWords * bin;
  return kFieldWords * (bin / kFieldBinCount) + kFieldBinWords * (bin % kFieldBinCount);
}

void put_push(Push push) {
  const i64vec3 n = i64vec3(push.along), u = i64vec3(push.against),
                r = i64vec3(push.at) - i64vec3(INPUT(translation));
  const uint32_t weight = push.counted;
  const int64_t p = int64_t((uint64_t(push.depth) * uint64_t(weight)) >> 14);
  put_term(0u, weight != 0u ? 1l : 0l);
  put_wide(1u, p * (n >> 10));
  put_wide(7u, product_q10(p, i64vec3(r.y * n.z - r.z * n.y, r.z * n.x - r.x * n.z, r.x * n.y - r.y * n.x) >> 30));
  const int64_t steep = (n.x * u.x + n.y * u.y + n.z * u.z) >> 30;
  const int64_t give = steep > 0l ? (int64_t(weight) * steep) >> 34 : 0l;
  const i64vec3 lever = r >> scene.lever_shift, moment = give * lever;
  put_term(13u, give);
  for (uint32_t k = 0u; k < 3u; ++k) {
    put_term(14u + k, moment[k]);
    put_term(17u + k, (moment[k] * lever[k]) >> 8);
    put_term(20u + k, (moment[k] * lever[(k + 1u) % 3u]) >> 8);
  }
  term_bins[team()] = bin_of(push.along);
  const uint64_t depth = uint64_t(push.depth) << 32, by_static = depth | uint64_t(~push.static_id),
                 by_mobile = depth | uint64_t(~push.mobile);
  if (BATCH) {   // a workgroup has several poses
    atomicMax(field_work[field_word(kWordDeepest)], int64_t(by_static));
    atomicMax(field_work[field_word(kWordDeepest + 1u)], int64_t(by_mobile));
    if (push.sheet) atomicOr(field_work[field_word(kWordSheet)], 1l);
  } else {
    deepest[team()] = by_static;
    deepest[kTeams + team()] = by_mobile;
    if (push.sheet) any_sheet = 1u;   // whoever writes it
  }
  if (!CARRIERS || push.slot == kNone) return;
  const int64_t whole = int64_t((uint64_t(push.depth) * uint64_t(push.weight)) >> 14);
  put_term(kFieldBinWords, 1l);
  put_term(kFieldBinWords + 1u, int64_t(push.weight));
  put_term(kFieldBinWords + 2u, whole);
  put_wide(kFieldBinWords + 3u, whole * (n >> 10));
  put_wide(kFieldBinWords + 9u, product_q10(whole, r));
  term_slots[team()] = push.slot;
  atomicMax(carrier_work[kCarrierWords * push.slot + kWordCarrierDepth], int64_t(push.depth));
}

void flush_term(uint32_t kind, uint32_t key, int64_t sum) {
  if (key == kNone || sum == 0l) return;
  if (kind < kFieldBinWords)
    atomicAdd(field_work[word_of_bin(key) + kind], sum);
  else atomicAdd(carrier_work[kCarrierWords * key + (kind - kFieldBinWords)], sum);
}

// Of the whole workgroup, all of it at once: what `push` says counts where `pushes`.
void add_pushes(bool pushes, Push push) {
  const uint32_t lane = gl_LocalInvocationIndex;
  if (lane < kTeams) {
    term_bins[lane] = kNone;
    term_slots[lane] = kNone;
    deepest[lane] = 0ul;
    deepest[kTeams + lane] = 0ul;
  }
  if (lane == 0u) any_sheet = 0u;
  barrier();
  if (pushes) put_push(push);
  barrier();
  if (lane < (CARRIERS ? kTerms : kFieldBinWords)) {
    uint32_t key = kNone;
    int64_t sum = 0l;
    for (uint32_t i = 0u; i < kTeams; ++i) {
      const uint32_t its = lane < kFieldBinWords ? term_bins[i] : term_slots[i];
      if (its == kNone) continue;
      if (its != key) {
        flush_term(lane, key, sum);
        key = its;
        sum = 0l;
      }
      sum += terms[lane * kTermsApart + i];
    }
    flush_term(lane, key, sum);
  } else if (!BATCH && lane >= kTerms && lane < kTerms + 2u) {
    const uint32_t which = lane - kTerms;
    uint64_t most = 0ul;
    for (uint32_t i = 0u; i < kTeams; ++i) most = max(most, deepest[which * kTeams + i]);
    if (most != 0ul) atomicMax(field_work[kWordDeepest + which], int64_t(most));   // depths are below 2^31
  } else if (!BATCH && lane == kTerms + 2u && any_sheet != 0u) {
    atomicOr(field_work[kWordSheet], 1l);
  }
}
#endif
