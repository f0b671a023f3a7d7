#include "csrbf/core/parallel.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/core/inside_parallel_loop.hpp"
#include "csrbf/core/interruption.hpp"
#include "csrbf/core/once.hpp"

#ifndef _WIN32
#include <pthread.h>
#endif

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <exception>
#include <memory>
#include <mutex>
#include <system_error>
#include <thread>
#include <vector>

namespace csrbf {
namespace {

thread_local bool inside_loop = false;
thread_local bool has_turn = false;  // no other thread runs a loop on the pool

// The running loop, one at a time: the ranges not yet taken, and the failure of the lowest range that threw.
struct Loop {
  Index n = 0;
  Index grain = 1;
  const LoopBody* body = nullptr;
  std::atomic<Index> next{0};
  std::atomic<bool> failed{false};
  std::mutex failure_mutex;
  Index failed_at = 0;
  std::exception_ptr failure;

  void work() {
    inside_loop = true;
    while (!failed.load(std::memory_order_relaxed)) {
      const Index begin = grain * next.fetch_add(1, std::memory_order_relaxed);
      if (begin >= n) break;
      run(begin, std::min(n, begin + grain));
    }
    inside_loop = false;
  }

  void run(Index begin, Index end) {
    try {
      stop_if_interrupted();
      (*body)(begin, end);
    } catch (...) {
      const std::lock_guard lock(failure_mutex);
      if (!failure || begin < failed_at) {
        failure = std::current_exception();
        failed_at = begin;
      }
      failed = true;
    }
  }
};

// The threads, and one loop at a time that they work on. A fork copies none of them: the child begins with the state
// that no thread works, and starts its own when a loop asks for them. mutex_ is held for moments only, never while a
// loop runs, so a fork need not wait for one.
class Pool {
 public:
  Pool() {
#ifndef _WIN32  // which has no fork
    pthread_atfork([] { Pool::pool().mutex_.lock(); }, [] { Pool::pool().mutex_.unlock(); },
                   [] { Pool::pool().begin_again(); });
#endif
    resize(0);
  }
  Pool(const Pool&) = delete;
  Pool& operator=(const Pool&) = delete;
  ~Pool() {
    stop();
  }

  [[nodiscard]] int size() const {
    return size_;
  }

  void resize(int threads) {
    const Turn turn(*this);
    if (threads <= 0) threads = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
    if (threads == size()) return;
    stop();
    start(threads);
  }

  void run(Loop& loop) {
    const Turn turn(*this);
    if (workers_.empty()) start(size());
    {
      const std::lock_guard lock(mutex_);
      loop_ = &loop;
      busy_ = static_cast<int>(workers_.size());
      ++generation_;
    }
    wake_.notify_all();
    loop.work();
    std::unique_lock lock(mutex_);
    done_.wait(lock, [this] { return busy_ == 0; });
    loop_ = nullptr;
  }

  void call_alone(const std::function<void()>& make) {
    const Turn turn(*this);
    make();
  }

  static Pool& pool() {
    static Pool instance;
    return instance;
  }

 private:
  // Of the thread whose loop runs, that changes the size, or that makes what loops ask for (Once), in which it may do
  // the others.
  class Turn {
   public:
    explicit Turn(Pool& pool) : pool_(pool), is_outermost_(!has_turn) {
      if (!is_outermost_) return;
      std::unique_lock lock(pool_.mutex_);
      pool_.free_.wait(lock, [this] { return !pool_.taken_; });
      pool_.taken_ = has_turn = true;
    }
    Turn(const Turn&) = delete;
    Turn& operator=(const Turn&) = delete;
    ~Turn() {
      if (!is_outermost_) return;
      has_turn = false;
      {
        const std::lock_guard lock(pool_.mutex_);
        pool_.taken_ = false;
      }
      pool_.free_.notify_one();
    }

   private:
    Pool& pool_;
    bool is_outermost_;
  };

  void start(int threads) {
    const std::lock_guard lock(mutex_);
    stopping_ = false;
    try {
      for (int i = 1; i < threads; ++i) workers_.emplace_back([this, seen = generation_] { serve(seen); });
    } catch (const std::system_error&) {
      // The system gives no more threads; fewer do the same.
    }
    size_ = static_cast<int>(workers_.size()) + 1;
  }

  void serve(unsigned long seen) {
    std::unique_lock lock(mutex_);
    for (;;) {
      wake_.wait(lock, [&] { return stopping_ || generation_ != seen; });
      if (stopping_) return;
      seen = generation_;
      Loop* loop = loop_;
      lock.unlock();
      loop->work();
      lock.lock();
      if (--busy_ == 0) done_.notify_one();
    }
  }

  void stop() {
    std::vector<std::thread> leaving;
    {
      const std::lock_guard lock(mutex_);
      stopping_ = true;
      leaving.swap(workers_);
    }
    wake_.notify_all();
    for (std::thread& worker : leaving) worker.join();
  }

  // In the child of a fork, whose only thread holds mutex_. What waits for threads that are not there any more is
  // replaced, not destroyed, which would wait too.
  void begin_again() {
    for (std::thread& worker : workers_) std::construct_at(&worker);
    workers_.clear();
    for (std::condition_variable* condition : {&wake_, &done_, &free_}) std::construct_at(condition);
    loop_ = nullptr;
    busy_ = 0;
    taken_ = false;
    mutex_.unlock();
  }

  std::mutex mutex_;
  std::condition_variable wake_;
  std::condition_variable done_;
  std::condition_variable free_;
  std::vector<std::thread> workers_;
  std::atomic<int> size_{1};  // with the thread of the loop
  Loop* loop_ = nullptr;
  unsigned long generation_ = 0;
  int busy_ = 0;
  bool taken_ = false;
  bool stopping_ = false;
};

}  // namespace

int thread_count() {
  return Pool::pool().size();
}

void set_thread_count(int threads) {
  require(threads >= 0, "set_thread_count", "threads", threads, "must be 0 (all cores) or positive");
  Pool::pool().resize(threads);
}

bool inside_parallel_loop() {
  return inside_loop;
}

void parallel_for(Index n, Index grain, LoopBody body) {
  if (n <= 0) return;
  Loop loop;
  loop.n = n;
  loop.grain = std::max<Index>(1, grain);
  loop.body = &body;
  if (inside_loop) {
    for (Index begin = 0; begin < n; begin += loop.grain) {
      stop_if_interrupted();
      body(begin, std::min(n, begin + loop.grain));
    }
    return;
  }
  if (n <= loop.grain || thread_count() == 1) {
    loop.work();
  } else {
    Pool::pool().run(loop);
  }
  if (loop.failure) std::rethrow_exception(loop.failure);
}

// Inside a loop what is made runs on one thread and waits for no other. Not std::call_once(), which under the thread
// sanitizer never ends after a call that threw.
void Once::call_first(const std::function<void()>& make) {
  const auto make_here = [&] {
    const std::lock_guard lock(mutex_);
    if (made_.load(std::memory_order_relaxed)) return;
    make();
    made_.store(true, std::memory_order_release);
  };
  if (inside_loop)
    make_here();
  else
    Pool::pool().call_alone(make_here);
}

}  // namespace csrbf
