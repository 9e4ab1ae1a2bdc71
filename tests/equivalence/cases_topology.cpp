#include "tests/equivalence/case.h"

namespace palpate::equivalence {

std::vector<Case> topology_cases() { return {}; }

}  // namespace palpate::equivalence
