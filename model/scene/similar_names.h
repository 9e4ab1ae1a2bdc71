#pragma once
#include <string>
#include <vector>

namespace palpate {

/// Up to three of `names` that are spelt most like `name`, as the end of a sentence: "; did you mean 'a', 'b'
/// or 'c'?". Empty when none is near (more than half of the longer word would have to change).
std::string similar_names(const std::string& name, const std::vector<std::string>& names);

}  // namespace palpate
