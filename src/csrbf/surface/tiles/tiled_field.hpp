#pragma once

#include "csrbf/core/field.hpp"
#include "csrbf/surface/tiles/tile_plan.hpp"

#include <memory>

namespace csrbf {

/// A partition of unity whose patches are the tiles of a plan: f = sum_t w_t f_t / sum_t w_t. The weight w_t is 1 in
/// the tile, falls to 0 from `blend` inside its faces to `blend` outside, and is C2. A tile has two fields: one for
/// where it is alone, and one, which may be much smaller, for where it blends with others.
class TiledField final : public Field<3> {
 public:
  /// Of one tile; empty pointers where the field is not needed.
  struct Tile {
    std::shared_ptr<const Field<3>> inside;  ///< for points deeper than `blend` in the tile
    std::shared_ptr<const Field<3>> rim;     ///< for the others
  };

  /// `tiles` has an entry for every tile of the plan. Where only one of the fields of a tile is there, it does for
  /// both; without any, the value is NaN where no other tile has a say.
  TiledField(TilePlan plan, std::vector<Tile> tiles, const Box<3>& bounds, double feature_size);

  void evaluate_block(const PointsRef<3>& x, const JetBlock& out) const override;
  [[nodiscard]] Box<3> bounds() const override { return bounds_; }
  /// Those of the fields `inside`, each in its own tile.
  [[nodiscard]] Points<3> seeds() const override;
  [[nodiscard]] double feature_size() const override { return feature_size_; }

 private:
  TilePlan plan_;
  std::vector<Tile> tiles_;
  Box<3> bounds_;
  double feature_size_;
};

}  // namespace csrbf
