#pragma once

#include "csrbf/core/types.hpp"

#include <vector>

namespace csrbf {

/// `count` equal bins of the intensities between lo and hi, shared by all regions of an image. The end bins also hold
/// everything beyond.
struct IntensityBins {
  double lo = 0;  ///< lower edge of the first bin
  double hi = 1;  ///< upper edge of the last bin; > lo
  Index count = 256;

  [[nodiscard]] double width() const { return (hi - lo) / static_cast<double>(count); }
  [[nodiscard]] double center(Index k) const { return lo + (static_cast<double>(k) + .5) * width(); }
  /// The bin of a value that is not NaN.
  [[nodiscard]] Index index(double value) const {
    const double position = (value - lo) * (static_cast<double>(count) / (hi - lo));
    return position > 0 ? static_cast<Index>(std::min(position, static_cast<double>(count - 1))) : 0;
  }
};

/// How the intensities of one region are distributed.
struct Histogram {
  IntensityBins bins;
  std::vector<double> counts;  ///< voxels, or their weights, in each bin

  Histogram() = default;
  explicit Histogram(const IntensityBins& layout) : bins(layout), counts(static_cast<std::size_t>(layout.count), 0.0) {}

  void add(double value, double weight = 1) { counts[bins.index(value)] += weight; }

  /// Sum of the counts.
  [[nodiscard]] double total() const;
  /// Mean of the bin centres; the middle of the range when the histogram is empty.
  [[nodiscard]] double mean() const;
  /// Mean of (x - about)^order over the bin centres x; 0 when the histogram is empty.
  [[nodiscard]] double moment(int order, double about) const;
  /// The intensity below which the part `fraction` of the voxels lies, linear inside a bin; the middle of the range
  /// when the histogram is empty.
  [[nodiscard]] double quantile(double fraction) const;
};

/// At most `count` bins for the intensities of an image: the least and the greatest value are the centres of the end
/// bins. Integers get bins of a whole number of grey levels each, one where that many bins suffice, and so do other
/// values that are levels at equal distances, as counts in any unit are. Where a few values lie far out, farther
/// than 3.5 times the distance R of the quantiles .001 and .999, the bins end 3 R beyond these quantiles, so that
/// outliers do not take the resolution from all others. `mask` (empty, or one entry per value) leaves out the voxels
/// where it is 0. O(n); quantiles and levels are those of at most 16384 values at equal distances. Throws InvalidInput
/// for NaN or infinite values, fewer than two different values, fewer than 2 or more than 256 bins, and a mask of
/// another size or without voxels.
IntensityBins choose_bins(std::span<const float> values, Index count = 256, std::span<const std::uint8_t> mask = {});

/// The bin of every value: one byte per voxel that the statistics of all later iterations need. O(n), parallel. Throws
/// InvalidInput when there are more than 256 bins.
std::vector<std::uint8_t> bin_indices(std::span<const float> values, const IntensityBins& bins);

/// Histograms of the regions 0 to regions - 1, where labels[i] is the region of voxel i; voxels with other labels
/// belong to none. `indices` are those of bin_indices. O(n), parallel. Throws InvalidInput when the sizes differ,
/// there is no region, or an index lies beyond the bins.
std::vector<Histogram> region_histograms(std::span<const std::uint8_t> indices, std::span<const std::uint8_t> labels,
                                         Index regions, const IntensityBins& bins);

/// Histogram of all values. O(n), parallel. Throws InvalidInput as bin_indices.
Histogram histogram_of(std::span<const float> values, const IntensityBins& bins);

}  // namespace csrbf
