#pragma once

#include "csrbf/approx/unity/partition_of_unity.hpp"

#include <memory>
#include <vector>

namespace csrbf {

/// A partition of unity that is right in gaps between its samples, and how far it may be off.
template <int Dim>
struct FilledGaps {
  PartitionOfUnityFit<Dim> fit;
  std::vector<std::shared_ptr<const Field<Dim>>> variances;
  std::shared_ptr<const Field<Dim>> outside = nullptr;  ///< 1 where samples are all around, 0 in gaps; null: no gaps
  /// What takes the place of the fit in gaps; empty: it is right there itself.
  std::vector<std::shared_ptr<const Field<Dim>>> inside = {};
  Index patches = 0;  ///< in gaps

  [[nodiscard]] std::vector<std::shared_ptr<const Field<Dim>>> fields() const;
};

/// Replaces the local functions of a partition of unity by others where these predict better: in gaps much wider than
/// the distances of samples, into which polynomials of high degree explode.
///
/// The cells at gaps are split where the expected error of the local function, that of leave-one-out times its growth
/// with the distance to the samples and by its polynomial (leverage), is above that of kriging (LocalKriging), whose
/// variance then is that of the fit. Where a linear variogram predicts best in gaps, values are rough, and what a patch
/// says of itself there is not believed; the function in gaps is then that of one system (interpolate()) for the
/// samples around them, dense near gaps and sparse far from them. Elsewhere it is made of wide patches. Cells full of
/// samples and their local functions stay as they are, bit for bit.
///
/// Variances also grow with the distance to the samples where they are sparse, but no gap is seen (DistanceGrowth).
///
/// `variances`: those of `fit`, see local_variance. `tracks`: the samples lie on tracks, between which another function
/// is right; only what is far from all of them is a gap then. In up to three dimensions; in more, and where there are
/// no gaps, returns what it was given. O(n) to look for gaps; where there are some, O(n log n), and some tenths of a
/// millisecond for each patch.
template <int Dim>
FilledGaps<Dim> fill_gaps(const Samples<Dim>& samples, PartitionOfUnityFit<Dim> fit,
                          std::vector<std::shared_ptr<const Field<Dim>>> variances, bool tracks = false);

}  // namespace csrbf
