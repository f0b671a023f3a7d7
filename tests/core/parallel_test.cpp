#include "csrbf/core/parallel.hpp"

#include "csrbf/core/error.hpp"

#include <gtest/gtest.h>

#ifndef _WIN32
#include <dlfcn.h>
#include <sys/wait.h>
#include <unistd.h>
#endif

#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <mutex>
#include <set>
#include <stdexcept>
#include <thread>
#include <vector>

namespace csrbf::parallel_test {
namespace {

// Restores the default number of threads after each test.
class Parallel : public ::testing::Test {
 protected:
  ~Parallel() override { set_thread_count(0); }
};

using Ranges = std::set<std::pair<Index, Index>>;

Ranges ranges(Index n, Index grain) {
  std::mutex mutex;
  Ranges seen;
  parallel_for(n, grain, [&](Index begin, Index end) {
    const std::lock_guard lock(mutex);
    EXPECT_TRUE(seen.emplace(begin, end).second);
  });
  return seen;
}

TEST_F(Parallel, RangesAreConsecutiveAndTheLastIsShorter) {
  for (const int threads : {1, 2, 5}) {
    set_thread_count(threads);
    EXPECT_EQ(ranges(10, 4), (Ranges{{0, 4}, {4, 8}, {8, 10}}));
    EXPECT_EQ(ranges(3, 100), (Ranges{{0, 3}}));
  }
}

TEST_F(Parallel, NothingToDoCallsNothing) {
  EXPECT_TRUE(ranges(0, 4).empty());
  EXPECT_TRUE(ranges(-7, 4).empty());
}

TEST_F(Parallel, GrainBelowOneCountsAsOne) {
  EXPECT_EQ(ranges(3, 0), (Ranges{{0, 1}, {1, 2}, {2, 3}}));
}

TEST_F(Parallel, EveryIndexIsVisitedOnceWhateverTheNumberOfThreads) {
  for (const int threads : {1, 2, 3, 8}) {
    set_thread_count(threads);
    std::vector<std::atomic<int>> visits(10'007);
    parallel_for(10'007, 13, [&](Index begin, Index end) {
      for (Index i = begin; i < end; ++i) ++visits[i];
    });
    for (const auto& count : visits) ASSERT_EQ(count, 1);
  }
}

// Anything that a body holds would be copied with it.
struct CountingBody {
  explicit CountingBody(std::atomic<int>& copies_made) : copies(copies_made) {}
  CountingBody(const CountingBody& other) : copies(other.copies) { ++copies; }
  CountingBody& operator=(const CountingBody&) = delete;
  void operator()(Index begin, Index end) const { sum += end - begin; }
  std::atomic<int>& copies;
  mutable std::atomic<Index> sum{0};
};

TEST_F(Parallel, BodiesAreNotCopied) {
  std::atomic<int> copies{0};
  const CountingBody body(copies);
  parallel_for(100, 7, body);
  EXPECT_EQ(body.sum, 100);
  const LoopBody reference(body);
  parallel_for(50, 7, reference);
  EXPECT_EQ(body.sum, 150);
  EXPECT_EQ(copies, 0);
}

TEST_F(Parallel, RangesDependOnSizeAndGrainOnly) {
  set_thread_count(1);
  const Ranges expected = ranges(1001, 10);
  for (const int threads : {2, 3, 7}) {
    set_thread_count(threads);
    EXPECT_EQ(ranges(1001, 10), expected);
  }
}

TEST_F(Parallel, ThreadCountIsWhatWasSetAndZeroMeansAllCores) {
  set_thread_count(3);
  EXPECT_EQ(thread_count(), 3);
  set_thread_count(0);
  EXPECT_EQ(thread_count(), std::max(1, static_cast<int>(std::thread::hardware_concurrency())));
}

TEST_F(Parallel, SeveralThreadsWorkOnOneLoop) {
  set_thread_count(2);
  std::atomic<int> arrived{0};
  // Each of two ranges waits for the other: with one thread only this would never end.
  parallel_for(2, 1, [&](Index, Index) {
    ++arrived;
    while (arrived < 2) std::this_thread::yield();
  });
  EXPECT_EQ(arrived, 2);
}

TEST_F(Parallel, InnerLoopsRunOnTheThreadOfTheirBody) {
  set_thread_count(3);
  std::atomic<int> total{0};
  parallel_for(16, 1, [&](Index, Index) {
    const std::thread::id owner = std::this_thread::get_id();
    parallel_for(20, 3, [&](Index begin, Index end) {
      EXPECT_EQ(std::this_thread::get_id(), owner);
      total += static_cast<int>(end - begin);
    });
  });
  EXPECT_EQ(total, 16 * 20);
}

TEST_F(Parallel, LoopsOfSeveralCallersDoNotMix) {
  set_thread_count(2);
  std::vector<std::thread> callers;
  std::array<std::atomic<Index>, 4> sums{};
  for (std::size_t c = 0; c < sums.size(); ++c)
    callers.emplace_back([&, c] {
      for (int repeat = 0; repeat < 50; ++repeat)
        parallel_for(100, 7, [&](Index begin, Index end) {
          for (Index i = begin; i < end; ++i) sums[c] += i;
        });
    });
  for (std::thread& caller : callers) caller.join();
  for (const auto& sum : sums) EXPECT_EQ(sum, 50 * 4950);
}

TEST_F(Parallel, TheExceptionOfTheLowestRangeArrives) {
  for (const int threads : {1, 2, 4}) {
    set_thread_count(threads);
    for (int repeat = 0; repeat < 20; ++repeat) {
      try {
        parallel_for(100, 1, [](Index begin, Index) {
          if (begin >= 17) throw std::out_of_range(std::to_string(begin));
        });
        FAIL() << "no exception";
      } catch (const std::out_of_range& error) {
        EXPECT_STREQ(error.what(), "17");
      }
    }
  }
}

TEST_F(Parallel, WorksAgainAfterAnException) {
  set_thread_count(2);
  EXPECT_THROW(parallel_for(8, 1, [](Index, Index) { throw std::runtime_error("stop"); }), std::runtime_error);
  EXPECT_THROW(
      parallel_for(8, 1,
                   [](Index, Index) { parallel_for(4, 1, [](Index, Index) { throw std::runtime_error("inner"); }); }),
      std::runtime_error);
  EXPECT_EQ(ranges(10, 4), (Ranges{{0, 4}, {4, 8}, {8, 10}}));
}

#ifndef _WIN32  // has no fork()
// The exit code of a child that runs `work`; 124 after a while, -1 when a signal ended it.
template <class Work>
int status_of_child(Work work) {
  constexpr std::chrono::seconds patience{20};
  const pid_t child = fork();
  if (child == 0) {
    alarm(10 * patience.count());  // should the parent be gone
    work();
    std::_Exit(::testing::Test::HasFailure() ? 1 : 0);
  }
  const auto start = std::chrono::steady_clock::now();
  int status = 0;
  while (waitpid(child, &status, WNOHANG) == 0) {
    if (std::chrono::steady_clock::now() - start > patience) {
      kill(child, SIGKILL);
      waitpid(child, &status, 0);
      return 124;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

class ParallelFork : public Parallel {
 protected:
  void SetUp() override {
    if (is_there("__tsan_init")) GTEST_SKIP() << "the thread sanitizer allows no threads in the child";
  }
  static bool is_there(const char* function) { return dlsym(RTLD_DEFAULT, function) != nullptr; }
};

TEST_F(ParallelFork, TheChildHasThreadsOfItsOwn) {
  for (const int threads : {1, 2, 5}) {
    set_thread_count(threads);
    const Ranges expected = ranges(1001, 10);
    const auto loop_on_all_threads = [&] {
      EXPECT_EQ(thread_count(), threads);
      EXPECT_EQ(ranges(1001, 10), expected);
      // Each range waits for the others.
      std::atomic<int> arrived{0};
      parallel_for(threads, 1, [&](Index, Index) {
        ++arrived;
        while (arrived < threads) std::this_thread::yield();
      });
    };
    EXPECT_EQ(status_of_child(loop_on_all_threads), 0);
    loop_on_all_threads();
    EXPECT_EQ(status_of_child([&] { EXPECT_EQ(status_of_child(loop_on_all_threads), 0); }), 0);
  }
}

TEST_F(ParallelFork, TheChildMaySetTheNumberOfThreads) {
  set_thread_count(3);
  ranges(100, 1);
  EXPECT_EQ(status_of_child([] {
              set_thread_count(2);
              EXPECT_EQ(ranges(10, 4), (Ranges{{0, 4}, {4, 8}, {8, 10}}));
              set_thread_count(3);
              EXPECT_EQ(ranges(3, 100), (Ranges{{0, 3}}));
            }),
            0);
}

TEST_F(ParallelFork, TheChildExitsAsUsual) {
  set_thread_count(3);
  ranges(100, 1);
  EXPECT_EQ(status_of_child([] { std::exit(7); }), 7);
  if (is_there("__asan_init")) GTEST_SKIP() << "the leak sanitizer may count what belongs to the parent's threads";
  EXPECT_EQ(status_of_child([] {
              ranges(100, 1);
              std::exit(7);
            }),
            7);
}

TEST_F(ParallelFork, WorksAtAnyMomentOfLoopsOnOtherThreads) {
  if (is_there("__asan_init")) GTEST_SKIP() << "the address sanitizer's own locks hang in the child";
  set_thread_count(3);
  std::atomic<bool> stop{false};
  std::vector<std::thread> callers;
  for (int c = 0; c < 2; ++c)
    callers.emplace_back([&, c] {
      while (!stop) {
        parallel_for(100, 7, [](Index, Index) {});
        set_thread_count(2 + c);
      }
    });
  for (int repeat = 0; repeat < 200 && !HasFailure(); ++repeat)
    EXPECT_EQ(status_of_child([] {
                std::atomic<Index> sum{0};
                parallel_for(100, 7, [&](Index begin, Index end) { sum += end - begin; });
                EXPECT_EQ(sum, 100);
              }),
              0);
  stop = true;
  for (std::thread& caller : callers) caller.join();
}

TEST_F(ParallelFork, DoesNotWaitForALoopOfAnotherThread) {
  set_thread_count(2);
  std::atomic<bool> running{false}, stop{false};
  std::thread caller([&] {
    parallel_for(2, 1, [&](Index, Index) {
      running = true;
      while (!stop) std::this_thread::yield();
    });
  });
  while (!running) std::this_thread::yield();
  EXPECT_EQ(status_of_child([] { EXPECT_EQ(ranges(10, 4), (Ranges{{0, 4}, {4, 8}, {8, 10}})); }), 0);
  stop = true;
  caller.join();
}

#endif

TEST_F(Parallel, RefusesANegativeNumberOfThreads) {
  try {
    set_thread_count(-1);
    FAIL() << "no error";
  } catch (const InvalidInput& error) {
    EXPECT_NE(std::string(error.what()).find("set_thread_count: threads = -1"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace csrbf::parallel_test
