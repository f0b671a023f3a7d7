#pragma once

#include "csrbf/core/types.hpp"

#include <functional>

namespace csrbf {

/// Number of threads used by every parallel loop of the library; at least 1. Default: all cores.
int thread_count();

/// Sets the number of threads (0 = all cores). Results do not depend on it, bit for bit.
void set_thread_count(int threads);

/// Calls body(begin, end) for consecutive ranges of at most `grain` indices that cover [0, n), in any order and on any
/// thread. The ranges depend on n and grain only. Loops started inside a body run on that body's own thread.
/// The exception of the lowest range that threw is rethrown after all threads have stopped; Cancelled when the thread
/// of the loop is Interruptible and interrupted. The child of a fork() may start loops too, with threads of its own.
void parallel_for(Index n, Index grain, const std::function<void(Index begin, Index end)>& body);

}  // namespace csrbf
