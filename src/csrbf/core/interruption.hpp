#pragma once

#include <functional>

namespace csrbf {

/// While an object of this class lives, long work on the thread that made it asks `interrupted` now and then whether to
/// stop, whether or not it is given a Progress: before each range of a parallel loop, and every so often where it
/// reads, writes or goes through much data by itself. When that returns true the work ends with Cancelled. It is asked
/// often and must answer fast. Objects of one thread may be nested; the innermost is asked.
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

/// Asks what the Interruptible of this thread says; throws Cancelled. Does nothing when there is none.
void stop_if_interrupted();

/// Calls of stop_if_interrupted() in a loop whose steps take less time than asking does: every so many steps.
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
