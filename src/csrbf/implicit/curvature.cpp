#include "csrbf/implicit/curvature.hpp"

#include "csrbf/implicit/mesh/triangle_geometry.hpp"

namespace csrbf {

PrincipalCurvatures principal_curvatures(const Point<3>& gradient, const Eigen::Matrix3d& hessian) {
  PrincipalCurvatures result;
  const double norm = gradient.norm();
  if (!(norm > 0 && std::isfinite(norm))) {
    constexpr double undefined = std::numeric_limits<double>::quiet_NaN();
    result.k1 = result.k2 = undefined;
    result.normal = result.direction1 = result.direction2 = Point<3>::Constant(undefined);
    return result;
  }
  result.normal = -gradient / norm;
  const auto [u, v] = tangents(result.normal);
  const Eigen::Matrix3d S = -hessian / norm;
  // Eigenvalues of [[a b] [b c]], the shape operator in the tangent plane.
  const double a = u.dot(S * u), b = u.dot(S * v), c = v.dot(S * v);
  const double mean = 0.5 * (a + c), half = 0.5 * (a - c), radius = std::hypot(half, b);
  result.k1 = mean + radius;
  result.k2 = mean - radius;
  const double angle = 0.5 * std::atan2(b, half);
  result.direction1 = std::cos(angle) * u + std::sin(angle) * v;
  result.direction2 = result.normal.cross(result.direction1);
  return result;
}

Curvatures curvature(const Field<3>& field, const PointsRef<3>& x, const Progress& progress) {
  const Index n = x.cols();
  Curvatures result{Points<3>(3, n), Eigen::VectorXd(n), Eigen::VectorXd(n), Points<3>(3, n), Points<3>(3, n)};
  constexpr Index part = Index{1} << 16;  // points between two progress reports
  for (Index begin = 0; begin < n; begin += part) {
    report(progress, "curvature", static_cast<double>(begin) / static_cast<double>(n));
    const Index count = std::min(part, n - begin);
    const Jet<3> jet = field.evaluate(x.middleCols(begin, count), Derivatives::hessian);
    for (Index i = 0; i < count; ++i) {
      const PrincipalCurvatures at = principal_curvatures(jet.gradient.col(i), jet.hessian_matrix(i));
      result.normals.col(begin + i) = at.normal;
      result.k1[begin + i] = at.k1;
      result.k2[begin + i] = at.k2;
      result.direction1.col(begin + i) = at.direction1;
      result.direction2.col(begin + i) = at.direction2;
    }
  }
  report(progress, "curvature", 1);
  return result;
}

Eigen::VectorXd curvature_slopes(const Field<3>& field, const PointsRef<3>& x, const PointsRef<3>& directions,
                                 double step) {
  require(step > 0 && std::isfinite(step), "curvature_slopes", "step", step, "must be positive and finite");
  require(directions.cols() == x.cols(), "curvature_slopes", "number of directions", directions.cols(),
          "must be the number of points");
  const Jet<3> jet = field.evaluate(x, Derivatives::hessian);
  const Jet<3> ahead = field.evaluate(x + step * directions, Derivatives::hessian);
  const Jet<3> behind = field.evaluate(x - step * directions, Derivatives::hessian);
  Eigen::VectorXd slopes(x.cols());
  for (Index i = 0; i < x.cols(); ++i) {
    const Point<3> t = directions.col(i), g = jet.gradient.col(i), Ht = jet.hessian_matrix(i) * t;
    const double norm = g.norm(), k = -t.dot(Ht) / norm;
    const double C = t.dot((ahead.hessian_matrix(i) - behind.hessian_matrix(i)) * t) / (2 * step);
    slopes[i] = (-3 * k * Ht.dot(g) / norm - C) / norm;
  }
  return slopes;
}

Eigen::VectorXd Curvatures::mean() const {
  return 0.5 * (k1 + k2);
}

Eigen::VectorXd Curvatures::gaussian() const {
  return k1.cwiseProduct(k2);
}

Index Curvatures::singular() const {
  return (!(k1 + k2).array().isFinite()).count();
}

}  // namespace csrbf
