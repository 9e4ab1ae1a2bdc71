#pragma once
#include <string>

namespace palpate {

/// Says where the program palpate-import is, for a program that has it neither beside itself nor in
/// ../libexec/palpate. Call before anything is imported, from one thread.
void set_import_program(std::string path);

/// What set_import_program said; empty at first.
const std::string& told_import_program();

#ifdef PALPATE_IMPORT_PROGRAM
/// find_package(palpate) defines it: whoever includes a header that can import knows the importer that was
/// installed with the library.
inline const bool kImportProgramTold = (set_import_program(PALPATE_IMPORT_PROGRAM), true);
#endif

}  // namespace palpate
