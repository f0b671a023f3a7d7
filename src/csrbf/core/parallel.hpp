#pragma once

#include "csrbf/core/types.hpp"

#include <concepts>
#include <memory>

namespace csrbf {

/// What a parallel loop runs: a reference to any object that can be called with the first index and the one behind the
/// last. Not a std::function: there are hundreds of loops, and each one of a lambda brings code to copy, name and
/// delete it.
class LoopBody {
 public:
  template <class Body>
  requires std::invocable<const Body&, Index, Index> LoopBody(const Body& body)  // NOLINT(google-explicit-constructor)
      : body_(std::addressof(body)),
        call_([](const void* kept, Index begin, Index end) { (*static_cast<const Body*>(kept))(begin, end); }) {}

  void operator()(Index begin, Index end) const { call_(body_, begin, end); }

 private:
  const void* body_;
  void (*call_)(const void* body, Index begin, Index end);
};

/// Number of threads that every parallel loop of the library uses; at least 1. Default: all cores.
int thread_count();

/// Sets the number of threads; 0: all cores. Results do not depend on it, bit for bit.
void set_thread_count(int threads);

/// Calls body(begin, end) for consecutive ranges of at most `grain` indices that cover [0, n), in any order and on any
/// thread. The ranges depend on n and grain only. Loops started inside a body run on the thread of that body. If ranges
/// throw, the exception of the lowest one is rethrown after all threads have stopped. Throws Cancelled if the thread
/// that started the loop is interrupted (see Interruptible). The child of a fork() may start loops, too, with threads
/// of its own.
void parallel_for(Index n, Index grain, LoopBody body);

}  // namespace csrbf
