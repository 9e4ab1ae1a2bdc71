#include "tests/mutation/shader_compiler.h"

#include <fstream>
#include <iterator>
#include <memory>
#include <vector>

#include <glslang/Public/ResourceLimits.h>
#include <glslang/Public/ShaderLang.h>
#include <glslang/SPIRV/GlslangToSpv.h>

namespace palpate::mutation {
namespace {

bool with_texels = false;

std::string text_of(const std::string& root, const std::string& name, const TextChange* change,
                    const SmallConstant* constant) {
  std::ifstream file(root + "/" + name);
  std::string text{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  if (change != nullptr && change->file == name)
    text.replace(change->begin, change->end - change->begin, change->text);
  if (constant != nullptr) {
    const std::string before = constant->name + " = ";
    if (const std::size_t at = text.find(before); at != std::string::npos) {
      const std::size_t begin = at + before.size(), end = text.find_first_not_of("0123456789", begin);
      text.replace(begin, end - begin, std::to_string(constant->value));
    }
  }
  return text;
}

/// All our includes are written from the root of the source tree.
class FromRoot final : public glslang::TShader::Includer {
 public:
  FromRoot(const std::string& root, const TextChange* change, const SmallConstant* constant)
      : root_(root), change_(change), constant_(constant) {}
  IncludeResult* includeLocal(const char* name, const char*, size_t) override {
    auto* text = new std::string(text_of(root_, name, change_, constant_));
    return new IncludeResult(root_ + "/" + name, text->data(), text->size(), text);
  }
  void releaseInclude(IncludeResult* result) override {
    if (result == nullptr) return;
    delete static_cast<std::string*>(result->userData);
    delete result;
  }

 private:
  const std::string& root_;
  const TextChange* change_;
  const SmallConstant* constant_;
};

}  // namespace

void compile_with_texels(bool texels) { with_texels = texels; }

std::optional<std::string> compile_shader(const std::string& root, const std::string& name,
                                          const TextChange* change, const SmallConstant* constant) {
  static const bool initialised = glslang::InitializeProcess();
  if (!initialised) return std::nullopt;
  const std::string text = text_of(root, name, change, constant);
  const char* source = text.c_str();
  glslang::TShader shader(EShLangCompute);
  shader.setStrings(&source, 1);
  if (with_texels) shader.setPreamble("#define PALPATE_TEXELS\n");
  shader.setEnvInput(glslang::EShSourceGlsl, EShLangCompute, glslang::EShClientVulkan, 100);
  shader.setEnvClient(glslang::EShClientVulkan, glslang::EShTargetVulkan_1_3);
  shader.setEnvTarget(glslang::EShTargetSpv, glslang::EShTargetSpv_1_6);
  FromRoot includer(root, change, constant);
  const auto messages = static_cast<EShMessages>(EShMsgSpvRules | EShMsgVulkanRules);
  if (!shader.parse(GetDefaultResources(), 100, false, messages, includer)) return std::nullopt;
  glslang::TProgram program;
  program.addShader(&shader);
  if (!program.link(messages) || !program.mapIO()) return std::nullopt;
  std::vector<unsigned> words;
  glslang::SpvOptions options;
  options.disableOptimizer = false;
  glslang::GlslangToSpv(*program.getIntermediate(EShLangCompute), words, &options);
  return std::string(reinterpret_cast<const char*>(words.data()), words.size() * sizeof(unsigned));
}

}  // namespace palpate::mutation
