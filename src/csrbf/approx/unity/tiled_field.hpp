#pragma once

#include "csrbf/core/field.hpp"
#include "csrbf/spatial/tile_plan.hpp"

#include <memory>

namespace csrbf {

/// A partition of unity whose patches are the tiles of a plan: f = sum_t w_t f_t / sum_t w_t. The weight w_t is 1 in
/// the tile, falls to 0 from `blend` inside its faces to `blend` outside, and is C2. A tile has two fields: one for
/// where it is alone, and one, which may be much smaller, for where it blends with others.
template <int Dim>
class TiledField final : public Field<Dim> {
 public:
  /// Of one tile; empty pointers where the field is not needed.
  struct Tile {
    std::shared_ptr<const Field<Dim>> inside;  ///< for points deeper than `blend` in the tile
    std::shared_ptr<const Field<Dim>> rim;     ///< for the others
  };

  /// `tiles` has an entry for every tile of the plan. Where only one of the fields of a tile is there, it does for
  /// both; without any, the value is NaN where no other tile has a say.
  TiledField(TilePlan<Dim> plan, std::vector<Tile> tiles, const Box<Dim>& bounds, double feature_size);

  void evaluate_block(const PointsRef<Dim>& x, const JetBlock& out) const override;
  [[nodiscard]] Box<Dim> bounds() const override { return bounds_; }
  /// Those of the fields `inside`, each in its own tile.
  [[nodiscard]] Points<Dim> seeds() const override;
  [[nodiscard]] double feature_size() const override { return feature_size_; }
  /// The largest of the fields.
  [[nodiscard]] double least_persistence() const override;
  /// Tile by tile, so that few are needed at a time; any where only one tile has a field inside.
  [[nodiscard]] std::vector<Index> evaluation_order(const PointsRef<Dim>& x) const override;

  [[nodiscard]] const TilePlan<Dim>& plan() const { return plan_; }
  [[nodiscard]] const std::vector<Tile>& tiles() const { return tiles_; }

 private:
  TilePlan<Dim> plan_;
  std::vector<Tile> tiles_;
  Box<Dim> bounds_;
  double feature_size_;
  Index whole_tiles_ = 0;  // that have a field inside
};

}  // namespace csrbf
