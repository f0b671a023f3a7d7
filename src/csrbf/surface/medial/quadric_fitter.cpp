#include "csrbf/surface/medial/quadric_fitter.hpp"

#include <Eigen/Cholesky>

namespace csrbf {
namespace {

constexpr double normal_weight = 0.1;  // kappa of eq. (6.24), chosen by hand: of normals relative to positions
// The same values as for patches (composite.hpp, patch_fitter.cpp).
constexpr std::size_t most_samples = 400;  // that a quadric is fitted to; denser ones are thinned evenly
constexpr double ridge = 1e-6;             // of A, relative; makes a quadric over planar samples planar
constexpr double round_off = 1e-13;        // relative; keeps the normal matrices positive definite

// Value and derivatives of the monomials; the mixed ones count twice.
Eigen::Matrix<double, 4, 10> quadric_rows(const Point<3>& q) {
  const double x = q[0], y = q[1], z = q[2];
  Eigen::Matrix<double, 4, 10> rows;
  rows << 1, x, y, z, x * x, 2 * x * y, 2 * x * z, y * y, 2 * y * z, z * z,  //
      0, 1, 0, 0, 2 * x, 2 * y, 2 * z, 0, 0, 0,                              //
      0, 0, 1, 0, 0, 2 * x, 0, 2 * y, 2 * z, 0,                              //
      0, 0, 0, 1, 0, 0, 2 * x, 0, 2 * y, 2 * z;
  return rows;
}

}  // namespace

QuadricFitter::Quadric QuadricFitter::fit(const Point<3>& center, double support) {
  tree_.within(center, support, ids_);
  const std::size_t stride = ids_.size() / most_samples + 1;
  Eigen::Matrix<double, 10, 10> M = Eigen::Matrix<double, 10, 10>::Zero();
  Quadric b = Quadric::Zero();
  double sum = 0;
  Eigen::Matrix<double, 10, 10> values = Eigen::Matrix<double, 10, 10>::Zero();
  for (std::size_t k = 0; k < ids_.size(); k += stride) {
    const Index i = ids_[k];
    const Point<3> q = (cloud_.points.col(i) - center) / support;
    const double r = q.norm(), a = std::max(0.0, 1 - r), phi = a * a * a * a * (4 * r + 1);
    const double w = phi * cloud_.spacing[i] * cloud_.spacing[i];
    const Eigen::Matrix<double, 4, 10> rows = quadric_rows(q);
    values.noalias() += w * rows.row(0).transpose() * rows.row(0);
    M.noalias() += w * normal_weight * rows.bottomRows<3>().transpose() * rows.bottomRows<3>();
    b.noalias() -= w * normal_weight * rows.bottomRows<3>().transpose() * cloud_.normals.col(i);
    sum += w;
  }
  M += values;
  for (int k = 4; k < 10; ++k) M(k, k) += (k == 4 || k == 7 || k == 9 ? 1.0 : 2.0) * ridge * sum;
  M.diagonal().array() += round_off * sum;
  Quadric c = M.ldlt().solve(b);
  residual_ = support * std::sqrt(std::max(0.0, c.dot(values * c)) / std::max(sum, std::numeric_limits<double>::min()));
  c[0] *= support;
  c.tail<6>() /= support;
  return c;
}

Eigen::Vector4d evaluate_quadric(const Eigen::Ref<const QuadricFitter::Quadric>& c, const Point<3>& d) {
  const double x = d[0], y = d[1], z = d[2];
  const Point<3> Ad(c[4] * x + c[5] * y + c[6] * z, c[5] * x + c[7] * y + c[8] * z, c[6] * x + c[8] * y + c[9] * z);
  const Point<3> b = c.segment<3>(1);
  Eigen::Vector4d result;
  result << c[0] + d.dot(b + Ad), b + 2 * Ad;
  return result;
}

}  // namespace csrbf
