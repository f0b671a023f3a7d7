#pragma once

#include "csrbf/core/field.hpp"

#include <memory>
#include <vector>

namespace csrbf {

/// A stereographic map of the sphere onto the plane that touches it at the third axis (a row of `axes`), in degrees
/// there: lengths are multiplied by 2 / (1 + cos(angle to the third axis)), angles are kept.
struct SphereChart {
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
};

/// The point of the unit sphere at a longitude and a latitude in degrees; exact at multiples of 90.
Point<3> point_on_sphere(double longitude, double latitude);

/// A field in longitude, latitude and other coordinates, made from fields in charts of the sphere, which are blended
/// where there are several, or from one in space, in coordinates of length 180 / pi (degrees):
///
///     f = (sum_c w_c f_c + w_0 f_0) / (sum_c w_c + w_0),   w_c = max(0, (cos(angle) - cos(65)) / (1 - cos(65)))^4
///
/// with f_0 in space only where charts leave the sphere uncovered. Three derivatives are continuous everywhere but at
/// the poles, where those by longitude and latitude are no coordinates of the sphere.
template <int Dim>
class SphereField : public Field<Dim> {
 public:
  /// Of space and the other coordinates; that of the largest dimension stands for one more, which there is not.
  static constexpr int space_dim = Dim < largest_dimension ? Dim + 1 : Dim;

  struct Part {
    SphereChart chart;
    std::shared_ptr<const Field<Dim>> field;  ///< of the two coordinates of the chart, then the other ones
  };
  struct Parts {
    int longitude = 0, latitude = 1;  ///< axes
    std::vector<Part> charts = {};
    std::shared_ptr<const Field<space_dim>> space = {};  ///< of x, y, z, then the other coordinates; or null
  };

  SphereField(Parts parts, const Box<Dim>& bounds) : parts_(std::move(parts)), bounds_(bounds) {}

  void evaluate_block(const PointsRef<Dim>& x, const JetBlock& out) const override;
  [[nodiscard]] std::vector<Index> evaluation_order(const PointsRef<Dim>& x) const override;
  [[nodiscard]] Box<Dim> bounds() const override { return bounds_; }
  [[nodiscard]] double feature_size() const override;

  [[nodiscard]] const Parts& parts() const { return parts_; }

  /// Coordinates in a chart, and in space, for fields of these.
  [[nodiscard]] static Points<Dim> in_chart(const PointsRef<Dim>& x, int longitude, int latitude,
                                            const SphereChart& chart);
  [[nodiscard]] static Points<space_dim> in_space(const PointsRef<Dim>& x, int longitude, int latitude);

 private:
  Parts parts_;
  Box<Dim> bounds_;
};

/// Largest angle from the middle of a chart at which it counts, and that up to which its field knows samples; degrees.
inline constexpr double chart_reach = 65, chart_samples = 75;

}  // namespace csrbf
