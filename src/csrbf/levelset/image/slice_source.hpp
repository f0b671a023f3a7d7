#pragma once

#include "csrbf/core/types.hpp"

#include <span>

namespace csrbf {

/// The values of an image, some slices at a time: the image itself may be larger than memory.
class SliceSource {
 public:
  SliceSource() = default;
  SliceSource(const SliceSource&) = delete;
  SliceSource& operator=(const SliceSource&) = delete;
  virtual ~SliceSource() = default;

  /// The values of the slices [begin, end) along z, x fastest, until the next call.
  virtual std::span<const float> slices(Index begin, Index end) = 0;
};

/// An image in memory.
class SlicesInMemory final : public SliceSource {
 public:
  /// `voxels`: of a slice.
  SlicesInMemory(std::span<const float> values, Index voxels) : values_(values), voxels_(voxels) {}

  std::span<const float> slices(Index begin, Index end) override {
    return values_.subspan(static_cast<std::size_t>(begin * voxels_),
                           static_cast<std::size_t>((end - begin) * voxels_));
  }

 private:
  std::span<const float> values_;
  Index voxels_;
};

}  // namespace csrbf
