#include "csrbf/core/interruption.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/core/parallel.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>

namespace csrbf::interruption_test {
namespace {

TEST(Interruptible, WorkGoesOnWhereNobodyAsks) {
  EXPECT_NO_THROW(stop_if_interrupted());
  {
    const Interruptible stopped([] { return true; });
  }
  EXPECT_NO_THROW(stop_if_interrupted());
}

TEST(Interruptible, WorkEndsWithCancelledWhenInterrupted) {
  bool interrupted = false;
  const Interruptible work([&] { return interrupted; });
  EXPECT_NO_THROW(stop_if_interrupted());
  interrupted = true;
  EXPECT_THROW(stop_if_interrupted(), Cancelled);
}

TEST(Interruptible, TheInnermostIsAsked) {
  const Interruptible outer([] { return true; });
  {
    const Interruptible inner([] { return false; });
    EXPECT_NO_THROW(stop_if_interrupted());
  }
  EXPECT_THROW(stop_if_interrupted(), Cancelled);
}

TEST(Interruptible, OtherThreadsAreNotConcerned) {
  const Interruptible stopped([] { return true; });
  std::thread([] { EXPECT_NO_THROW(stop_if_interrupted()); }).join();
}

TEST(Interruptible, LoopsStopBetweenTheirRanges) {
  for (const int threads : {1, 2, 4}) {
    set_thread_count(threads);
    std::atomic<int> ranges{0};
    const std::thread::id caller = std::this_thread::get_id();
    const Interruptible work([&] {
      EXPECT_EQ(std::this_thread::get_id(), caller);
      return ranges >= 10;
    });
    EXPECT_THROW(parallel_for(1'000'000, 1,
                              [&](Index, Index) {
                                ++ranges;
                                std::this_thread::yield();
                              }),
                 Cancelled);
    EXPECT_GE(ranges, 10);
    EXPECT_LT(ranges, 1'000'000);
  }
  set_thread_count(0);
}

TEST(Interruptible, LoopsInsideLoopsStopToo) {
  set_thread_count(1);
  int ranges = 0;
  const Interruptible work([&] { return ranges >= 10; });
  EXPECT_THROW(parallel_for(1, 1, [&](Index, Index) { parallel_for(100, 1, [&](Index, Index) { ++ranges; }); }),
               Cancelled);
  EXPECT_EQ(ranges, 10);
  set_thread_count(0);
}

TEST(InterruptionPoint, AsksEverySoManySteps) {
  int asked = 0;
  const Interruptible work([&] {
    ++asked;
    return false;
  });
  InterruptionPoint pause(8);
  for (int step = 0; step < 7; ++step) pause();
  EXPECT_EQ(asked, 0);
  for (int step = 7; step < 80; ++step) pause();
  EXPECT_EQ(asked, 10);
}

}  // namespace
}  // namespace csrbf::interruption_test
