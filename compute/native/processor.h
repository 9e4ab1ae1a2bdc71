#pragma once

// Code for the processor at hand. Hot loops are compiled twice, for every processor and once more for those
// with AVX2, and a look at the processor decides which runs. Nothing that is computed depends on it: integers
// decide, floating-point numbers only sort out, within bounds that hold for both (docs/EXACTNESS.md).

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)
#define PALPATE_TWO_CODES 1
#else
#define PALPATE_TWO_CODES 0
#endif

namespace palpate {

#if PALPATE_TWO_CODES
/// Whether the second code runs here.
inline bool has_second_code() {
  return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("bmi") && __builtin_cpu_supports("bmi2") &&
         __builtin_cpu_supports("popcnt");
}

/// Calls body() with all that it calls, as far as it is seen here, drawn in and compiled for AVX2.
template <class Body>
[[gnu::target("avx2,bmi,bmi2,popcnt"), gnu::flatten, gnu::noinline]] auto run_second_code(Body& body) {
  return body();
}
#endif

/// Calls body() in the best code for this processor. For loops over single numbers: GCC takes vectors apart
/// before it draws code in. Code of vectors is a file that is included twice, the second time after
/// PALPATE_SECOND_CODE_BEGIN.
template <class Body>
auto on_this_processor(Body body) {
#if PALPATE_TWO_CODES
  if (has_second_code()) return run_second_code(body);
#endif
  return body();
}

}  // namespace palpate

#define PALPATE_SECOND_CODE_BEGIN _Pragma("GCC push_options") _Pragma("GCC target(\"avx2,bmi,bmi2,popcnt\")")
#define PALPATE_SECOND_CODE_END _Pragma("GCC pop_options")
