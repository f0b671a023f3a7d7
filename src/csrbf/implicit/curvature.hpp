#pragma once

#include "csrbf/core/field.hpp"
#include "csrbf/core/progress.hpp"

namespace csrbf {

/// Curvatures of the level set of a field at a point. Everything is NaN where the gradient is zero.
struct PrincipalCurvatures {
  Point<3> normal;      ///< outward, -grad f / |grad f|
  double k1 = 0;        ///< the larger principal curvature; positive where the inside is convex
  double k2 = 0;        ///< the smaller one
  Point<3> direction1;  ///< unit tangent along which the curvature is k1; its sign is arbitrary
  Point<3> direction2;  ///< unit tangent along which the curvature is k2: normal x direction1

  [[nodiscard]] double mean() const { return 0.5 * (k1 + k2); }
  [[nodiscard]] double gaussian() const { return k1 * k2; }
};

/// Principal curvatures from gradient and Hessian: the eigenvalues of the shape operator -P H P / |grad f| with
/// P = I - n n^T. (Thesis eq. (4.3) lacks the second projection; eq. (4.6), the mean curvature, lacks the factor 1/2.)
PrincipalCurvatures principal_curvatures(const Point<3>& gradient, const Eigen::Matrix3d& hessian);

/// PrincipalCurvatures at n points.
struct Curvatures {
  Points<3> normals;
  Eigen::VectorXd k1, k2;
  Points<3> direction1, direction2;

  [[nodiscard]] Eigen::VectorXd mean() const;
  [[nodiscard]] Eigen::VectorXd gaussian() const;
  /// Number of points where the gradient is zero or a value is not finite.
  [[nodiscard]] Index singular() const;
};

/// Curvatures of the level sets of a C2 field through n points (3 x n). Progress stage: "curvature". Throws Cancelled.
Curvatures curvature(const Field<3>& field, const PointsRef<3>& x, const Progress& progress = {});

/// Derivatives of a principal curvature k along its own direction t at n points, given unit tangents t (3 x n):
/// dk/dt = (3 k t.Hn - C(t,t,t)) / |grad f|. The sign changes with that of t. The third derivative C(t,t,t) is a
/// central difference of Hessians at x -+ step t: its error is O(step^2) if the field is C5. Three Hessians per point.
/// Throws InvalidInput unless step > 0 and there are as many directions as points.
Eigen::VectorXd curvature_slopes(const Field<3>& field, const PointsRef<3>& x, const PointsRef<3>& directions,
                                 double step);

}  // namespace csrbf
