#include "csrbf/core/parallel.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/core/inside_parallel_loop.hpp"

#include <atomic>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <system_error>
#include <thread>
#include <vector>

namespace csrbf {
namespace {

thread_local bool inside_loop = false;

// The running loop, one at a time: the ranges not yet taken, and the failure of the lowest range that threw.
struct Loop {
  Index n = 0;
  Index grain = 1;
  const std::function<void(Index, Index)>* body = nullptr;
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

class Pool {
 public:
  Pool() { resize(0); }
  Pool(const Pool&) = delete;
  Pool& operator=(const Pool&) = delete;
  ~Pool() { stop(); }

  [[nodiscard]] int size() const { return static_cast<int>(workers_.size()) + 1; }

  void resize(int threads) {
    const std::lock_guard owner(owner_);
    if (threads <= 0) threads = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
    if (threads == size()) return;
    stop();
    stopping_ = false;
    try {
      for (int i = 1; i < threads; ++i) workers_.emplace_back([this, seen = generation_] { serve(seen); });
    } catch (const std::system_error&) {
      // The system grants no more threads; fewer give the same results.
    }
  }

  void run(Loop& loop) {
    const std::lock_guard owner(owner_);
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

 private:
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
    {
      const std::lock_guard lock(mutex_);
      stopping_ = true;
    }
    wake_.notify_all();
    for (std::thread& worker : workers_) worker.join();
    workers_.clear();
  }

  std::mutex owner_;  // held by the thread whose loop runs, and while the pool changes size
  std::mutex mutex_;
  std::condition_variable wake_;
  std::condition_variable done_;
  std::vector<std::thread> workers_;
  Loop* loop_ = nullptr;
  unsigned long generation_ = 0;
  int busy_ = 0;
  bool stopping_ = false;
};

Pool& pool() {
  static Pool instance;
  return instance;
}

}  // namespace

int thread_count() {
  return pool().size();
}

void set_thread_count(int threads) {
  require(threads >= 0, "set_thread_count", "threads", threads, "must be 0 (all cores) or positive");
  pool().resize(threads);
}

bool inside_parallel_loop() {
  return inside_loop;
}

void parallel_for(Index n, Index grain, const std::function<void(Index, Index)>& body) {
  if (n <= 0) return;
  Loop loop;
  loop.n = n;
  loop.grain = std::max<Index>(1, grain);
  loop.body = &body;
  if (inside_loop) {
    for (Index begin = 0; begin < n; begin += loop.grain) body(begin, std::min(n, begin + loop.grain));
    return;
  }
  if (n <= loop.grain || thread_count() == 1) {
    loop.work();
  } else {
    pool().run(loop);
  }
  if (loop.failure) std::rethrow_exception(loop.failure);
}

}  // namespace csrbf
