#pragma once

#include <functional>

namespace csrbf {

/// While an object of this class lives, long computations on the thread that made it call `interrupted` now and then
/// and end with Cancelled if it returns true, with or without a Progress: before each range of a parallel loop, and
/// every so often while they read, write or go through much data outside loops. It is called often and must be fast.
/// Objects on one thread may be nested; the innermost one is asked.
class Interruptible {
 public:
  explicit Interruptible(std::function<bool()> interrupted);
  Interruptible(const Interruptible&) = delete;
  Interruptible& operator=(const Interruptible&) = delete;
  ~Interruptible();

 private:
  friend void stop_if_interrupted();

  std::function<bool()> interrupted_;
  const Interruptible* outer_;
};

/// Asks the innermost Interruptible of this thread; throws Cancelled if it says stop. Does nothing if there is none.
void stop_if_interrupted();

/// Calls stop_if_interrupted() every `steps` calls, for loops whose steps take less time than asking does.
class InterruptionPoint {
 public:
  explicit InterruptionPoint(unsigned steps) : steps_(steps) {}
  void operator()() {
    if (++step_ < steps_) return;
    step_ = 0;
    stop_if_interrupted();
  }

 private:
  unsigned steps_;
  unsigned step_ = 0;
};

}  // namespace csrbf
