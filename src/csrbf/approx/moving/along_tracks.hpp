#pragma once

#include "csrbf/approx/moving/moving_least_squares.hpp"
#include "csrbf/approx/unity/held_out_error.hpp"

#include <optional>

namespace csrbf {

/// Moving least squares whose weights follow the tracks of the samples.
inline const MovingLeastSquaresOptions along_tracks{.tracks = true};

/// Its held-out error, if that is clearly less than the one of a partition of unity with the local fits `patches`:
/// rough values along tracks often differ from one track to the next by more than the function does.
template <int Dim>
std::optional<HeldOutError> better_along_tracks(const Samples<Dim>& samples, const LocalOptions& patches);

}  // namespace csrbf
