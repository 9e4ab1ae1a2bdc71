// palpate-import and palpate-import-cad: read one mesh file, in a process of its own, and hand the mesh back
// as a parcel. import_mesh() starts them; nobody else does. Exit codes: 0 the parcel is complete, be it a
// mesh or why there is none; 1 there is none, or its asker has gone; 12 an allocation failed; 2 called by
// hand.
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <new>
#include <string>

#include "model/import/import_child.h"
#include "model/import/mesh_parcel.h"
#include "model/import/mesh_read.h"

namespace palpate {
namespace {

void limit(__rlimit_resource what, rlim_t soft, rlim_t hard) {
  rlimit now{};
  if (::getrlimit(what, &now) != 0) return;
  const rlimit lower{std::min(soft, now.rlim_max),
                     std::min(hard, now.rlim_max)};  // never above what somebody set before us
  ::setrlimit(what, &lower);
}

/// Before the first byte of the file is read.
void limit_myself(rlim_t memory_bytes, rlim_t seconds, pid_t asker) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);       // nothing outlives the one who asked,
  if (::getppid() != asker) std::_Exit(1);  // not even if that one went before this was said
  ::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0);
  limit(RLIMIT_CPU, seconds, seconds + 1);
  limit(RLIMIT_CORE, 0, 0);
  limit(RLIMIT_FSIZE, kLargestParcel, kLargestParcel);
#ifndef PALPATE_SANITIZED  // sanitizers reserve terabytes of address space
  limit(RLIMIT_AS, memory_bytes, memory_bytes);
  std::set_new_handler([] { std::_Exit(kOutOfMemoryExit); });
#else
  static_cast<void>(memory_bytes);
#endif
  // When memory runs out on the whole machine, this process is the one to go.
  if (std::FILE* score = std::fopen("/proc/self/oom_score_adj", "w")) {
    std::fputs("1000", score);
    std::fclose(score);
  }
}

Result<Mesh> read(const char* path, double scale, const char* folder, const Tessellation& tessellation,
                  bool colours, ImportReport& report) {
  try {
    return read_mesh(
        path, scale, report, folder, tessellation,
        [](const HowFar& far) { tell_how_far(kParcelDescriptor, far); }, colours);
  } catch (...) {  // even what is no std::exception
    return bad_value(std::string("'") + path + "' can't be read: the import failed for an unknown reason");
  }
}

}  // namespace
}  // namespace palpate

int main(int argc, char** argv) {
  using namespace palpate;
  if (argc != 11) {
    std::fputs("this is a part of palpate, which starts it to read a mesh file; use `palpate info FILE`\n",
               stderr);
    return static_cast<int>(ErrorCode::kUsage);
  }
  limit_myself(std::strtoull(argv[3], nullptr, 10), std::strtoull(argv[4], nullptr, 10), std::atoi(argv[6]));
  ImportReport report;
  const Tessellation tessellation{std::strtod(argv[7], nullptr), std::strtod(argv[8], nullptr), argv[9]};
  const bool written = write_parcel(kParcelDescriptor,
                                    read(argv[1], std::strtod(argv[2], nullptr), argv[5], tessellation,
                                         argv[10] == std::string("1"), report),
                                    report);
  std::_Exit(written ? 0 : 1);  // taking it all apart first would cost as much as a tenth of the reading
}
