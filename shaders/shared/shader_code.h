#pragma once
#include <cstddef>
#include <cstdint>

namespace palpate {

/// A SPIR-V module embedded in the program.
struct ShaderCode {
  const char* name;  ///< the file's name without its ending
  const std::uint32_t* words;
  std::size_t bytes;
  /// The same compiled with PALPATE_TEXELS (shaders/lib/frame.glsl), for VulkanDevice::texels(); null where
  /// that changes nothing.
  const std::uint32_t* texel_words = nullptr;
  std::size_t texel_bytes = 0;
};

}  // namespace palpate
