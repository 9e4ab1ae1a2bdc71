#pragma once
#include <cstddef>
#include <cstdint>

/// What a fuzz target is, to libFuzzer and to replay.cpp alike: must come back from any input without a
/// crash, a leak or a broken promise.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

/// A promise that any input must keep; on in every build.
#define PALPATE_PROMISE(condition)      \
  do {                                  \
    if (!(condition)) __builtin_trap(); \
  } while (false)
