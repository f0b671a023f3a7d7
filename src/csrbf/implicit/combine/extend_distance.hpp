#pragma once

#include "csrbf/core/field.hpp"
#include "csrbf/core/progress.hpp"

#include <memory>

namespace csrbf {

/// The field f + sign(f) s(|f|) E: near the surface f itself, farther away about the distance to it. s increases from 0
/// at |f| = near to 1 at 2 near; E >= 0, the deficit of |f| from the distance, is a cubic B-spline, constant outside
/// its lattice. f keeps its sign everywhere and two continuous derivatives.
class ExtendedField final : public Field<3> {
 public:
  struct Data {
    std::shared_ptr<const Field<3>> inner;  ///< f
    double near = 0;
    Point<3> origin = Point<3>::Zero();  ///< of the lattice
    double spacing = 1;
    Eigen::Array3i size;   ///< nodes along each axis, at least 4
    Eigen::VectorXf lack;  ///< coefficient of each node, x fastest
  };

  explicit ExtendedField(Data data) : data_(std::move(data)) {}

  void evaluate_block(const PointsRef<3>& x, const JetBlock& out) const override;
  [[nodiscard]] Box<3> bounds() const override { return data_.inner->bounds(); }
  [[nodiscard]] Points<3> seeds() const override { return data_.inner->seeds(); }
  [[nodiscard]] double feature_size() const override { return data_.inner->feature_size(); }
  [[nodiscard]] std::vector<Index> evaluation_order(const PointsRef<3>& x) const override {
    return data_.inner->evaluation_order(x);
  }

  [[nodiscard]] const Data& data() const { return data_; }

 private:
  Data data_;
};

/// Makes a field whose values level off a few feature sizes away from its surface, as those of `reconstruct` do, grow
/// like the distance up to `range` from it. Its surface and its values within one of them do not change. The distances
/// are those to a polygonization, blurred over a quarter of the range (at least a 128th of the longest side). Needs
/// range > 0 and feature_size() > 0. Throws whatever polygonize() throws. Progress: that of polygonize, then stage
/// "extend".
std::shared_ptr<const ExtendedField> extend_distance(const std::shared_ptr<const Field<3>>& field, double range,
                                                     const Progress& progress = {});

}  // namespace csrbf
