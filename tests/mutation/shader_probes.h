#pragma once
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "compute/vulkan/device.h"

namespace palpate::mutation {

/// The probes of tests/compute, asked of mutants: small modules that call one function of shaders/lib for
/// thousands of cases where points, edges and planes coincide, or numbers lie at their bounds. tests/compute
/// holds the same cases against the definitions.
class ShaderProbes {
 public:
  /// `device` outlives this.
  explicit ShaderProbes(VulkanDevice& device);

  /// Whether there is a probe of this source file.
  bool has(const std::string& name) const { return probes_.contains(name); }

  /// What differs between the answers of a probe's module and those of its mutant, SPIR-V; empty: nothing.
  /// Throws std::runtime_error where the unchanged module fails.
  std::string difference(const std::string& name, const std::string& original, const std::string& mutant);

 private:
  using Bytes = std::vector<unsigned char>;
  struct Probe {
    Bytes cases;
    std::uint32_t count = 0;
    std::size_t answer_bytes = 0;  ///< of all
    Bytes known;                   ///< empty: not asked yet
  };
  template <class Answer, class Case>
  void add(const char* name, const std::vector<Case>& cases);
  std::string run(const Probe& probe, const std::string& code, Bytes& answers);

  VulkanDevice& device_;
  std::map<std::string, Probe> probes_;
};

}  // namespace palpate::mutation
