#pragma once

#include "csrbf/core/types.hpp"

#include <cstddef>
#include <cstring>
#include <functional>
#include <initializer_list>
#include <string_view>
#include <type_traits>
#include <vector>

namespace csrbf {

/// Serialises values as their bytes in memory.
class ByteWriter {
 public:
  template <class T>
  void put(const T* values, Index n) {
    static_assert(std::is_trivially_copyable_v<T>);
    const auto* first = reinterpret_cast<const std::byte*>(values);
    bytes_.insert(bytes_.end(), first, first + static_cast<std::size_t>(n) * sizeof(T));
  }
  template <class T>
  void put(const T& value) {
    put(&value, 1);
  }

  [[nodiscard]] std::span<const std::byte> bytes() const { return bytes_; }
  void clear() { bytes_.clear(); }

 private:
  std::vector<std::byte> bytes_;
};

/// Reads the values written by a ByteWriter, in the same order. Throws SolverFailure past the end.
class ByteReader {
 public:
  explicit ByteReader(std::span<const std::byte> bytes) : bytes_(bytes) {}

  template <class T>
  void take(T* values, Index n) {
    static_assert(std::is_trivially_copyable_v<T>);
    const std::size_t size = static_cast<std::size_t>(n) * sizeof(T);
    if (size > bytes_.size()) fail();
    if (size > 0) std::memcpy(values, bytes_.data(), size);
    bytes_ = bytes_.subspan(size);
  }
  template <class T>
  T take() {
    T value;
    take(&value, 1);
    return value;
  }

  [[nodiscard]] std::size_t left() const { return bytes_.size(); }

 private:
  [[noreturn]] static void fail();

  std::span<const std::byte> bytes_;
};

/// A step of a long computation whose results can be exchanged as bytes: with other processes that run the same
/// computation, or with a later run of it. Items are processed in blocks of `grain`; the last one may be smaller.
struct SharedWork {
  std::string_view name;  ///< of the kind of work: "fit", "evaluate", ...
  Index items = 0;
  Index grain = 1;
  /// Computes the items [begin, end) of one block on the calling thread. Called concurrently for different blocks.
  std::function<void(Index begin, Index end)> compute;
  /// Writes the results of the items [begin, end) of one block that was computed here.
  std::function<void(Index begin, Index end, ByteWriter& out)> pack;
  /// Reads the results of a block that `pack` wrote elsewhere, instead of computing them.
  std::function<void(Index begin, Index end, ByteReader& in)> unpack;

  [[nodiscard]] Index blocks() const { return (items + grain - 1) / grain; }
  [[nodiscard]] Index begin(Index block) const { return block * grain; }
  [[nodiscard]] Index end(Index block) const { return std::min(items, (block + 1) * grain); }

  /// Computes the blocks [first, last) on all threads; the exception of the lowest one that threw is rethrown.
  void compute_blocks(Index first, Index last) const;
};

/// Decides which blocks this process computes, and fetches the results of the others.
class WorkSharing {
 public:
  WorkSharing() = default;
  WorkSharing(const WorkSharing&) = delete;
  WorkSharing& operator=(const WorkSharing&) = delete;
  virtual ~WorkSharing() = default;

  /// Returns when the results of all blocks are in place, computed here or unpacked. Called by the main thread of every
  /// participating process, or of every repetition of a run, with the same work in the same order.
  virtual void share(const SharedWork& work) = 0;
};

/// Passes the shared work of this process to `sharing` from now on, which must outlive its use; null (default): work is
/// not shared. Call it before the computation starts.
void set_work_sharing(WorkSharing* sharing);

/// Does the work: on all threads of this process unless a WorkSharing is set. Results must depend on the input of the
/// program alone, bit for bit, and not on which process computes which block. Work inside the body of a parallel loop,
/// or of a single block, is not worth sharing: every process does it itself.
void share_work(const SharedWork& work);

/// Whether work on that many items would be shared: a WorkSharing is set, there are more items than `grain`, and the
/// caller is not inside the body of a parallel loop.
bool is_shared(Index items, Index grain);

/// Results of a fixed size: item i is in the `size` bytes at data + size i.
struct ResultArray {
  std::byte* data = nullptr;
  std::size_t size = 0;

  /// `per_item` consecutive values for each item; no array when it is 0.
  template <class T>
  static ResultArray of(T* values, Index per_item = 1) {
    static_assert(std::is_trivially_copyable_v<T>);
    return {reinterpret_cast<std::byte*>(values), sizeof(T) * static_cast<std::size_t>(per_item)};
  }
};

/// share_work() for a body that fills items of arrays.
void share_arrays(std::string_view name, Index items, Index grain,
                  const std::function<void(Index begin, Index end)>& compute,
                  std::initializer_list<ResultArray> results);

}  // namespace csrbf
