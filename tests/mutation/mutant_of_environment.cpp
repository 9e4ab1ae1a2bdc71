// Turns the mutant on whose number PALPATE_MUTANT is, in a program of tests that is linked with all of them.
#include <cstdlib>

#include "tests/mutation/mutant_switch.h"

namespace palpate::mutation {
namespace {

[[maybe_unused]] const int number = [] {
  const char* const text = std::getenv("PALPATE_MUTANT");
  return active = text == nullptr ? 0 : std::atoi(text);
}();

}  // namespace
}  // namespace palpate::mutation
