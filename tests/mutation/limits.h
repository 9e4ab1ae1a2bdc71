#pragma once
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "tests/mutation/mutable_device.h"
#include "tests/mutation/oracle.h"
#include "tests/mutation/shader_compiler.h"

namespace palpate::mutation {

/// Asks shaders in which a constant has been made so small that small cases come to it: loop budgets,
/// workgroups a row, entries that a table or an array of a shader holds. No case that takes milliseconds
/// meets the true ones. A mutant is held against the unchanged modules with the same constant.
class Limits {
 public:
  /// All outlive this. `root`: of the source tree.
  Limits(Oracle& oracle, MutableDevice& device, std::string root)
      : oracle_(oracle), device_(device), root_(std::move(root)) {}

  struct Limit {
    const char* file;      ///< a change in it asks for this; "": any of frame/ and response/
    const char* constant;  ///< "": the room in `list` instead
    std::uint32_t value;   ///< 0: the smallest with which no pose of the case is cut short, and one less
    std::vector<const char*> words;  ///< all modules of frames have the constant that have one of these
                                     ///< words; none: those that are changed
    std::vector<const char*> cases;
    const char* list = "";  ///< a list or table that is small, too
    bool unlisted = false;  ///< without preparation's list of samples
  };

  /// What differs, with `of` the case; empty: nothing. `modules`: those of a frame that `change` changes.
  /// Leaves nothing swapped.
  std::string first_difference(const TextChange& change, const std::vector<std::string>& modules,
                               std::size_t& of);

 private:
  /// A module, as it is and with a constant changed.
  struct Module {
    std::string name, before, after;
  };
  using Told = std::vector<std::string>;  // of each pose

  const std::string& original(const std::string& name);
  /// Of `names`, the modules that a constant changes.
  std::vector<Module> with(const Limit& limit, std::uint32_t value, const std::vector<std::string>& names);
  /// Modules of frames that have one of these words.
  std::vector<std::string> having(const std::vector<const char*>& words);
  std::string swap(const std::vector<Module>& modules);
  Told tell(const Limit& limit, std::uint32_t value, std::size_t of);
  /// What the unchanged modules tell of cases.
  std::vector<Told> known(const Limit& limit, std::uint32_t value, const std::vector<Module>& modules,
                          const std::vector<std::size_t>& of);
  /// The smallest value with which no pose is cut short.
  std::uint32_t smallest(const Limit& limit, const std::vector<std::string>& names, std::size_t of);
  /// What differs first, with `at` the case.
  std::string ask(const Limit& limit, std::uint32_t value, const TextChange& change,
                  const std::vector<std::string>& modules, const std::vector<std::size_t>& of,
                  std::size_t& at);

  Oracle& oracle_;
  MutableDevice& device_;
  std::string root_;
  std::map<std::string, std::string> texts_;              // of modules of frames
  std::map<std::string, std::string> originals_, small_;  // SPIR-V of modules; with a constant
  std::map<std::string, Told> known_;
};

}  // namespace palpate::mutation
