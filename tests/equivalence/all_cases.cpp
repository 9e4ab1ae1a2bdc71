#include "tests/equivalence/case.h"

namespace palpate::equivalence {

std::vector<Case> all_cases() {
  std::vector<Case> all;
  for (auto* family :
       {&solid_cases, &chapter_cases, &touch_cases, &topology_cases, &rule_cases, &limit_cases, &fit_cases}) {
    auto cases = (*family)();
    all.insert(all.end(), std::make_move_iterator(cases.begin()), std::make_move_iterator(cases.end()));
  }
  return all;
}

}  // namespace palpate::equivalence
