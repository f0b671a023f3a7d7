#include "csrbf/approx/kriging/local_kriging.hpp"

#include "csrbf/approx/basis/polynomial.hpp"
#include "csrbf/approx/kriging/held_out_gaps.hpp"
#include "csrbf/spatial/squared_distances.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace csrbf {
namespace {

// Samples around the middle of a patch, by dimension: the nearest ones, and of every level in every direction. Chosen
// by hand.
template <int Dim>
constexpr Index nearest = Dim == 1   ? 12
                          : Dim == 2 ? 48
                                     : 60;
template <int Dim>
constexpr Index each = Dim == 1   ? 6
                       : Dim == 2 ? 4
                                  : 2;

}  // namespace

KrigingSystem::KrigingSystem(const SampleView& samples, const Covariance& covariance, const Eigen::VectorXd& center,
                             const std::vector<Index>& chosen, Index nearest)
    : covariance_(covariance), center_(center) {
  const auto n = static_cast<Index>(chosen.size()), dimension = samples.dimension();
  q_.resize(dimension, n);
  for (Index i = 0; i < n; ++i)
    for (Index a = 0; a < dimension; ++a)
      q_(a, i) = (samples.points(a, chosen[static_cast<std::size_t>(i)]) - center[a]) / covariance.length;
  Eigen::VectorXd r2(n * (n + 1) / 2), phi(r2.size());
  for (Index j = 0, at = 0; j < n; at += n - j, ++j) squared_distances(q_, j, q_.col(j).data(), r2.data() + at);
  covariance.kernel.values(r2.data(), r2.size(), phi.data());
  Eigen::MatrixXd K = Eigen::MatrixXd::Zero(n, n);
  for (Index j = 0, at = 0; j < n; at += n - j, ++j) K.col(j).tail(n - j) = phi.segment(at, n - j);
  Eigen::VectorXd inverse_weights(n);
  for (Index i = 0; i < n; ++i) inverse_weights[i] = 1 / samples.weight(chosen[static_cast<std::size_t>(i)]);
  for (nugget_ = covariance.nugget;; nugget_ *= 10) {  // until rounding no longer matters
    Eigen::MatrixXd shifted = K;
    shifted.diagonal() += nugget_ * inverse_weights;
    llt_.compute(shifted);
    if (llt_.info() == Eigen::Success || !(nugget_ < 1)) break;
  }
  const Eigen::MatrixXd values = samples.values(chosen, Eigen::all);
  const Eigen::VectorXd least = values.colwise().minCoeff(), largest = values.colwise().maxCoeff();
  middle_ = 0.5 * least + 0.5 * largest;
  range_ = largest - least;
  const Index coefficients = monomial_count(static_cast<int>(dimension), covariance.degree);
  const int degree = coefficients < n ? covariance.degree : 0;
  covariance_.degree = degree;
  white_trend_.resize(n, monomial_count(static_cast<int>(dimension), degree));
  for (Index i = 0; i < n; ++i) white_trend_.row(i) = trend(q_.col(i));
  Eigen::MatrixXd white = values;
  solve_lower(llt_, white_trend_);
  solve_lower(llt_, white);
  information_.compute(Eigen::MatrixXd(white_trend_.transpose() * white_trend_));
  beta_ = solve(information_, Eigen::MatrixXd(white_trend_.transpose() * white));
  white -= white_trend_ * beta_;
  const auto degrees = static_cast<double>(std::max<Index>(1, n - white_trend_.cols()));  // of freedom
  const Eigen::ArrayXd of_all = white.colwise().squaredNorm().transpose() / degrees;
  const Eigen::ArrayXd of_near = near_scale(values, inverse_weights, nearest);
  constexpr double nothing = 1e-24;  // where the nearest are alike, of which the next one may not be
  scale_ = (of_all * (of_near > nothing * of_all).select(of_near, of_all / static_cast<double>(nearest))).sqrt();
  solve_upper(llt_, white);
  alpha_ = std::move(white);
}

// sigma^2 by the samples nearest to the middle alone, whatever their mean: the scale of the random function varies.
Eigen::VectorXd KrigingSystem::near_scale(const Eigen::MatrixXd& values, const Eigen::VectorXd& inverse_weights,
                                          Index nearest) const {
  const Index n = q_.cols(), count = std::min(nearest, n);
  std::vector<Index> order(static_cast<std::size_t>(n));
  std::iota(order.begin(), order.end(), Index{0});
  Eigen::VectorXd distance2(n);
  squared_distances(q_, 0, Eigen::VectorXd::Zero(q_.rows()).eval().data(), distance2.data());
  std::nth_element(order.begin(), order.begin() + (count - 1), order.end(),
                   [&](Index a, Index b) { return distance2[a] < distance2[b]; });
  order.resize(static_cast<std::size_t>(count));
  Eigen::MatrixXd q(q_.rows(), count);
  for (Index i = 0; i < count; ++i) q.col(i) = q_.col(order[static_cast<std::size_t>(i)]);
  Eigen::MatrixXd K = Eigen::MatrixXd::Zero(count, count);
  Eigen::VectorXd r2(count);
  for (Index j = 0; j < count; ++j) {
    squared_distances(q, j, q.col(j).data(), r2.data());
    covariance_.kernel.values(r2.data(), count - j, &K(j, j));
  }
  K.diagonal() += (nugget_ * inverse_weights)(order);
  Eigen::MatrixXd white(count, 1 + values.cols());
  white << Eigen::VectorXd::Ones(count), values(order, Eigen::all);
  solve_lower(Eigen::LLT<Eigen::MatrixXd>(K), white);
  const Eigen::VectorXd mean = white.col(0) / white.col(0).norm();
  white -= mean * (mean.transpose() * white).eval();
  return white.rightCols(values.cols()).colwise().squaredNorm().transpose() /
         std::max(1.0, static_cast<double>(count - 1));
}

Eigen::RowVectorXd KrigingSystem::trend(const Eigen::VectorXd& q) const {
  Eigen::RowVectorXd row(monomial_count(static_cast<int>(q.size()), covariance_.degree));
  row[0] = 1;
  if (covariance_.degree == 1) row.tail(q.size()) = q.transpose();
  return row;
}

Eigen::VectorXd KrigingSystem::value(const Eigen::Ref<const Eigen::VectorXd>& x) const {
  const Eigen::VectorXd q = (x - center_) / covariance_.length;
  Eigen::VectorXd r2(q_.cols()), k(q_.cols());
  squared_distances(q_, 0, q.data(), r2.data());
  covariance_.kernel.values(r2.data(), r2.size(), k.data());
  return alpha_.transpose() * k + beta_.transpose() * trend(q).transpose();
}

Eigen::VectorXd KrigingSystem::variance(const Eigen::Ref<const Eigen::VectorXd>& x) const {
  const double expected = share(x);
  Eigen::VectorXd result(scale_.size());
  for (Index c = 0; c < result.size(); ++c) result[c] = prediction_variance(covariance_, c, expected, scale_[c]);
  return result;
}

double KrigingSystem::share(const Eigen::Ref<const Eigen::VectorXd>& x) const {
  const Eigen::VectorXd q = (x - center_) / covariance_.length;
  Eigen::VectorXd r2(q_.cols()), k(q_.cols());
  squared_distances(q_, 0, q.data(), r2.data());
  covariance_.kernel.values(r2.data(), r2.size(), k.data());
  solve_lower(llt_, k);
  const Eigen::VectorXd missing = trend(q).transpose() - white_trend_.transpose() * k;
  return std::max(0.0, 1 - k.squaredNorm()) + covariance_.nugget + missing.dot(solve(information_, missing));
}

template <int Dim>
KrigingPatch<Dim>::KrigingPatch(const Samples<Dim>& samples, const Covariance& covariance, const Point<Dim>& center,
                                const std::vector<Index>& chosen)
    : KrigingSystem(SampleView(samples), covariance, center, chosen, nearest<Dim>) {}

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
std::vector<Index> samples_around(const ThinnedLevels<Dim>& levels, const Point<Dim>& x) {
  return levels.around(x, nearest<Dim>, each<Dim>);
}

template <int Dim>
LocalKriging<Dim>::LocalKriging(const Samples<Dim>& samples, const Points<Dim>& gaps)
    : samples_(samples), levels_(samples.points), covariance_(estimate_covariance(samples, levels_)) {
  const HeldOutGaps<Dim> held_out(samples, levels_, gaps);
  if (held_out.empty()) return;
  HeldOutChoice choice = held_out.choose(covariance_);
  covariance_ = std::move(choice.covariance);
  is_linear_ = choice.is_linear;
}

template <int Dim>
KrigingPatch<Dim> LocalKriging<Dim>::patch(const Point<Dim>& center) const {
  return {samples_, covariance_, center, around(center)};
}

template <int Dim>
std::vector<Index> LocalKriging<Dim>::around(const Point<Dim>& center) const {
  return samples_around(levels_, center);
}

template <int Dim>
LocalModels<Dim> LocalKriging<Dim>::models(Index count) const {
  LocalModels<Dim> models;
  models.degree = covariance_.degree;
  models.kernel = covariance_.kernel;
  models.support = 1;
  models.centers_each =
      std::min(samples_.size(), nearest<Dim> + ThinnedLevels<Dim>::cones * each<Dim> * std::ssize(levels_.levels()));
  models.components = samples_.components();
  models.resize(count);
  return models;
}

#define CSRBF_INSTANTIATE(Dim) template class KrigingPatch<Dim>;
CSRBF_FOR_MANY_DIMS(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

#define CSRBF_INSTANTIATE(Dim)      \
  template class LocalKriging<Dim>; \
  template std::vector<Index> samples_around<Dim>(const ThinnedLevels<Dim>&, const Point<Dim>&);
CSRBF_FOR_EACH_DIM(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
