#pragma once

#include "csrbf/approx/moving/moving_least_squares.hpp"
#include "csrbf/approx/unity/held_out_error.hpp"

#include <optional>

namespace csrbf {

/// Moving least squares whose weights follow the tracks of the samples.
inline const MovingLeastSquaresOptions along_tracks{.tracks = true};

/// A partition of unity improved by moving least squares along tracks. One field per component.
template <int Dim>
struct TrackShare {
  std::vector<std::shared_ptr<const Field<Dim>>> shares;  ///< of the latter, 0 to 1
  /// Variance of both together over that of the partition of unity; none where too few samples can be held out.
  std::vector<std::shared_ptr<const Field<Dim>>> ratios;
  double held_out_rmse = 0;  ///< of both together
};

/// Rough values along tracks often differ from one track to the next by more than the function does. The share of
/// fits along tracks is v^2 / (v^2 + w^2), with the local mean squares of the errors at held-out samples, w along
/// tracks and v of a partition of unity with the local fits `patches`. None if the errors of both together are not
/// clearly less than those of the partition of unity, or fewer than 24 samples can be held out. Costs the patches
/// around the held-out samples, O(n log n) to prepare the tracks, and a dense solve per held-out sample.
template <int Dim>
std::optional<TrackShare<Dim>> better_along_tracks(const Samples<Dim>& samples, const LocalOptions& patches);

/// Root mean square of the errors of tracks alone at held-out samples; NaN where fewer than 24 can be held out.
template <int Dim>
double held_out_along_tracks(const Samples<Dim>& samples, const MovingLeastSquaresOptions& options = along_tracks);

}  // namespace csrbf
