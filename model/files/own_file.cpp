#include "model/files/own_file.h"

#include <link.h>
#include <unistd.h>

#include <cstdint>
#include <filesystem>

namespace palpate {
namespace {

namespace fs = std::filesystem;

/// What is loaded where this function is.
struct Search {
  std::uintptr_t address;
  const char* name = nullptr;  ///< "" for the program itself
};

int look(dl_phdr_info* loaded, std::size_t, void* data) {
  Search& search = *static_cast<Search*>(data);
  for (int i = 0; i < loaded->dlpi_phnum; ++i) {
    const auto& segment = loaded->dlpi_phdr[i];
    const std::uintptr_t begin = loaded->dlpi_addr + segment.p_vaddr;
    if (segment.p_type != PT_LOAD || search.address < begin || search.address - begin >= segment.p_memsz)
      continue;
    search.name = loaded->dlpi_name;
    return 1;
  }
  return 0;
}

}  // namespace

const std::string& own_file() {
  static const std::string file = [] {
    Search search{reinterpret_cast<std::uintptr_t>(&look)};
    dl_iterate_phdr(&look, &search);
    if (search.name == nullptr) return std::string();
    std::error_code fault;
    const fs::path path =
        *search.name == '\0' ? fs::read_symlink("/proc/self/exe", fault) : fs::canonical(search.name, fault);
    return fault ? std::string() : path.string();
  }();
  return file;
}

}  // namespace palpate
