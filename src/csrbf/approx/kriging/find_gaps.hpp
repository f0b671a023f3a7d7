#pragma once

#include "csrbf/approx/kriging/patch_errors.hpp"
#include "csrbf/approx/samples/samples.hpp"

#include <vector>

namespace csrbf {

template <int Dim>
inline constexpr Index probes_each = Dim == 1   ? 3
                                     : Dim == 2 ? 9
                                                : 27;

/// The corners of a box, the middles of its edges and faces, and its own.
template <int Dim>
Points<Dim> probes(const Box<Dim>& box);

/// Of the k-th of them, for a mean over the box by Simpson's rule: 1/6, 4/6, 1/6 along each axis.
template <int Dim>
double simpson_weight(Index k) {
  double weight = 1;
  for (Index a = 0, rest = k; a < Dim; ++a, rest /= 3) weight *= rest % 3 == 1 ? 4.0 / 6 : 1.0 / 6;
  return weight;
}

/// The support of a cell of a cover, or of a part of a cell, within the box of the cover.
template <int Dim>
Box<Dim> support_of(const Cover<Dim>& cover, const Box<Dim>& cell);

/// Mean square error, by component, below which nothing has to be done in a gap.
template <int Dim>
Eigen::VectorXd noticeable_error(const Samples<Dim>& samples);

/// Where a partition of unity has gaps between its samples, much wider than the distances of these: in one to three
/// dimensions.
template <int Dim>
class GapFinder {
 public:
  /// Both must outlive it.
  GapFinder(const PartitionOfUnityFit<Dim>& fit, const PatchErrors<Dim>& patches)
      : fit_(fit), cover_(fit.data->cover), patches_(patches) {}

  /// Cells with a gap in their support. O(n).
  [[nodiscard]] std::vector<Index> cells_with_gaps() const;

  /// Those of the cells where the local function may have a noticeable error. `errors`: mean squares, components x
  /// cells of the cover.
  [[nodiscard]] std::vector<Index> doubtful(const std::vector<Index>& cells, const Samples<Dim>& samples,
                                            const Eigen::MatrixXd& errors) const;

  /// Points spread evenly over some cells, farther from the nearest samples than these from each other.
  [[nodiscard]] Points<Dim> points_in_gaps(const std::vector<Index>& cells, const Eigen::MatrixXd& errors) const;

 private:
  [[nodiscard]] double chance_factor(Index samples) const;
  [[nodiscard]] double inside_factor(const Point<Dim>& x) const;
  [[nodiscard]] double usual_radius(const Box<Dim>& cell, Index count) const;
  [[nodiscard]] bool all_near(const Points<Dim>& x, double reach, Index begin, Index end) const;

  const PartitionOfUnityFit<Dim>& fit_;
  const Cover<Dim>& cover_;
  const PatchErrors<Dim>& patches_;
};

}  // namespace csrbf
