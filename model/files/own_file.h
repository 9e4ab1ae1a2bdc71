#pragma once
#include <string>

namespace palpate {

/// The file whose code this is: the running program, or the shared library that was built of it, as the
/// loader knows it. Empty: nobody knows. Looked up once.
const std::string& own_file();

}  // namespace palpate
