// Runs a fuzz target without libFuzzer: on every file of its corpus, then on seeded mutations of them, the
// same ones every time. usage: TARGET CORPUS_FOLDER MUTATIONS        every file, and MUTATIONS of them in all
//        TARGET FILE                           that file alone
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

#include "tests/fuzz/fuzz_target.h"

extern "C" const char* __asan_default_options();
extern "C" const char* __asan_default_options() { return "abort_on_error=1:allocator_may_return_null=1"; }

namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr unsigned kSecondsAnInput =
    20;  ///< a hang is a failure; the slowest input takes a tenth of a second
constexpr std::size_t kLargest = 1 << 16;

// For the handler alone: which input is running.
std::array<char, 512> running{};

extern "C" void on_death(int number) {
  const char* what = number == SIGALRM ? "hangs on " : "dies on ";
  (void)!write(STDERR_FILENO, what, std::strlen(what));
  (void)!write(STDERR_FILENO, running.data(), std::strlen(running.data()));
  (void)!write(STDERR_FILENO, "\n", 1);
  std::signal(number, SIG_DFL);
  if (number == SIGALRM) _exit(1);
  std::raise(number);
}

void run(const Bytes& input, const std::string& name) {
  std::snprintf(running.data(), running.size(), "%s", name.c_str());
  alarm(kSecondsAnInput);
  (void)LLVMFuzzerTestOneInput(input.data(), input.size());
  alarm(0);
}

Bytes bytes_of(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

/// One to eight small changes: a bit, a byte, a count, a word, a piece taken out, doubled or borrowed from
/// another file.
Bytes mutated(Bytes input, const Bytes& other, std::mt19937_64& random) {
  static const std::array<std::string, 12> words{"-1",           "0",   "1e999", "nan", "-0", "4294967295",
                                                 "353535235358", "0.5", "\"",    "\n",  ",",  "#"};
  static const std::array<std::uint32_t, 8> counts{0,          1,          0x7fffffff, 0x80000000,
                                                   0xffffffff, 0xfffffffe, 0x10000,    0x40000000};
  const auto below = [&](std::size_t n) {
    return n == 0 ? std::size_t{0} : static_cast<std::size_t>(random() % n);
  };
  for (std::size_t change = 0, changes = 1 + below(8); change < changes; ++change) {
    const std::size_t at = below(input.size() + 1), room = input.size() - at,
                      length = 1 + below(std::min<std::size_t>(room, 32));
    const auto here = input.begin() + static_cast<std::ptrdiff_t>(at);
    switch (below(7)) {
      case 0:
        if (room > 0) *here ^= static_cast<std::uint8_t>(1u << below(8));
        break;
      case 1:
        if (room > 0) *here = static_cast<std::uint8_t>(random());
        break;
      case 2:
        if (room >= 4) std::memcpy(&*here, &counts[below(counts.size())], 4);
        break;
      case 3: {
        const std::string& word = words[below(words.size())];
        input.insert(here, word.begin(), word.end());
        break;
      }
      case 4:
        if (room >= length) input.erase(here, here + static_cast<std::ptrdiff_t>(length));
        break;
      case 5:
        if (room >= length) {
          const Bytes piece(here, here + static_cast<std::ptrdiff_t>(length));
          input.insert(here, piece.begin(), piece.end());
        }
        break;
      default: {
        const std::size_t from = below(other.size()), size = std::min(other.size() - from, length);
        input.insert(here, other.begin() + static_cast<std::ptrdiff_t>(from),
                     other.begin() + static_cast<std::ptrdiff_t>(from + size));
      }
    }
  }
  if (input.size() > kLargest) input.resize(kLargest);
  return input;
}

}  // namespace

int main(int argc, char** argv) {
  for (const int number : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGALRM}) std::signal(number, on_death);
  if (argc == 2) {
    run(bytes_of(argv[1]), argv[1]);
    return 0;
  }
  if (argc != 3) {
    std::fprintf(stderr, "usage: %s CORPUS_FOLDER MUTATIONS | FILE\n", argv[0]);
    return 2;
  }
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(argv[1])) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  if (files.empty()) {
    std::fprintf(stderr, "%s: no file in %s\n", argv[0], argv[1]);
    return 1;
  }
  std::vector<Bytes> corpus;
  for (const auto& file : files) {
    corpus.push_back(bytes_of(file));
    run(corpus.back(), file.string());
  }
  const std::uint64_t mutations = std::strtoull(argv[2], nullptr, 10);
  for (std::uint64_t i = 0; i < mutations; ++i) {
    std::mt19937_64 random(i);  // each by its own seed, so that any can be repeated alone
    const std::size_t file = i % files.size();
    run(mutated(corpus[file], corpus[static_cast<std::size_t>(random() % corpus.size())], random),
        files[file].string() + ", mutation " + std::to_string(i));
  }
  std::printf("%zu files, %llu mutations\n", files.size(), static_cast<unsigned long long>(mutations));
  return 0;
}
