#pragma once

#include "csrbf/core/types.hpp"

#include <vector>

namespace csrbf {

/// A cut of space: points with x[axis] < cut are on the side `below`, others on the side `above`. Sides are further
/// cuts, or, where negative, tiles: -1 - tile.
struct TileCut {
  std::int32_t axis;
  std::int32_t below;
  std::int32_t above;
  double at;
};

/// Boxes that fill space, each with about as many points, and how functions on them blend: those of tiles that meet
/// pass into each other within `blend` of their common faces.
template <int Dim>
class TilePlan {
 public:
  TilePlan() = default;
  /// Throws InvalidInput when the cuts are no tree or a position is not finite.
  TilePlan(std::vector<TileCut> cuts, double blend);

  [[nodiscard]] Index size() const { return std::ssize(boxes_); }
  [[nodiscard]] Index tile_of(const Point<Dim>& x) const;
  /// Boxes at the outside reach to infinity.
  [[nodiscard]] const Box<Dim>& box(Index tile) const { return boxes_[tile]; }
  [[nodiscard]] double blend() const { return blend_; }
  [[nodiscard]] const std::vector<TileCut>& cuts() const { return cuts_; }

  /// Tiles with a point in the box, ascending.
  [[nodiscard]] std::vector<Index> tiles_in(const Box<Dim>& box) const;
  /// Whether x is farther than `blend` from all faces of its tile: no other tile has a say there.
  [[nodiscard]] bool is_deep(const Point<Dim>& x, Index tile) const;

 private:
  std::vector<TileCut> cuts_;
  std::vector<Box<Dim>> boxes_;
  double blend_ = 0;
};

/// Cuts space so that each of `tiles` parts has the same share of the sample (Dim x n), always across the longest side.
template <int Dim>
std::vector<TileCut> cut_into_tiles(const PointsRef<Dim>& sample, Index tiles);

}  // namespace csrbf
