#pragma once

#include "csrbf/approx/fit_options.hpp"
#include "csrbf/core/field.hpp"

#include <array>
#include <memory>
#include <vector>

namespace csrbf {

/// A field in the coordinates of the user: f(x) = inner(y), y_a = x_a / scale_a, repeated along periodic axes (see
/// PeriodicField) and extrapolated outside the box of the samples.
template <int Dim>
class FittedField : public Field<Dim> {
 public:
  /// Of variances outside the box: min(amount distance^exponent, largest) is added where values end; where they follow
  /// the trend, and largest > 0, a variance is at most largest (1 + distance in extents of the box)^2.
  struct Growth {
    double amount = 0, exponent = 1, largest = 0;
  };
  struct Frame {
    Point<Dim> scales = Point<Dim>::Ones();
    Point<Dim> periods = Point<Dim>::Zero();  ///< 0 for axes that are not periodic; the first period starts at box.lo
    Box<Dim> box;                             ///< of the samples, in the coordinates of the user
    Extrapolation extrapolation = Extrapolation::constant;  ///< automatic, which fits decide, is constant
    /// How far outside the box a constant extrapolation begins with the slope there, in the coordinates of the user.
    Point<Dim> rim = Point<Dim>::Zero();
    double unit = 1;     ///< of the values: f = unit inner
    Growth growth = {};  ///< at the distance from the box in the coordinates of the inner field
  };

  FittedField(std::shared_ptr<const Field<Dim>> inner, const Frame& frame);

  void evaluate_block(const PointsRef<Dim>& x, const JetBlock& out) const override;
  [[nodiscard]] std::vector<Index> evaluation_order(const PointsRef<Dim>& x) const override;
  [[nodiscard]] Eigen::VectorXd evaluate_grid(const GridAxes<Dim>& axes) const override;
  [[nodiscard]] Box<Dim> bounds() const override { return frame_.box; }
  [[nodiscard]] double feature_size() const override { return inner_->feature_size() * frame_.scales.minCoeff(); }

  /// That of the inner field, if there are no periods and values are constant outside; with a rim, inside only.
  [[nodiscard]] std::optional<Enclosure> enclose(const Box<Dim>& box) const override;

  /// The same for coordinates in another unit, and with values in one.
  [[nodiscard]] std::shared_ptr<const FittedField> in_units(const Point<Dim>& coordinates, double values) const;

  /// The usual distance of samples along each axis, as if they were in space where there are more variables: 0 along
  /// axes where all are at one place.
  [[nodiscard]] static Point<Dim> rim_of(const PointsRef<Dim>& samples);

  [[nodiscard]] const Field<Dim>& inner() const { return *inner_; }
  [[nodiscard]] const std::shared_ptr<const Field<Dim>>& inner_pointer() const { return inner_; }
  [[nodiscard]] const Frame& frame() const { return frame_; }

 private:
  // The largest variance at x, see Growth.
  [[nodiscard]] double bound(const Point<Dim>& x) const;
  void evaluate_in_unit(const PointsRef<Dim>& x, const JetBlock& out) const;
  void continue_linearly(const PointsRef<Dim>& x, const Points<Dim>& y,
                         const std::vector<std::array<bool, Dim>>& outside, const JetBlock& out) const;

  // How far along an axis the slope at the box is followed outside, in the coordinates of the inner field.
  [[nodiscard]] double reach(int axis) const;

  // Coordinates of the inner field; `outside[a]` says whether coordinate a was moved to the box.
  Point<Dim> map(const Point<Dim>& x, std::array<bool, Dim>& outside) const;

  std::shared_ptr<const Field<Dim>> inner_;
  std::shared_ptr<const Field<Dim>> repeated_;  // inner_ along the periodic axes
  Frame frame_;
};

}  // namespace csrbf
