#include "csrbf/implicit/polygonize/quadric.hpp"

#include "csrbf/core/small_matrices.hpp"
namespace csrbf::polygonization {
namespace {

// Chosen by hand.
constexpr double smallest_eigenvalue = 1e-3;  // of the largest: planes at less than 4 degrees count as one
constexpr double pull_to_mean = 1e-3;         // weight of the mean, in largest eigenvalues, where the box is active
constexpr int sweeps = 64;                    // of coordinate descent; more: closer to the minimum, slower

}  // namespace

void Quadric::add(const Point<3>& point, const Point<3>& normal) {
  const double offset = normal.dot(point);
  A_ += normal * normal.transpose();
  b_ += offset * normal;
  c_ += offset * offset;
  planes_ += normal.squaredNorm();
  point_sum_ += point;
  points_ += 1;
}

Quadric& Quadric::operator+=(const Quadric& other) {
  A_ += other.A_;
  b_ += other.b_;
  c_ += other.c_;
  planes_ += other.planes_;
  point_sum_ += other.point_sum_;
  points_ += other.points_;
  return *this;
}

double Quadric::distance(const Point<3>& x) const {
  if (!(planes_ > 0)) return std::numeric_limits<double>::infinity();
  return std::sqrt(std::max(0.0, x.dot(A_ * x - 2 * b_) + c_) / planes_);
}

Point<3> Quadric::minimizer(const Box<3>& box) const {
  const Point<3> center = mean();
  const SymmetricEigen eigen = symmetric_eigen_direct(A_);
  const Point<3> values = eigen.values;
  const Eigen::Matrix3d axes = eigen.vectors;
  const Point<3> inverse = (values.array() > smallest_eigenvalue * values[2]).select(values.cwiseInverse(), 0.0);
  const Point<3> slope = axes.transpose() * (b_ - A_ * center);
  Point<3> x = center + axes * inverse.cwiseProduct(slope);
  if (box.contains(x)) return x;

  // Projected coordinate descent, which converges: the mean makes the sum strictly convex.
  const double weight = pull_to_mean * values[2];
  for (int sweep = 0; sweep < sweeps; ++sweep) {
    for (int axis = 0; axis < 3; ++axis) {
      const double slope_there = A_.row(axis).dot(x) - b_[axis] + weight * (x[axis] - center[axis]);
      const double curvature = A_(axis, axis) + weight;
      if (curvature > 0) x[axis] -= slope_there / curvature;
      x[axis] = std::clamp(x[axis], box.lo[axis], box.hi[axis]);
    }
  }
  return x;
}

}  // namespace csrbf::polygonization
