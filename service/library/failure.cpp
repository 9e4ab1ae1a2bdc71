#include "service/library/failure.h"

namespace palpate::library {
namespace {

/// What is handed out when not even an error can be made; never freed.
palpate_error& no_memory() {
  static palpate_error error{PALPATE_INTERNAL, "no memory"};  // short: no allocation
  return error;
}

}  // namespace

std::int32_t fail(std::int32_t code, const std::string& sentence, palpate_error** out) noexcept {
  if (!out) return code;
  try {
    *out = new palpate_error{code, sentence};
  } catch (const std::bad_alloc&) {
    *out = &no_memory();
  }
  return code;
}

}  // namespace palpate::library

using palpate::library::no_memory;

const char* palpate_version(void) { return PALPATE_VERSION; }

std::int32_t palpate_error_code(const palpate_error* error) { return error ? error->code : PALPATE_OK; }
const char* palpate_error_sentence(const palpate_error* error) {
  return error ? error->sentence.c_str() : "";
}
void palpate_error_free(palpate_error* error) {
  if (error != &no_memory()) delete error;
}
