#include "csrbf/approx/hermite/hermite_field.hpp"

#include "csrbf/spatial/morton_order.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace csrbf {

template <int Dim>
std::vector<Index> HermiteSystem<Dim>::known() const {
  std::vector<Index> rows;
  for (Index i = 0; i < size(); ++i)
    for (Index a = 0; a < rows_each; ++a)
      if (std::isfinite(nuggets(i, a))) rows.push_back(rows_each * i + a);
  return rows;
}

namespace {

// The covariances of value and derivatives at x (rows) with those at y, z = x - y.
template <int Dim>
Eigen::Matrix<double, 1 + Dim, 1 + Dim> covariance_block(const HermiteKernel& kernel, const Point<Dim>& z) {
  const auto psi = kernel.psi(z.squaredNorm());
  Eigen::Matrix<double, 1 + Dim, 1 + Dim> block;
  block(0, 0) = psi[0];
  block.template block<1, Dim>(0, 1) = -psi[1] * z.transpose();
  block.template block<Dim, 1>(1, 0) = psi[1] * z;
  block.template block<Dim, Dim>(1, 1) = -psi[2] * z * z.transpose();
  block.diagonal().template tail<Dim>().array() -= psi[1];
  return block;
}

}  // namespace

template <int Dim>
Eigen::MatrixXd HermiteSystem<Dim>::matrix(const HermiteKernel& kernel) const {
  Eigen::MatrixXd all(rows_each * size(), rows_each * size());
  for (Index j = 0; j < size(); ++j)
    for (Index i = j; i < size(); ++i)
      all.template block<rows_each, rows_each>(rows_each * i, rows_each * j) =
          covariance_block<Dim>(kernel, centers.col(i) - centers.col(j));
  const std::vector<Index> rows = known();
  Eigen::MatrixXd some = std::ssize(rows) == all.rows() ? std::move(all) : all(rows, rows);
  for (std::size_t k = 0; k < rows.size(); ++k)
    some(static_cast<Index>(k), static_cast<Index>(k)) += nuggets(rows[k] / rows_each, rows[k] % rows_each);
  return some;
}

template <int Dim>
Eigen::VectorXd HermiteSystem<Dim>::covariances(const HermiteKernel& kernel, const Point<Dim>& x) const {
  Eigen::VectorXd k(rows_each * size());
  for (Index i = 0; i < size(); ++i) {
    const Point<Dim> z = x - centers.col(i);
    const auto psi = kernel.psi(z.squaredNorm());
    k[rows_each * i] = psi[0];
    k.template segment<Dim>(rows_each * i + 1) = -psi[1] * z;
  }
  return k;
}

template <int Dim>
HermiteFactor<Dim>::HermiteFactor(const HermiteKernel& kernel, const HermiteSystem<Dim>& system)
    : known(system.known()) {
  const Eigen::MatrixXd A = system.matrix(kernel);
  for (;;) {
    Eigen::MatrixXd noisy = A;
    noisy.diagonal().array() += jitter;
    llt.compute(noisy);
    if (llt.info() == Eigen::Success || jitter > 1) break;
    jitter = jitter > 0 ? 100 * jitter : 1e-14;
  }
  trend.resize(std::ssize(known));
  for (std::size_t k = 0; k < known.size(); ++k)
    trend[static_cast<Index>(k)] = known[k] % HermiteSystem<Dim>::rows_each == 0 ? 1 : 0;
  solve_lower(llt, trend);
  information = trend.squaredNorm();
}

template <int Dim>
double HermiteFactor<Dim>::variance(const HermiteKernel& kernel, const HermiteSystem<Dim>& system,
                                    const Point<Dim>& x) const {
  Eigen::VectorXd k = system.covariances(kernel, x)(known);
  solve_lower(llt, k);
  double result = 1 - k.squaredNorm();
  if (information > 0) result += std::pow(1 - trend.dot(k), 2) / information;
  return std::max(result, 0.0);
}

// Value, gradient and Hessian at one point.
template <int Dim>
struct HermiteField<Dim>::PointJet {
  double value = 0;
  Point<Dim> gradient = Point<Dim>::Zero();
  Eigen::Matrix<double, Dim, Dim> hessian = Eigen::Matrix<double, Dim, Dim>::Zero();
};

template <int Dim>
void HermiteField<Dim>::add_patch(const Patch& patch, const Point<Dim>& x, PointJet& f) const {
  if (is_variance_) {
    f.value += patch.variance[component_];
    return;
  }
  f.value += patch.mean[component_];
  for (Index i = 0; i < patch.centers.cols(); ++i) {
    const Point<Dim> z = x - patch.centers.col(i);
    const auto psi = data_->kernel.psi(z.squaredNorm());
    const auto c = patch.coefficients.col(component_).template segment<1 + Dim>((1 + Dim) * i);
    const Point<Dim> b = c.template tail<Dim>();
    const double u = b.dot(z);
    f.value += c[0] * psi[0] - u * psi[1];
    f.gradient += (c[0] * psi[1] - u * psi[2]) * z - psi[1] * b;
    f.hessian += (c[0] * psi[2] - u * psi[3]) * z * z.transpose() - psi[2] * (b * z.transpose() + z * b.transpose());
    f.hessian.diagonal().array() += c[0] * psi[1] - u * psi[2];
  }
}

template <int Dim>
typename HermiteField<Dim>::PointJet HermiteField<Dim>::at(const Point<Dim>& given) const {
  PointJet sum;
  if (!data_->cover) {
    add_patch(data_->patches.front(), given, sum);
    return sum;
  }
  const Cover<Dim>& cover = *data_->cover;
  const Point<Dim> x = given.cwiseMax(cover.box().lo).cwiseMin(cover.box().hi);
  PointJet weights;
  for (const std::uint32_t support : cover.supports_over(cover.find(x))) {
    const Box<Dim>& cell = cover.cell(support);
    const Point<Dim> half = 0.5 * cover.growth() * cell.extent();
    PointJet w;
    w.value = 1;
    Point<Dim> slope, bend;  // of the logarithm's factors: w_a'/w_a, w_a''/w_a
    for (Index a = 0; a < Dim; ++a) {
      const double t = half[a] > 0 ? (x[a] - cell.center()[a]) / half[a] : 0, rest = 1 - t * t;
      if (!(rest > 0)) {
        w.value = 0;
        break;
      }
      w.value *= std::pow(rest, 4);
      slope[a] = half[a] > 0 ? -8 * t / rest / half[a] : 0;
      bend[a] = half[a] > 0 ? (48 * t * t / (rest * rest) - 8 / rest) / (half[a] * half[a]) : 0;
    }
    if (!(w.value > 0)) continue;
    w.gradient = w.value * slope;
    w.hessian = w.value * slope * slope.transpose();
    w.hessian.diagonal() = w.value * bend;
    PointJet f;
    add_patch(data_->patches[support], x, f);
    sum.value += w.value * f.value;
    sum.gradient += w.value * f.gradient + f.value * w.gradient;
    sum.hessian += w.value * f.hessian + w.gradient * f.gradient.transpose() + f.gradient * w.gradient.transpose() +
                   f.value * w.hessian;
    weights.value += w.value;
    weights.gradient += w.gradient;
    weights.hessian += w.hessian;
  }
  PointJet f;
  f.value = sum.value / weights.value;
  f.gradient = (sum.gradient - f.value * weights.gradient) / weights.value;
  f.hessian = (sum.hessian - f.value * weights.hessian - f.gradient * weights.gradient.transpose() -
               weights.gradient * f.gradient.transpose()) /
              weights.value;
  return f;
}

template <int Dim>
double HermiteField<Dim>::variance_at(const Point<Dim>& x) const {
  once_.call([&] { factor_ = std::make_unique<const HermiteFactor<Dim>>(data_->kernel, *data_->system); });
  return data_->sigma2[component_] * (factor_->variance(data_->kernel, *data_->system, x) + data_->noise);
}

template <int Dim>
void HermiteField<Dim>::evaluate_block(const PointsRef<Dim>& x, const JetBlock& out) const {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  const bool exact_variance = is_variance_ && data_->system;
  for (Index i = 0; i < x.cols(); ++i) {
    PointJet f;
    if (!x.col(i).allFinite())
      f.value = nan;
    else if (exact_variance)
      f.value = variance_at(x.col(i));
    else
      f = at(x.col(i));
    out.value[i] = f.value;
    if (out.gradient != nullptr) std::copy_n(f.gradient.data(), Dim, out.gradient + Dim * i);
    if (out.gradient != nullptr && exact_variance) std::fill_n(out.gradient + Dim * i, Dim, nan);
    if (out.hessian == nullptr) continue;
    double* entry = out.hessian + symmetric_size<Dim> * i;
    for (int a = 0; a < Dim; ++a)
      for (int b = a; b < Dim; ++b) *entry++ = exact_variance ? nan : f.hessian(a, b);
  }
}

template <int Dim>
std::vector<Index> HermiteField<Dim>::evaluation_order(const PointsRef<Dim>& x) const {
  return data_->cover ? rough_morton_order<Dim>(x) : std::vector<Index>{};
}

#define CSRBF_INSTANTIATE(Dim)        \
  template struct HermiteSystem<Dim>; \
  template struct HermiteFactor<Dim>; \
  template class HermiteField<Dim>;
CSRBF_FOR_EACH_DIM(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
