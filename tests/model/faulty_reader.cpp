// Stands in for the importer in palpate-import-faulty: does what the file's first word says.
#include <sys/stat.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <vector>

#include "model/import/import_child.h"
#include "model/import/mesh_read.h"

namespace palpate {
namespace {

[[noreturn]] void greed() {
  std::vector<char*> kept;
  for (;;) {
    kept.push_back(new char[1 << 20]);
    for (int i = 0; i < 1 << 20; i += 4096) kept.back()[i] = 1;
  }
}

[[noreturn]] void burn() {
  for (volatile unsigned i = 0;;) i = i + 1;
}

[[noreturn]] void chatter() {
  for (;;) std::fputs("words and words and words\n", stderr);
}

/// Leaves a process behind that would live for ever, and dies.
[[noreturn]] void leave_one_behind() {
  if (::fork() == 0)
    for (;;) ::pause();
  std::abort();  // not SIGSEGV, which a sanitizer turns into an exit code
}

/// Each step for a time that who asks can't miss; back once, which counts for nothing.
[[noreturn]] void take_steps(const TellHowFar& tell) {
  constexpr HowFar kSteps[] = {{ImportStage::kRead, 0.9},
                               {ImportStage::kShapes, 0.2},
                               {ImportStage::kRead, 0.5},
                               {ImportStage::kTriangles, 0.5}};
  for (const HowFar& step : kSteps) {
    tell(step);
    ::usleep(400'000);
  }
  for (;;) ::pause();
}

[[noreturn]] void tell_descriptors() {
  std::fputs("open:", stderr);
  struct stat status {};
  for (int i = 0; i < 1024; ++i)
    if (::fstat(i, &status) == 0) std::fprintf(stderr, " %d", i);
  std::fputs("\n", stderr);
  std::_Exit(7);
}

}  // namespace

Result<Mesh> read_mesh(const std::string& path, double scale, ImportReport& report,
                       const std::string& /*folder*/, const Tessellation&, const TellHowFar& tell,
                       bool /*colours*/) {
  std::string word;
  std::ifstream(path) >> word;
  if (word == "crash") std::raise(SIGSEGV);
  if (word == "abort") std::fputs("first line\nfree(): invalid \x1b[31mpointer\n", stderr), std::abort();
  if (word == "hang") burn();
  if (word == "sleep")
    for (;;) ::pause();
  if (word == "greed") greed();
  if (word == "chatter") chatter();
  if (word == "fork") leave_one_behind();
  if (word == "descriptors") tell_descriptors();
  if (word == "silent") std::_Exit(0);
  if (word == "throw") throw 7;
  if (word == "garbage") {
    const std::string noise(1000, 'x');
    std::_Exit(::pwrite(kParcelDescriptor, noise.data(), noise.size(), 0) > 0 ? 0 : 1);
  }
  if (word == "steps") take_steps(tell);
  if (word == "nonsteps") {
    const char nonsense[] = "far\xff\xff\xff\xff\xff";  // stage 255, 4295 times done
    if (::pwrite(kParcelDescriptor, nonsense, 8, 0) == 8)
      for (;;) ::pause();
  }
  if (word == "bad") return bad_value("'" + path + "' is bad");
  report.notes.emplace_back("a note");
  return Mesh{{Vec3(0), Vec3(scale, 0, 0), Vec3(0, scale, 0)}, {{0, 1, 2}}, {{"part", 0, 1}}};
}

}  // namespace palpate
