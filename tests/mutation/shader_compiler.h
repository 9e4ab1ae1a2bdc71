#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

namespace palpate::mutation {

/// Bytes [begin, end) of `file` (its name from the source tree's root) become `text`.
struct TextChange {
  std::string file;
  std::size_t begin = 0, end = 0;
  std::string text;
};

/// A constant of the shaders' text (`name = number`) that has another value.
struct SmallConstant {
  std::string name;
  std::uint32_t value = 0;
};

/// SPIR-V of a shader, given by its name from `root`, with or without a change in it or in what it includes,
/// or another value of a constant there: word for word what glslangValidator makes of it in the build. In
/// this process, because starting glslangValidator takes 20 times as long as a shader. Empty when it doesn't
/// compile.
std::optional<std::string> compile_shader(const std::string& root, const std::string& name,
                                          const TextChange* change, const SmallConstant* constant = nullptr);

/// From now on shaders are compiled as for a device that reads texels (VulkanDevice::texels()), or not.
void compile_with_texels(bool texels);

}  // namespace palpate::mutation
