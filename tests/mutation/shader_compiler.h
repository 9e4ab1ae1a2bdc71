#pragma once
#include <cstddef>
#include <optional>
#include <string>

namespace palpate::mutation {

/// Bytes [begin, end) of `file` (its name from the source tree's root) become `text`.
struct TextChange {
  std::string file;
  std::size_t begin = 0, end = 0;
  std::string text;
};

/// SPIR-V of a shader, given by its name from `root`, with or without a change in it or in what it includes: word for word what
/// glslangValidator makes of it in the build. In this process, because starting glslangValidator takes 20 times as long as a shader.
/// Empty when it doesn't compile.
std::optional<std::string> compile_shader(const std::string& root, const std::string& name, const TextChange* change);

}  // namespace palpate::mutation
