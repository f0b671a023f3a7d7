#include "csrbf/surface/normals/local_normal.hpp"

#include "csrbf/core/small_matrices.hpp"

namespace csrbf {
namespace {

// Chosen by hand.
constexpr std::size_t least_for_curvature = 8;  // points for a quadric, which has 6 coefficients; fewer: a plane
constexpr double ridge = 1e-5;  // of the weights, on quadratic terms; larger: flatter quadrics, smaller: sensitive ones
constexpr double roots_apart = 1e-5;  // ratio of eigenvalues below which their closed form is dominated by rounding
constexpr double tiny_ridge = 1e-12;  // of the weights: keeps the system regular for points on a line

double support2(std::span<const double> d2) {
  const auto count = static_cast<double>(d2.size());
  return d2.back() * (1 + 1 / count);
}

}  // namespace

LocalFrame local_frame(const Points<3>& points, std::span<const Index> ids, std::span<const double> d2,
                       const Point<3>& center) {
  LocalFrame frame;
  frame.center = center;
  const double h2 = support2(d2), inverse = h2 > 0 ? 1 / h2 : 0;
  frame.h = std::sqrt(h2);
  double total = 0;
  Point<3> mean = Point<3>::Zero();
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (std::size_t j = 0; j < ids.size(); ++j) {
    const double w = 1 - d2[j] * inverse;
    const Point<3> r = points.col(ids[j]) - center;
    total += w;
    mean += w * r;
    covariance += w * r * r.transpose();
  }
  mean /= total;
  covariance = covariance / total - mean * mean.transpose();
  const double scale = covariance.trace() > 0 ? 1 / covariance.trace() : 1;
  covariance *= scale;
  SymmetricEigen eigen = symmetric_eigen_direct(covariance);
  if (!(eigen.values[1] > roots_apart * eigen.values[2])) eigen = symmetric_eigen(covariance);
  frame.axes = eigen.vectors;
  frame.eigenvalues = eigen.values / scale;
  return frame;
}

LocalQuadric fit_quadric(const Points<3>& points, std::span<const Index> ids, std::span<const double> d2,
                         const LocalFrame& frame) {
  LocalQuadric quadric{frame};
  if (!(frame.h > 0)) return quadric;
  const Eigen::Matrix3d to_local = frame.axes.transpose() / frame.h;
  const double inverse = 1 / (frame.h * frame.h);
  Eigen::Matrix<double, 6, 6> A = Eigen::Matrix<double, 6, 6>::Zero();
  Eigen::Matrix<double, 6, 1> b = Eigen::Matrix<double, 6, 1>::Zero();
  double total = 0;
  for (std::size_t j = 0; j < ids.size(); ++j) {
    const double w = 1 - d2[j] * inverse;
    const Point<3> q = to_local * (points.col(ids[j]) - frame.center);
    const double x = q[1], y = q[2];
    Eigen::Matrix<double, 6, 1> row;
    row << 1, x, y, x * x, x * y, y * y;
    A.noalias() += (w * row) * row.transpose();
    b += (w * q[0]) * row;
    total += w;
  }
  if (ids.size() >= least_for_curvature) {
    A.diagonal().head<3>().array() += tiny_ridge * total;
    A.diagonal().tail<3>().array() += ridge * total;
  } else {  // a plane
    A.diagonal().head<3>().array() += tiny_ridge * total;
    A.bottomLeftCorner<3, 3>().setZero();
    A.bottomRightCorner<3, 3>().setIdentity();
    b.tail<3>().setZero();
  }
  quadric.z = solve_symmetric(A, b);
  return quadric;
}

Point<3> LocalQuadric::normal(const Point<3>& p) const {
  const double scale = frame.h > 0 ? 1 / frame.h : 0;
  const double x = frame.axes.col(1).dot(p - frame.center) * scale, y = frame.axes.col(2).dot(p - frame.center) * scale;
  const double zx = z[1] + 2 * z[3] * x + z[4] * y, zy = z[2] + z[4] * x + 2 * z[5] * y;
  return (frame.axes.col(0) - zx * frame.axes.col(1) - zy * frame.axes.col(2)).normalized();
}

double LocalQuadric::height(const Point<3>& p) const {
  const double scale = frame.h > 0 ? 1 / frame.h : 0;
  const Point<3> q = scale * (frame.axes.transpose() * (p - frame.center));
  const double x = q[1], y = q[2];
  return frame.h * (q[0] - (z[0] + z[1] * x + z[2] * y + z[3] * x * x + z[4] * x * y + z[5] * y * y));
}

}  // namespace csrbf
