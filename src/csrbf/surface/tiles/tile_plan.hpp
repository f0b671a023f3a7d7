#pragma once

#include "csrbf/core/types.hpp"

#include <vector>

namespace csrbf {

/// Boxes that fill space, each with about as many points, and how functions on them blend: those of tiles that meet
/// pass into each other within `blend` of their common faces.
class TilePlan {
 public:
  /// A cut of space: points with x[axis] < cut are on the side `below`, others on the side `above`. Sides are further
  /// cuts, or, where negative, tiles: -1 - tile.
  struct Cut {
    std::int32_t axis;
    std::int32_t below;
    std::int32_t above;
    double at;
  };

  TilePlan() = default;
  /// Throws InvalidInput when the cuts are no tree or a position is not finite.
  TilePlan(std::vector<Cut> cuts, double blend);

  [[nodiscard]] Index size() const { return std::ssize(boxes_); }
  [[nodiscard]] Index tile_of(const Point<3>& x) const;
  /// Boxes at the outside reach to infinity.
  [[nodiscard]] const Box<3>& box(Index tile) const { return boxes_[tile]; }
  [[nodiscard]] double blend() const { return blend_; }
  [[nodiscard]] const std::vector<Cut>& cuts() const { return cuts_; }

  /// Tiles with a point in the box, ascending.
  [[nodiscard]] std::vector<Index> tiles_in(const Box<3>& box) const;
  /// Whether x is farther than `blend` from all faces of its tile: no other tile has a say there.
  [[nodiscard]] bool is_deep(const Point<3>& x, Index tile) const;

 private:
  std::vector<Cut> cuts_;
  std::vector<Box<3>> boxes_;
  double blend_ = 0;
};

/// Cuts space so that each of `tiles` parts has the same share of the sample (3 x n), always across the longest side.
std::vector<TilePlan::Cut> cut_into_tiles(const PointsRef<3>& sample, Index tiles);

}  // namespace csrbf
