#pragma once

#include <atomic>
#include <functional>
#include <mutex>

namespace csrbf {

/// What is made at the first question, whoever asks. As std::once_flag, but what is made may run parallel loops while
/// loops of other threads ask for it, too: a thread outside of a loop first waits until no other runs one. With
/// std::call_once() it would make and wait for the loop, which waits for what it makes.
class Once {
 public:
  /// Calls make() unless a call of one has returned. If it throws, the next question makes.
  template <class Make>
  void call(const Make& make) {
    if (!made_.load(std::memory_order_acquire)) call_first(make);
  }

 private:
  void call_first(const std::function<void()>& make);

  std::mutex mutex_;
  std::atomic<bool> made_{false};
};

}  // namespace csrbf
