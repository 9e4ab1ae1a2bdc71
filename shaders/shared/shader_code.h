#pragma once
#include <cstddef>
#include <cstdint>

namespace palpate {

/// A SPIR-V module embedded in the program.
struct ShaderCode {
  const char* name;  ///< the file's name without its ending
  const std::uint32_t* words;
  std::size_t bytes;
};

}  // namespace palpate
