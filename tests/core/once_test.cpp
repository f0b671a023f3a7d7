#include "csrbf/core/once.hpp"

#include "csrbf/core/parallel.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cstdlib>
#include <future>
#include <iostream>
#include <stdexcept>
#include <thread>

namespace csrbf::once_test {
namespace {

// Restores the default number of threads after each test.
class MadeOnce : public ::testing::Test {
 protected:
  ~MadeOnce() override { set_thread_count(0); }
};

// Ends the process where threads wait for each other: they cannot be stopped.
void expect_end(const std::future<void>& thread) {
  if (thread.wait_for(std::chrono::seconds(60)) == std::future_status::ready) return;
  std::cerr << "threads wait for each other" << std::endl;
  std::_Exit(1);
}

Index sum_by_a_loop() {
  std::atomic<Index> sum{0};
  parallel_for(1000, 10, [&](Index begin, Index end) {
    for (Index i = begin; i < end; ++i) sum += i;
  });
  return sum;
}

TEST_F(MadeOnce, IsMadeAtTheFirstQuestionOnly) {
  Once once;
  int calls = 0;
  for (int repeat = 0; repeat < 3; ++repeat) once.call([&] { ++calls; });
  EXPECT_EQ(calls, 1);
}

TEST_F(MadeOnce, IsMadeOnceByTheThreadsOfALoop) {
  set_thread_count(4);
  for (int repeat = 0; repeat < 50; ++repeat) {
    Once once;
    Index made = 0;
    parallel_for(16, 1, [&](Index, Index) {
      once.call([&] { made += sum_by_a_loop(); });
      EXPECT_EQ(made, 499500);
    });
  }
}

TEST_F(MadeOnce, IsMadeByTheNextQuestionIfItThrows) {
  Once once;
  EXPECT_THROW(once.call([] { throw std::runtime_error("not now"); }), std::runtime_error);
  bool made = false;
  once.call([&] { made = true; });
  EXPECT_TRUE(made);
  EXPECT_EQ(sum_by_a_loop(), 499500);  // loops are free again
}

TEST_F(MadeOnce, MayNeedAnotherOneAndAnotherNumberOfThreads) {
  set_thread_count(2);
  Once outer, inner;
  Index made = 0;
  outer.call([&] {
    set_thread_count(3);
    inner.call([&] { made = sum_by_a_loop(); });
  });
  EXPECT_EQ(made, 499500);
  EXPECT_EQ(thread_count(), 3);
}

// What is made runs loops, for which the thread outside would wait until the loop has ended that waits for it.
TEST_F(MadeOnce, IsAskedForInALoopWhileAThreadOutsideMakesIt) {
  set_thread_count(2);
  for (int repeat = 0; repeat < 20; ++repeat) {
    Once once;
    Index made = 0;
    std::atomic<bool> running{false};
    const auto make = [&] { made += sum_by_a_loop(); };
    const auto in_loop = std::async(std::launch::async, [&] {
      parallel_for(2, 1, [&](Index, Index) {
        running = true;
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
        once.call(make);
        EXPECT_EQ(made, 499500);
      });
    });
    while (!running) std::this_thread::yield();
    const auto outside = std::async(std::launch::async, [&] { once.call(make); });
    expect_end(in_loop);
    expect_end(outside);
    EXPECT_EQ(made, 499500);
  }
}

}  // namespace
}  // namespace csrbf::once_test
