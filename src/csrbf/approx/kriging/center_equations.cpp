#include "csrbf/approx/kriging/center_equations.hpp"

#include "csrbf/approx/basis/expansion.hpp"
#include "csrbf/approx/global/kriging_variance.hpp"
#include "csrbf/core/parallel.hpp"
#include "csrbf/linalg/dense_cholesky.hpp"
#include "csrbf/spatial/chosen_points.hpp"
#include "csrbf/spatial/even_pairs.hpp"
#include "csrbf/spatial/kd_tree.hpp"
#include "csrbf/spatial/morton_order.hpp"
#include "csrbf/spatial/squared_distances.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace csrbf {
namespace {

// Mean P^2 at some of the samples.
template <int Dim>
double mean_power2(const PowerFunction<Dim>& power, const Points<Dim>& points) {
  constexpr Index asked = 200;  // chosen by hand
  const Points<Dim> some = chosen_points<Dim>(points, even_samples(morton_order<Dim>(points), asked));
  return std::max((power.evaluate(some).array() - power.smoothing()).mean(), 1e-300);
}

}  // namespace

template <int Dim>
CenterEquations<Dim>::CenterEquations(const AxisCovariance<Dim>& covariance, const Points<Dim>& centers,
                                      PolynomialBlock<Dim> trend, Eigen::RowVectorXd mean)
    : kernel_(covariance.kernel), centers_(centers), trend_(std::move(trend)), mean_(std::move(mean)) {
  constexpr double least_jitter = 1e-13, largest_jitter = 1e-8;
  const Index m = centers.cols();
  for (double jitter = least_jitter; jitter <= largest_jitter; jitter *= 10) {
    L_ = covariances(centers_);
    L_.diagonal().array() += jitter;
    if (cholesky_in_place(L_)) {
      is_regular_ = true;
      break;
    }
  }
  const Index p = m + trend_.monomials.cols();
  A_.setZero(p, p);
  b_.setZero(p, mean_.size());
  squares_.setZero(mean_.size());
}

template <int Dim>
void CenterEquations<Dim>::add(const Samples<Dim>& samples, int sign) {
  const Index m = centers_.cols(), p = A_.rows();
  const Polynomials<Dim> polynomials(trend_.frame.degree);
  constexpr Index rows_at_once = 1024;
  for (Index begin = 0; begin < samples.size(); begin += rows_at_once) {
    const Index n = std::min(rows_at_once, samples.size() - begin);
    const Points<Dim> x = samples.points.middleCols(begin, n);
    Eigen::VectorXd root = Eigen::VectorXd::Ones(n);
    if (samples.weights.size() > 0) root = samples.weights.segment(begin, n).cwiseSqrt();
    const Eigen::MatrixXd y = root.asDiagonal() * (samples.values.middleRows(begin, n).rowwise() - mean_);
    Eigen::MatrixXd D(p, n);
    D.topRows(m) = covariances(x);
    solve_lower_in_place(L_, D.topRows(m));
    if (p > m) {
      Eigen::MatrixXd G(n, polynomials.size());
      polynomials.rows(in_units<Dim>(x, trend_.frame.origin, trend_.frame.scale), G.data());
      D.bottomRows(p - m) = (G * trend_.monomials).transpose();
    }
    D *= root.asDiagonal();
    const Eigen::MatrixXd minus = -sign * D, transposed = D.transpose();
    constexpr Index strip = 192;
    for (Index c = 0; c < p; c += strip)
      subtract_product(minus.bottomRows(p - c), transposed.middleCols(c, std::min(strip, p - c)),
                       A_.block(c, c, p - c, std::min(strip, p - c)));
    b_ += sign * D * y;
    squares_ += sign * y.colwise().squaredNorm().transpose();
    weight_ += sign * root.squaredNorm();
    samples_ += sign * n;
  }
}

template <int Dim>
double CenterEquations<Dim>::deviance(double nugget) const {
  const Solved solved = solve(nugget);
  if (!solved.is_regular) return std::numeric_limits<double>::infinity();
  double logs = 0, C = 0;
  for (const double misfit : solved.misfit) {
    if (!(misfit > 0)) continue;  // a constant
    logs += std::log(misfit);
    C += 1;
  }
  return degrees() * logs + C * (2 * solved.factor.diagonal().array().log().sum() -
                                 static_cast<double>(centers_.cols()) * std::log(nugget));
}

template <int Dim>
std::optional<CenterFit<Dim>> CenterEquations<Dim>::fit(double nugget, const Samples<Dim>& samples,
                                                        const AxisCovariance<Dim>& covariance,
                                                        bool with_variances) const {
  Solved solved = solve(nugget);
  if (!solved.is_regular) return std::nullopt;
  const Index m = centers_.cols(), p = A_.rows(), C = mean_.size();
  CenterFit<Dim> result{.covariance = covariance, .centers = m};
  result.covariance.nugget = nugget;
  // The trace of the matrix that takes the samples to what is fitted to them: p - lambda tr (A^-1)_uu.
  Eigen::MatrixXd inverse = solved.factor;
  invert_lower_in_place(inverse);
  double trace = 0;
  for (Index j = 0; j < m; ++j) trace += inverse.col(j).tail(p - j).squaredNorm();
  const double effective = static_cast<double>(p) - nugget * trace;
  Eigen::MatrixXd solution = solved.white;
  solved.factor.template triangularView<Eigen::Lower>().transpose().solveInPlace(solution);
  const Eigen::VectorXd residual = solved.misfit - nugget * solution.topRows(m).colwise().squaredNorm().transpose();
  const double left = 1 - effective / static_cast<double>(samples_);
  result.error = left > 0 ? std::sqrt(residual.cwiseMax(0).sum() / (weight_ * static_cast<double>(C))) / left
                          : std::numeric_limits<double>::infinity();
  Eigen::MatrixXd alpha = solution.topRows(m);
  L_.template triangularView<Eigen::Lower>().transpose().solveInPlace(alpha);

  using Map = typename MappedField<Dim>::Map;
  Map map = covariance.lengths.cwiseInverse().asDiagonal();
  if (covariance.axes) map *= covariance.axes->transpose();
  const auto basis = std::make_shared<const RadialBasis<Dim>>(kernel_, centers_, Eigen::VectorXd::Ones(1));
  const Box<Dim> box = bounding_box<Dim>(samples.points);
  for (Index c = 0; c < C; ++c) {
    Eigen::VectorXd pi = solution.col(c).tail(p - m);
    PolynomialTail<Dim> tail = trend_.tail(pi);
    tail.coefficients[0] += mean_[c];
    result.components.push_back(std::make_shared<const MappedField<Dim>>(
        std::make_shared<const Expansion<Dim>>(basis, alpha.col(c), std::move(tail), box), map));
  }
  const double freedom = static_cast<double>(samples_) * left * left;
  const Eigen::VectorXd left_out = (left > 0 ? 1 / freedom : 0) * residual.cwiseMax(0);
  if (with_variances) add_variances(solved.misfit / degrees(), left_out, samples, basis, map, result);
  return result;
}

// Samples left out are off by their noise at least, and by it and sigma^2 P^2 about: with the share s of P^2 that is
// so, sigma^2 s (P^2 + lambda / s). `noise`, `left_out`: mean squares times the weights, by component.
template <int Dim>
void CenterEquations<Dim>::add_variances(const Eigen::VectorXd& noise, const Eigen::VectorXd& left_out,
                                         const Samples<Dim>& samples,
                                         const std::shared_ptr<const RadialBasis<Dim>>& basis,
                                         const typename MappedField<Dim>::Map& map, CenterFit<Dim>& result) const {
  constexpr double doubt = 1.25, least_share = 1e-12;  // chosen by hand
  const double nugget = result.covariance.nugget;
  const Eigen::VectorXd weights = weights_of(samples);
  const auto power_for = [&](double lambda) {
    return std::make_shared<const PowerFunction<Dim>>(basis, result.covariance.degree, lambda,
                                                      lambda / nugget * weights);
  };
  double ratio = 0, count = 0;  // of errors left out to noise
  for (Index c = 0; c < noise.size(); ++c) {
    if (!(noise[c] > 0) || !(left_out[c] > 0)) continue;  // a constant
    ratio += left_out[c] / noise[c];
    ++count;
  }
  auto power = power_for(nugget);
  double share = 1, of_noise = 1;
  const double power2 = mean_power2(*power, samples.points);
  if (count > 0 && std::isfinite(power2)) {
    ratio /= count;
    of_noise = std::min(1.0, ratio);
    share = std::clamp((doubt * ratio - of_noise) * nugget / power2, least_share, 1.0);
    if (share < 1 || of_noise < 1) power = power_for(of_noise * nugget / share);
  }
  const Box<Dim> box = bounding_box<Dim>(samples.points);
  for (const double all : noise) {
    result.noise.push_back(std::sqrt(of_noise * all));
    result.variances.push_back(std::make_shared<const MappedField<Dim>>(
        std::make_shared<const KrigingVariance<Dim>>(power, share * all / nugget, box), map));
  }
}

template <int Dim>
Eigen::MatrixXd CenterEquations<Dim>::covariances(const Points<Dim>& x) const {
  const Index m = centers_.cols();
  Eigen::MatrixXd K(m, x.cols());
  parallel_for(x.cols(), 16, [&](Index begin, Index end) {
    Eigen::VectorXd r2(m);
    for (Index i = begin; i < end; ++i) {
      squared_distances<Dim>(centers_.data(), m, x.col(i), r2.data());
      kernel_.values(r2.data(), m, K.col(i).data());
    }
  });
  return K;
}

template <int Dim>
typename CenterEquations<Dim>::Solved CenterEquations<Dim>::solve(double nugget) const {
  const Index m = centers_.cols();
  Solved solved{.factor = A_, .white = b_};
  solved.factor.diagonal().head(m).array() += nugget;
  solved.is_regular = cholesky_in_place(solved.factor);
  if (!solved.is_regular) return solved;
  solve_lower_in_place(solved.factor, solved.white);
  constexpr double rounding = 1e-15;
  solved.misfit = (squares_ - solved.white.colwise().squaredNorm().transpose()).cwiseMax(rounding * squares_);
  solved.is_regular = solved.misfit.maxCoeff() > 0;
  return solved;
}

// What samples around each centre weigh together: to the variance they are one sample there.
template <int Dim>
Eigen::VectorXd CenterEquations<Dim>::weights_of(const Samples<Dim>& samples) const {
  const KdTree<Dim> tree(centers_);
  std::vector<Index> nearest(static_cast<std::size_t>(samples.size()));
  parallel_for(samples.size(), 256, [&](Index begin, Index end) {
    for (Index i = begin; i < end; ++i) {
      double r2 = 0;
      tree.nearest(samples.points.col(i), 1, &nearest[static_cast<std::size_t>(i)], &r2);
    }
  });
  Eigen::VectorXd weights = Eigen::VectorXd::Zero(centers_.cols());
  for (Index i = 0; i < samples.size(); ++i) weights[nearest[static_cast<std::size_t>(i)]] += samples.weight(i);
  return weights;
}

#define CSRBF_INSTANTIATE(Dim) template class CenterEquations<Dim>;
CSRBF_FOR_MANY_DIMS(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
