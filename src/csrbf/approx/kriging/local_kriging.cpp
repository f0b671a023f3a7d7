#include "csrbf/approx/kriging/local_kriging.hpp"

#include <algorithm>
#include <cmath>

namespace csrbf {
namespace {

// Samples of every level around the middle of a patch, by dimension. Chosen by hand.
template <int Dim>
constexpr Index each = Dim == 1   ? 12
                       : Dim == 2 ? 24
                                  : 36;
constexpr double prior_samples = 30;  // that the common variance counts for beside that of a patch; chosen by hand

}  // namespace

template <int Dim>
KrigingPatch<Dim>::KrigingPatch(const Samples<Dim>& samples, const Covariance& covariance, const Point<Dim>& center,
                                const std::vector<Index>& chosen)
    : covariance_(covariance), center_(center) {
  const auto n = static_cast<Index>(chosen.size());
  q_ = (samples.points(Eigen::all, chosen).colwise() - center) / covariance.length;
  Eigen::VectorXd r2(n * (n + 1) / 2), phi(r2.size());
  for (Index j = 0, at = 0; j < n; ++j)
    for (Index i = j; i < n; ++i) r2[at++] = (q_.col(i) - q_.col(j)).squaredNorm();
  covariance.kernel.values(r2.data(), r2.size(), phi.data());
  Eigen::MatrixXd K = Eigen::MatrixXd::Zero(n, n);
  for (Index j = 0, at = 0; j < n; at += n - j, ++j) K.col(j).tail(n - j) = phi.segment(at, n - j);
  Eigen::VectorXd inverse_weights(n);
  for (Index i = 0; i < n; ++i) inverse_weights[i] = 1 / samples.weight(chosen[static_cast<std::size_t>(i)]);
  for (double nugget = covariance.nugget;; nugget *= 10) {  // until rounding no longer matters
    Eigen::MatrixXd shifted = K;
    shifted.diagonal() += nugget * inverse_weights;
    llt_.compute(shifted);
    if (llt_.info() == Eigen::Success || !(nugget < 1)) break;
  }
  const Eigen::MatrixXd values = samples.values(chosen, Eigen::all);
  const int degree = Polynomials<Dim>::size(covariance.degree) < n ? covariance.degree : 0;
  covariance_.degree = degree;
  white_trend_.resize(n, Polynomials<Dim>::size(degree));
  for (Index i = 0; i < n; ++i) white_trend_.row(i) = trend(q_.col(i));
  Eigen::MatrixXd white = values;
  llt_.matrixL().solveInPlace(white_trend_);
  llt_.matrixL().solveInPlace(white);
  information_.compute(white_trend_.transpose() * white_trend_);
  beta_ = information_.solve(white_trend_.transpose() * white);
  white -= white_trend_ * beta_;
  sigma2_ = (white.colwise().squaredNorm().transpose() + prior_samples * covariance.sigma2) /
            (static_cast<double>(std::max<Index>(0, n - white_trend_.cols())) + prior_samples);
  llt_.matrixU().solveInPlace(white);
  alpha_ = std::move(white);
}

template <int Dim>
Eigen::RowVectorXd KrigingPatch<Dim>::trend(const Point<Dim>& q) const {
  Eigen::RowVectorXd row(Polynomials<Dim>::size(covariance_.degree));
  row[0] = 1;
  if (covariance_.degree == 1) row.tail(Dim) = q.transpose();
  return row;
}

template <int Dim>
Eigen::VectorXd KrigingPatch<Dim>::variance(const Point<Dim>& x) const {
  const Point<Dim> q = (x - center_) / covariance_.length;
  const Eigen::VectorXd r2 = (q_.colwise() - q).colwise().squaredNorm().transpose();
  Eigen::VectorXd k(r2.size());
  covariance_.kernel.values(r2.data(), r2.size(), k.data());
  llt_.matrixL().solveInPlace(k);
  const Eigen::VectorXd missing = trend(q).transpose() - white_trend_.transpose() * k;
  const double share =
      std::max(0.0, 1 - k.squaredNorm()) + covariance_.nugget + missing.dot(information_.solve(missing));
  return share * sigma2_;
}

template <int Dim>
void KrigingPatch<Dim>::store(LocalModels<Dim>& models, Index i) const {
  models.center.col(i) = center_;
  models.radius[i] = covariance_.length;
  const Index M = models.centers_each, Q = models.polynomial_size(), n = q_.cols(), C = models.components;
  double* position = models.position.data() + Dim * M * i;
  std::fill_n(position, Dim * M, 0.0);
  std::copy_n(q_.data(), Dim * n, position);
  double* alpha = models.alpha.data() + C * M * i;
  double* polynomial = models.polynomial.data() + C * Q * i;
  std::fill_n(alpha, C * M, 0.0);
  std::fill_n(polynomial, C * Q, 0.0);
  for (Index c = 0; c < C; ++c) {
    std::copy_n(alpha_.col(c).data(), n, alpha + M * c);
    std::copy_n(beta_.col(c).data(), beta_.rows(), polynomial + Q * c);
  }
}

template <int Dim>
LocalKriging<Dim>::LocalKriging(const Samples<Dim>& samples)
    : samples_(samples), levels_(samples.points), covariance_(estimate_covariance(samples, levels_)) {}

template <int Dim>
KrigingPatch<Dim> LocalKriging<Dim>::patch(const Point<Dim>& center) const {
  return {samples_, covariance_, center, levels_.around(center, each<Dim>)};
}

template <int Dim>
LocalModels<Dim> LocalKriging<Dim>::models(Index count) const {
  LocalModels<Dim> models;
  models.degree = covariance_.degree;
  models.kernel = covariance_.kernel;
  models.support = 1;
  models.centers_each = std::min(samples_.size(), each<Dim> * std::ssize(levels_.levels()));
  models.components = samples_.components();
  models.resize(count);
  return models;
}

#define CSRBF_INSTANTIATE(Dim)      \
  template class KrigingPatch<Dim>; \
  template class LocalKriging<Dim>;
CSRBF_FOR_EACH_DIM(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
