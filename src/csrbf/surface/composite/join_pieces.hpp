#pragma once

#include "csrbf/surface/composite/piece_fitter.hpp"

namespace csrbf {

/// Orders pieces and sets how they join, so that each of their samples lies on the surface of the solid: an
/// intersection where they meet in a convex edge, a union in a concave one (thesis 5.2.3; Ohtake et al. 2003). Pieces
/// that contradict the others, or coincide with piece 0, are dropped, never piece 0. `samples[p]`: those of piece p,
/// local coordinates, 3 x n. Returns the pieces kept, in their new order. Cost grows as p! 2^p: at most most_pieces.
std::vector<std::size_t> join_pieces(std::vector<FittedPiece>& pieces, const std::vector<Points<3>>& samples);

/// Largest number of pieces of a patch: a corner of four faces.
inline constexpr std::size_t most_pieces = 4;

}  // namespace csrbf
