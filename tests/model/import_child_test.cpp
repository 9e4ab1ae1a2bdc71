// What the importer's process may do to us: nothing. Its stand-in (faulty_reader.cpp) does what a file tells
// it.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <thread>
#include <vector>

#include "model/import/import_child.h"
#include "model/import/mesh_parcel.h"
#include "tests/model/temporary_folder.h"

namespace palpate {
namespace {

using testing::HasSubstr;

constexpr ImportLimits kLimits{.memory_bytes = 400u << 20, .seconds = 20},
    kShort{.memory_bytes = 400u << 20, .seconds = 0.5};

class ImportChild : public testing::Test {
 protected:
  ImportChild() : parcel_(::memfd_create("parcel", MFD_CLOEXEC)) {}
  ~ImportChild() override { ::close(parcel_); }

  ChildEnd run(const std::string& word, const ImportLimits& limits = kLimits,
               const ImportProgress& progress = {}) {
    file_ = folder_.write("mesh.stl", word);
    const auto end = run_import_child(PALPATE_IMPORT_FAULTY, file_, 0.25, limits, parcel_, progress);
    EXPECT_TRUE(end) << end.error().sentence;
    EXPECT_EQ(wait_for(0), 0) << word << " left a process running";
    return end ? *end : ChildEnd{};
  }

  /// Waits until so many are running; a killed process takes its time to go, up to 10 s on a busy machine.
  int wait_for(int count) const {
    for (int i = 0; i < 1000 && running() != count; ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    return running();
  }

  /// Processes that have our file among their arguments, zombies left out.
  int running() const {
    int count = 0;
    for (const auto& entry : std::filesystem::directory_iterator("/proc")) {
      char text[4096];
      std::FILE* file = std::fopen((entry.path() / "cmdline").c_str(),
                                   "r");  // not a stream, which throws when the process goes meanwhile
      if (!file) continue;
      const std::string arguments(text, std::fread(text, 1, sizeof text, file));
      std::fclose(file);
      count +=
          arguments.find("import-faulty") != std::string::npos && arguments.find(file_) != std::string::npos;
    }
    return count;
  }

  TemporaryFolder folder_;
  std::string file_;
  int parcel_;
};

TEST_F(ImportChild, AMeshComesBackWithItsNotes) {
  EXPECT_EQ(run("good").how, ChildEnd::kDone);
  ImportReport report;
  const auto mesh = read_parcel(parcel_, report);
  ASSERT_TRUE(mesh) << mesh.error().sentence;
  EXPECT_EQ(mesh->vertices[1], Vec3(0.25, 0, 0));
  EXPECT_EQ(mesh->parts[0].path, "part");
  EXPECT_THAT(report.notes, testing::ElementsAre("a note"));
}

TEST_F(ImportChild, ARefusalComesBackAsItsSentence) {
  EXPECT_EQ(run("bad").how, ChildEnd::kDone);
  ImportReport report;
  EXPECT_EQ(read_parcel(parcel_, report).error().sentence, "'" + file_ + "' is bad");
}

TEST_F(ImportChild, ACrashIsToldWithItsSignalAndLastWords) {
  const ChildEnd end = run("abort");
  EXPECT_EQ(end.how, ChildEnd::kCrashed);
  EXPECT_EQ(end.detail, SIGABRT);
  EXPECT_EQ(end.last_words, "free(): invalid ?[31mpointer") << "without what a terminal would obey";
}

TEST_F(ImportChild, ABusyHangEndsWithItsProcessorTime) {
  EXPECT_EQ(run("hang", kShort).how, ChildEnd::kOutOfTime);
}

TEST_F(ImportChild, AnIdleHangEndsByTheClock) { EXPECT_EQ(run("sleep", kShort).how, ChildEnd::kOutOfTime); }

#ifndef PALPATE_SANITIZED  // sanitizers reserve terabytes of address space, so there it has no limit
TEST_F(ImportChild, GreedEndsAtTheLimitOfMemory) { EXPECT_EQ(run("greed").how, ChildEnd::kOutOfMemory); }
#endif

TEST_F(ImportChild, EndlessWordsNeitherFillMemoryNorHang) {
  const ChildEnd end = run("chatter", kShort);
  EXPECT_EQ(end.how, ChildEnd::kOutOfTime);
  EXPECT_LE(end.last_words.size(), 200u);
}

TEST_F(ImportChild, WhatItStartedIsGoneToo) { EXPECT_EQ(run("fork").how, ChildEnd::kCrashed); }

TEST_F(ImportChild, ItInheritsNoDescriptor) {
  const int open_to_children = ::open("/dev/null", O_RDONLY);  // on purpose without close-on-exec
  EXPECT_EQ(run("descriptors").last_words, "open: 0 1 2 3");
  ::close(open_to_children);
}

TEST_F(ImportChild, SilenceAndGarbageAreNoMesh) {
  ImportReport report;
  EXPECT_EQ(run("silent").how, ChildEnd::kDone);
  EXPECT_THAT(read_parcel(parcel_, report).error().sentence, HasSubstr("unsound"));
  EXPECT_EQ(run("garbage").how, ChildEnd::kDone);
  EXPECT_THAT(read_parcel(parcel_, report).error().sentence, HasSubstr("unsound"));
}

TEST_F(ImportChild, WhatIsThrownIsARefusal) {
  EXPECT_EQ(run("throw").how, ChildEnd::kDone);
  ImportReport report;
  EXPECT_THAT(read_parcel(parcel_, report).error().sentence, HasSubstr("unknown reason"));
}

TEST_F(ImportChild, ItIsEndedWhenNobodyWantsItAnyMore) {
  int asked = 0;
  EXPECT_EQ(run("sleep", kLimits, [&](const char*, double) { return ++asked < 3; }).how, ChildEnd::kStopped);
}

TEST_F(ImportChild, HowFarItIsGetsThrough) {
  std::vector<std::string> whats;
  double last = 0;
  const ChildEnd end = run("steps", kLimits, [&](const char* what, double done) {
    EXPECT_GE(done, last);
    last = done;
    if (whats.empty() || whats.back() != what) whats.emplace_back(what);
    return done < 0.8;  // it stays at half of its last stage
  });
  EXPECT_EQ(end.how, ChildEnd::kStopped);
  EXPECT_NEAR(last, (2 + 0.5) / 3, 1e-5);
  EXPECT_THAT(whats, testing::ElementsAre("import", "import, shapes", "import, triangles"));
}

TEST_F(ImportChild, NonsenseAboutHowFarItIsDoesNoHarm) {
  double last = -1;
  std::string what;
  const ChildEnd end = run("nonsteps", kLimits, [&](const char* now, double done) {
    EXPECT_TRUE(done >= 0 && done <= 1) << done;
    last = done, what = now;
    return done < 1;
  });
  EXPECT_EQ(end.how, ChildEnd::kStopped);
  EXPECT_EQ(last, 1);
  EXPECT_EQ(what, "import, triangles");
}

TEST_F(ImportChild, ItWorksWhereSignalsOfChildrenAreIgnored) {
  const auto before = std::signal(SIGCHLD, SIG_IGN);
  EXPECT_EQ(run("good").how, ChildEnd::kDone);
  ImportReport report;
  EXPECT_TRUE(read_parcel(parcel_, report));
  std::signal(SIGCHLD, before);
}

TEST_F(ImportChild, ItDiesWithTheOneWhoAsked) {
  file_ = folder_.write("mesh.stl", "sleep");
  const pid_t asker = ::fork();  // this test has one thread
  if (asker == 0) {
    (void)run_import_child(PALPATE_IMPORT_FAULTY, file_, 1, {.memory_bytes = 400u << 20, .seconds = 100},
                           parcel_, {});
    ::_exit(0);
  }
  EXPECT_EQ(wait_for(1), 1);
  ::kill(asker, SIGKILL);
  ::waitpid(asker, nullptr, 0);
  EXPECT_EQ(wait_for(0), 0);
}

// The one who asked may be gone before the child has said that it wants to go with it.
TEST_F(ImportChild, ItDoesNotBeginForOneWhoIsGone) {
  file_ = folder_.write("mesh.stl", "sleep");
  const std::string nobody = std::to_string(::getppid());  // somebody, but not its parent
  const pid_t child = ::fork();
  if (child == 0) {
    ::execl(PALPATE_IMPORT_FAULTY, PALPATE_IMPORT_FAULTY, file_.c_str(), "0x1p+0", "419430400", "100", ".",
            nobody.c_str(), "0", "15", "", "1", nullptr);
    ::_exit(127);
  }
  int status = -1;
  pid_t ended = 0;
  for (int i = 0; i < 1000 && ended == 0; ++i) {  // 10 s on a busy machine
    ended = ::waitpid(child, &status, WNOHANG);
    if (ended == 0) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  if (ended == 0) ::kill(child, SIGKILL), ::waitpid(child, &status, 0);
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 1);
}

TEST_F(ImportChild, AMissingProgramIsToldByName) {
  const auto end = run_import_child("/nowhere/palpate-import", "a.stl", 1, kLimits, parcel_, {});
  ASSERT_FALSE(end);
  EXPECT_THAT(end.error().sentence, HasSubstr("/nowhere/palpate-import"));
}

}  // namespace
}  // namespace palpate
