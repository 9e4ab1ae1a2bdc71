#include "model/import/import_child.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstring>

#include "model/files/one_line.h"
#include "model/import/mesh_parcel.h"

extern char** environ;

namespace palpate {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kOwn = 10;     ///< descriptors of ours lie from here on, clear of those that the child gets
constexpr int kLookMs = 20;  ///< between looks at the clock and at how far it is
constexpr std::size_t kMostWords = 4096;

/// A pipe whose ends close by themselves.
struct Pipe {
  std::array<int, 2> end{-1, -1};
  Pipe() {
    std::array<int, 2> made{};
    if (::pipe2(made.data(), O_CLOEXEC) != 0) return;
    for (std::size_t i = 0; i < 2; ++i) {
      end[i] = ::fcntl(made[i], F_DUPFD_CLOEXEC, kOwn);
      ::close(made[i]);
    }
  }
  ~Pipe() { close(0), close(1); }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;
  void close(std::size_t i) {
    if (end[i] >= 0) ::close(end[i]);
    end[i] = -1;
  }
};

/// posix_spawn's two settings, freed at the end.
struct SpawnSettings {
  posix_spawn_file_actions_t files;
  posix_spawnattr_t attributes;
  SpawnSettings() { posix_spawn_file_actions_init(&files), posix_spawnattr_init(&attributes); }
  ~SpawnSettings() { posix_spawn_file_actions_destroy(&files), posix_spawnattr_destroy(&attributes); }
  SpawnSettings(const SpawnSettings&) = delete;
  SpawnSettings& operator=(const SpawnSettings&) = delete;
};

Result<pid_t> start(const std::string& program, std::array<std::string, 11> arguments, int parcel,
                    int errors) {
  SpawnSettings settings;
  posix_spawn_file_actions_addopen(&settings.files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&settings.files, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_adddup2(&settings.files, errors, STDERR_FILENO);
  posix_spawn_file_actions_adddup2(&settings.files, parcel, kParcelDescriptor);
  posix_spawn_file_actions_addclosefrom_np(&settings.files, kParcelDescriptor + 1);
  // A process group of its own: a terminal's Ctrl-C is ours to answer, and one signal reaches all that it
  // starts.
  sigset_t none, all;
  sigemptyset(&none), sigfillset(&all);
  posix_spawnattr_setsigmask(&settings.attributes, &none);
  posix_spawnattr_setsigdefault(&settings.attributes, &all);
  posix_spawnattr_setpgroup(&settings.attributes, 0);
  posix_spawnattr_setflags(&settings.attributes,
                           POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETPGROUP);
  std::array<char*, 12> argv{};
  for (std::size_t i = 0; i < arguments.size(); ++i) argv[i] = arguments[i].data();
  pid_t child = 0;
  if (const int failed =
          ::posix_spawn(&child, program.c_str(), &settings.files, &settings.attributes, argv.data(), environ);
      failed != 0)
    return Error{ErrorCode::kInternal,
                 fmt::format("the importer '{}' can't be started: {}", program, std::strerror(failed))};
  return child;
}

/// Each stage is a third of the way: which one takes longest depends on the file.
double share_done(const HowFar& far) {
  return (static_cast<double>(far.stage) + far.done) / static_cast<double>(kImportStages);
}

const char* what_is_done(ImportStage stage) {
  constexpr std::array<const char*, kImportStages> kNames{"import", "import, shapes", "import, triangles"};
  return kNames[static_cast<std::size_t>(stage)];
}

/// Keeps the end of what the child says. False at its end.
bool listen(int pipe, std::string& words) {
  std::array<char, 4096> some{};
  const ssize_t count = ::read(pipe, some.data(), some.size());
  if (count <= 0) return count < 0 && (errno == EINTR || errno == EAGAIN);
  words.append(some.data(), static_cast<std::size_t>(count));
  if (words.size() > kMostWords) words.erase(0, words.size() - kMostWords);
  return true;
}

/// The last line that says something, without what would upset a terminal.
std::string last_line(const std::string& words) {
  const std::size_t last = words.find_last_not_of("\r\n \t");
  if (last == std::string::npos) return {};
  const std::size_t first = words.find_last_of('\n', last);
  return one_line(
      words.substr(first == std::string::npos ? 0 : first + 1, std::min<std::size_t>(last - first, 200)));
}

ChildEnd end_of(int status) {
  if (WIFSIGNALED(status))
    return {WTERMSIG(status) == SIGXCPU ? ChildEnd::kOutOfTime : ChildEnd::kCrashed, WTERMSIG(status), {}};
  const int code = WEXITSTATUS(status);
  return {code == 0                  ? ChildEnd::kDone
          : code == kOutOfMemoryExit ? ChildEnd::kOutOfMemory
                                     : ChildEnd::kExited,
          code,
          {}};
}

}  // namespace

Result<ChildEnd> run_import_child(const std::string& program, const std::string& path, double scale,
                                  const ImportLimits& limits, int parcel, const ImportProgress& progress,
                                  const std::string& folder, const Tessellation& tessellation, bool colours) {
  Pipe errors;
  if (errors.end[1] < 0)
    return Error{ErrorCode::kInternal, fmt::format("no pipe for the importer: {}", std::strerror(errno))};
  ::fcntl(errors.end[0], F_SETFL, O_NONBLOCK);
  const auto deadline = Clock::now() + std::chrono::duration<double>(4 * limits.seconds);
  const Result<pid_t> child =
      start(program,
            {program, path, fmt::format("{:a}", scale), std::to_string(limits.memory_bytes),
             fmt::format("{:.0f}", std::ceil(limits.seconds)), folder, std::to_string(::getpid()),
             fmt::format("{:a}", tessellation.deflection_m), fmt::format("{:a}", tessellation.angle_deg),
             tessellation.part, colours ? "1" : "0"},
            parcel, errors.end[1]);
  if (!child) return child.error();
  errors.close(1);  // so that its end is the child's

  std::string words;
  ChildEnd end;
  HowFar far;
  for (bool talking = true;;) {
    pollfd ready{talking ? errors.end[0] : -1, POLLIN, 0};
    if (::poll(&ready, 1, talking ? kLookMs : 1) > 0) talking = listen(errors.end[0], words);
    siginfo_t gone{};
    if (::waitid(P_PID, static_cast<id_t>(*child), &gone, WEXITED | WNOHANG | WNOWAIT) != 0 ||
        gone.si_pid == *child)
      break;
    if (Clock::now() > deadline) end.how = ChildEnd::kOutOfTime;
    if (const HowFar now = how_far(parcel); share_done(now) > share_done(far)) far = now;
    if (end.how == ChildEnd::kDone && progress && !progress(what_is_done(far.stage), share_done(far)))
      end.how = ChildEnd::kStopped;
    if (end.how != ChildEnd::kDone) break;
  }
  // First the whole group, what the child may have started included, then the child's own end: so long its
  // number is not another's.
  ::kill(-*child, SIGKILL);
  int status = 0;
  if (::waitpid(*child, &status, 0) == *child && end.how == ChildEnd::kDone)
    end = end_of(status);  // else, where SIGCHLD is ignored, the parcel tells
  while (words.size() < kMostWords && listen(errors.end[0], words)) {
    pollfd ready{errors.end[0], POLLIN, 0};
    if (::poll(&ready, 1, 0) <= 0) break;
  }
  end.last_words = last_line(words);
  return end;
}

}  // namespace palpate
