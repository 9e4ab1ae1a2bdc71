#include "service/loop/thread_share.h"

#include <gtest/gtest.h>
#include <sched.h>
#include <sys/prctl.h>

#include <functional>
#include <memory>
#include <semaphore>
#include <thread>
#include <utility>

namespace palpate {
namespace {

cpu_set_t mine() {
  cpu_set_t may{};
  EXPECT_EQ(sched_getaffinity(0, sizeof may, &may), 0);
  return may;
}
bool same(const cpu_set_t& a, const cpu_set_t& b) { return CPU_EQUAL(&a, &b); }

/// A thread that does what it is told, each task before the caller goes on.
class Worker {
 public:
  Worker() : thread_([this] { serve(); }) {}
  ~Worker() {
    does(nullptr);
    thread_.join();
  }
  void does(std::function<void()> task) {
    task_ = std::move(task);
    told_.release();
    done_.acquire();
  }
  /// Where it may run.
  cpu_set_t may() {
    cpu_set_t out{};
    does([&] { out = mine(); });
    return out;
  }

 private:
  void serve() {
    for (bool more = true; more;) {
      told_.acquire();
      more = static_cast<bool>(task_);
      if (more) task_();
      done_.release();
    }
  }

  std::function<void()> task_;  ///< empty: end
  std::binary_semaphore told_{0}, done_{0};
  std::thread thread_;
};

class LoopRoomTest : public testing::Test {
 protected:
  void SetUp() override {
    rest = all;
    if (loop_processor() >= 0)  // else there is but one, and nobody moves
      CPU_CLR(static_cast<std::size_t>(loop_processor()), &rest);
  }
  cpu_set_t all = mine(), rest = all;
};

TEST_F(LoopRoomTest, MovesAllThreadsOffTheLoopsProcessorAndBack) {
  Worker other;
  {
    const LoopRoom room;
    EXPECT_TRUE(same(mine(), rest));
    EXPECT_TRUE(same(other.may(), rest));
    Worker later;  // begins where its maker is
    EXPECT_TRUE(same(later.may(), rest));
  }
  EXPECT_TRUE(same(mine(), all));
  EXPECT_TRUE(same(other.may(), all));
}

TEST_F(LoopRoomTest, LastsUntilTheLastLoopIsOver) {
  auto first = std::make_unique<LoopRoom>();
  {
    const LoopRoom second;
    first.reset();
    EXPECT_TRUE(same(mine(), rest));
  }
  EXPECT_TRUE(same(mine(), all));
}

TEST_F(LoopRoomTest, LeavesWhoWorksForAHandWhereItIs) {
  Worker before, within;
  std::unique_ptr<ForHand> one, two;
  before.does([&] { one = std::make_unique<ForHand>(); });
  {
    const LoopRoom room;
    EXPECT_TRUE(same(before.may(), all));
    within.does([&] { two = std::make_unique<ForHand>(); });
    EXPECT_TRUE(same(within.may(), all));
    before.does([&] { one.reset(); });  // works for a hand no more
    EXPECT_TRUE(same(before.may(), rest));
  }
  EXPECT_TRUE(same(before.may(), all));
  EXPECT_TRUE(same(within.may(), all));
  within.does([&] { two.reset(); });
}

TEST_F(LoopRoomTest, LeavesADriversThreadsWhereTheyAre) {
  Worker preparation, other;
  std::unique_ptr<Worker> before, within;
  const auto make = [&](std::unique_ptr<Worker>& driver) {
    preparation.does([&] {
      const MakesForHand making;
      driver = std::make_unique<Worker>();
    });
  };
  make(before);
  const LoopRoom room;
  make(within);
  EXPECT_TRUE(same(before->may(), all));
  EXPECT_TRUE(same(within->may(), all));
  EXPECT_TRUE(same(preparation.may(), rest)) << "it gives way again";
  EXPECT_TRUE(same(other.may(), rest));
}

TEST_F(LoopRoomTest, GivesAThreadItsOwnPlaceBack) {
  Worker bound;
  cpu_set_t own{};
  if (loop_processor() < 0)
    own = all;
  else
    CPU_SET(static_cast<std::size_t>(loop_processor()), &own);
  bound.does([&] { EXPECT_EQ(sched_setaffinity(0, sizeof own, &own), 0); });
  {
    const LoopRoom room;
    EXPECT_TRUE(same(bound.may(), own)) << "there is nowhere else for it to go";
  }
  EXPECT_TRUE(same(bound.may(), own));
}

TEST(ThreadShare, SleepsExactly) {
  Worker loop;
  int slack = 0;
  loop.does([&] {
    set_exact_sleep();
    slack = prctl(PR_GET_TIMERSLACK);
  });
  EXPECT_EQ(slack, 1);
}

}  // namespace
}  // namespace palpate
