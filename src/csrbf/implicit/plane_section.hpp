#pragma once

#include "csrbf/core/field.hpp"

namespace csrbf {

/// A field restricted to a plane: a field of two variables whose point (u, v) is origin + across * (u, v).
template <int Dim>
class PlaneSection : public Field<2> {
 public:
  using Across = Eigen::Matrix<double, Dim, 2>;

  /// `field` must outlive the section.
  PlaneSection(const Field<Dim>& field, const Point<Dim>& origin, const Across& across, const Box<2>& bounds)
      : field_(field), origin_(origin), across_(across), bounds_(bounds) {}

  void evaluate_block(const PointsRef<2>& x, const JetBlock& out) const override;
  [[nodiscard]] Box<2> bounds() const override { return bounds_; }
  [[nodiscard]] double feature_size() const override;
  /// As fast as evaluate_grid() of the field if the plane is parallel to its axes.
  [[nodiscard]] Eigen::VectorXd evaluate_grid(const GridAxes<2>& axes) const override;

 private:
  const Field<Dim>& field_;
  Point<Dim> origin_;
  Across across_;
  Box<2> bounds_;
};

}  // namespace csrbf
