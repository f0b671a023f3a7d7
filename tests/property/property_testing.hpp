#pragma once

#include "csrbf/core/error.hpp"
#include "csrbf/core/types.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <cstdlib>
#include <functional>
#include <iostream>
#include <mutex>
#include <random>
#include <string>
#include <thread>
#include <vector>

// What must hold for any input, tried on random ones that are as unpleasant as possible. Every case has a seed of its
// own, which a failure names. CSRBF_PROPERTY_CASES=N runs N cases of each property, CSRBF_PROPERTY_SEED=S only the one
// with the seed S.
namespace csrbf {

/// Where the cases come from.
class Random {
 public:
  explicit Random(unsigned seed) : generator_(seed) {}

  int whole(int least, int most) { return std::uniform_int_distribution<int>(least, most)(generator_); }
  bool one_in(int n) { return whole(1, n) == 1; }
  double unit() { return std::uniform_real_distribution<double>(0, 1)(generator_); }
  double normal() { return std::normal_distribution<double>(0, 1)(generator_); }
  /// Of any magnitude between 10^least and 10^most.
  double magnitude(double least, double most) { return std::pow(10, least + (most - least) * unit()); }

  template <class T>
  const T& any_of(const std::vector<T>& choices) {
    return choices[whole(0, static_cast<int>(choices.size()) - 1)];
  }

  template <int Dim>
  Point<Dim> direction() {
    return Point<Dim>::NullaryExpr([this] { return normal(); }).normalized();
  }
  template <int Dim>
  Points<Dim> in_unit_cube(Index n) {
    return Points<Dim>::NullaryExpr(Dim, n, [this] { return unit(); });
  }

 private:
  std::mt19937_64 generator_;
};

/// Ends the program when a case runs for too long: a loop that does not end cannot be told to.
class Watchdog {
 public:
  Watchdog(unsigned seed, std::chrono::seconds limit) : thread_([this, seed, limit] { watch(seed, limit); }) {}
  Watchdog(const Watchdog&) = delete;
  Watchdog& operator=(const Watchdog&) = delete;
  ~Watchdog() {
    {
      const std::lock_guard lock(mutex_);
      done_ = true;
    }
    changed_.notify_one();
    thread_.join();
  }

 private:
  void watch(unsigned seed, std::chrono::seconds limit) {
    std::unique_lock lock(mutex_);
    if (changed_.wait_for(lock, limit, [this] { return done_; })) return;
    std::cerr << "seed " << seed << ": not done after " << limit.count() << " s" << std::endl;
    std::_Exit(1);
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  bool done_ = false;
  std::thread thread_;
};

inline int number_from_environment(const char* name, int otherwise) {
  const char* text = std::getenv(name);
  return text == nullptr ? otherwise : std::atoi(text);
}

/// Runs `property` for `cases` seeds, and stops at the first that fails. It may throw InvalidInput or SolverFailure,
/// which is how the library refuses, but not for all: at least one case in `answered` must not.
inline void for_each_case(int cases, int answered, const std::function<void(Random&)>& property) {
  constexpr std::chrono::seconds limit(120);  // most take milliseconds, but sanitizers and other work slow them down
  const int only = number_from_environment("CSRBF_PROPERTY_SEED", -1);
  const int first = only >= 0 ? only : 0;
  const int last = only >= 0 ? only : number_from_environment("CSRBF_PROPERTY_CASES", cases) - 1;
  int refused = 0;
  std::pair<double, int> slowest{0, first};
  for (int seed = first; seed <= last; ++seed) {
    SCOPED_TRACE("again: CSRBF_PROPERTY_SEED=" + std::to_string(seed));
    const auto begin = std::chrono::steady_clock::now();
    const Watchdog watchdog(static_cast<unsigned>(seed), limit);
    Random random(static_cast<unsigned>(seed));
    try {
      property(random);
    } catch (const InvalidInput& error) {
      ++refused;
      if (only >= 0) std::cout << error.what() << '\n';
    } catch (const SolverFailure& error) {
      ++refused;
      if (only >= 0) std::cout << error.what() << '\n';
    } catch (const std::exception& error) {
      ADD_FAILURE() << "neither InvalidInput nor SolverFailure: " << error.what();
    }
    if (::testing::Test::HasFailure()) return;
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - begin;
    slowest = std::max(slowest, {seconds.count(), seed});
  }
  if (only >= 0) return;
  std::cout << last + 1 << " cases, " << refused << " refused; the slowest, seed " << slowest.second << ", took "
            << slowest.first << " s\n";
  EXPECT_GE((last + 1 - refused) * answered, last + 1);
}

}  // namespace csrbf
