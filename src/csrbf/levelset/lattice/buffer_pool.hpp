#pragma once

#include <cstddef>
#include <memory>
#include <mutex>
#include <vector>

namespace csrbf {

/// Arrays reused by the threads of a loop that runs many times: fresh memory would have to be mapped by the system each
/// time.
class BufferPool {
 public:
  class Buffer {
   public:
    explicit Buffer(BufferPool& pool) : pool_(pool) {}
    Buffer(const Buffer&) = delete;
    Buffer& operator=(const Buffer&) = delete;
    ~Buffer() { pool_.give_back(std::move(values_)); }
    [[nodiscard]] float* data() { return values_.data(); }

   private:
    friend class BufferPool;
    BufferPool& pool_;
    std::vector<float> values_;
  };

  /// An array of at least `size` floats, not initialised.
  [[nodiscard]] std::unique_ptr<Buffer> take(std::size_t size) {
    auto buffer = std::make_unique<Buffer>(*this);
    {
      const std::lock_guard lock(mutex_);
      // The largest first, which most likely needs no growth.
      if (!free_.empty()) {
        std::size_t best = 0;
        for (std::size_t i = 1; i < free_.size(); ++i)
          if (free_[i].size() > free_[best].size()) best = i;
        buffer->values_ = std::move(free_[best]);
        free_[best] = std::move(free_.back());
        free_.pop_back();
      }
    }
    if (buffer->values_.size() < size) buffer->values_.resize(size);
    return buffer;
  }

 private:
  void give_back(std::vector<float> values) {
    const std::lock_guard lock(mutex_);
    free_.push_back(std::move(values));
  }

  std::mutex mutex_;
  std::vector<std::vector<float>> free_;
};

}  // namespace csrbf
