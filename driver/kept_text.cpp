#include "driver/kept_text.h"

#include <mutex>
#include <set>

namespace palpate {

const char* kept_text(const std::string& text) {
  static std::mutex mutex;
  static auto& texts =
      *new std::set<std::string>;  // never taken down: a thread may still be telling when the program ends
  const std::lock_guard lock(mutex);
  return texts.insert(text).first->c_str();  // a set's elements stay where they are
}

}  // namespace palpate
