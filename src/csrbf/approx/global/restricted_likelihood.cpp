#include "csrbf/approx/global/restricted_likelihood.hpp"

#include "csrbf/linalg/decompositions.hpp"
#include "csrbf/spatial/squared_distances.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace csrbf {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double tiny = 1e-30;      // squared residual of a component without any variation
constexpr Index per_unknown = 4;    // samples for every unknown of a trend, at least; chosen by hand
constexpr double dependent = 1e-6;  // share of a column of the trend outside the span of the others
constexpr Index block = 48;         // columns

// Adds C (L L^T)^-1 to the lower half of P, by blocks of what is not 0 in L^-1: three times as fast.
void add_inverse(const Eigen::MatrixXd& L, double C, Eigen::MatrixXd& P) {
  const Index n = L.rows();
  Eigen::MatrixXd inverse = Eigen::MatrixXd::Zero(n, n);
  for (Index k = 0; k < n; k += block) {
    const Index rest = n - k, width = std::min(block, rest);
    auto columns = inverse.block(k, k, rest, width);
    columns.topRows(width).setIdentity();
    L.bottomRightCorner(rest, rest).triangularView<Eigen::Lower>().solveInPlace(columns);
  }
  for (Index k = 0; k < n; k += block) {
    const Index rest = n - k, width = std::min(block, rest);
    P.block(k, 0, width, k + width).noalias() +=
        C * inverse.block(k, k, rest, width).transpose() * inverse.block(k, 0, rest, k + width);
  }
}

// Subtracts the squared differences of point j to those after it, times `pairs`, along each axis.
template <int Dim>
void subtract_slopes(const double* x, const Eigen::VectorXd& pairs, Eigen::VectorXd& slopes) {
  Point<Dim> sums = slopes;
  for (Index i = 0; i < pairs.size(); ++i)
    for (int a = 0; a < Dim; ++a) {
      const double difference = x[Dim * (i + 1) + a] - x[a];
      sums[a] -= difference * difference * pairs[i];
    }
  slopes = sums;
}

void subtract_slopes(const Eigen::MatrixXd& points, Index j, const Eigen::VectorXd& pairs, Eigen::VectorXd& slopes) {
  const Index dimension = points.rows();
  const double* x = points.data() + dimension * j;
  if (dimension == 1) return subtract_slopes<1>(x, pairs, slopes);
  if (dimension == 2) return subtract_slopes<2>(x, pairs, slopes);
  if (dimension == 3) return subtract_slopes<3>(x, pairs, slopes);
  for (Index i = 0; i < pairs.size(); ++i)
    for (Index a = 0; a < dimension; ++a) {
      const double difference = x[dimension * (i + 1) + a] - x[a];
      slopes[a] -= difference * difference * pairs[i];
    }
}

}  // namespace

// With K = L L^T, white residuals W = L^-1 (s - G beta) and Q an orthonormal basis of L^-1 G.
struct RestrictedLikelihood::Solved {
  Eigen::MatrixXd scaled, K, slopes, white, Q;
  Eigen::VectorXd sigma2;
  double value = infinity;
};

RestrictedLikelihood::RestrictedLikelihood(Samples<Eigen::Dynamic> samples, Replicates replicates)
    : samples_(std::move(samples)), replicates_(std::move(replicates)) {
  const Index n = samples_.size();
  inverse_weights_ = samples_.all_weights().cwiseInverse();
  std::vector<Index> axes;
  for (Index a = 0; a < samples_.points.rows(); ++a)
    if (samples_.points.row(a).maxCoeff() > samples_.points.row(a).minCoeff()) axes.push_back(a);
  trend_.resize(n, 1 + std::ssize(axes));
  trend_ << Eigen::VectorXd::Ones(n), samples_.points(axes, Eigen::all).transpose();
  for (Index c = 1; c < trend_.cols(); ++c) trend_.col(c).array() -= trend_.col(c).mean();
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr;
  qr.setThreshold(dependent);
  qr.compute(trend_);
  if (!axes.empty() && n >= per_unknown * trend_.cols() && qr.rank() == trend_.cols()) largest_degree_ = 1;
  log_trend_[0] = std::log(static_cast<double>(n));
  log_trend_[1] = 2 * qr.matrixQR().diagonal().array().abs().log().sum();
}

bool RestrictedLikelihood::solve(const Kernel& kernel, int degree, const Parameters& at, bool derivatives,
                                 Solved& solved) const {
  const Index n = size(), C = samples_.components();
  const double nugget = std::exp(at.log_nugget);
  Eigen::VectorXd scale = at.log_lengths;
  for (double& length : scale) length = std::exp(-length);
  solved.scaled = scale.asDiagonal() * samples_.points;
  solved.K.resize(n, n);
  if (derivatives) solved.slopes.resize(n, n);
  Eigen::VectorXd r2(n);
  for (Index j = 0; j < n; ++j) {
    const Index rest = n - j;
    squared_distances(solved.scaled, j, solved.scaled.col(j).data(), r2.data());
    if (derivatives)
      kernel.gradients(r2.data(), rest, &solved.K(j, j), &solved.slopes(j, j));
    else
      kernel.values(r2.data(), rest, &solved.K(j, j));
  }
  solved.K.diagonal() += nugget * inverse_weights_;
  const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> llt(solved.K);  // in place
  if (llt.info() != Eigen::Success) return false;
  const Index q = degree == 1 ? trend_.cols() : 1;
  Eigen::MatrixXd G = trend_.leftCols(q);
  solved.white = samples_.values;
  solve_lower(llt, G);
  solve_lower(llt, solved.white);
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(G);
  solved.Q = thin_q(qr, q);
  solved.white -= solved.Q * (solved.Q.transpose() * solved.white);
  const auto extra = static_cast<double>(replicates_.count);
  const double degrees = static_cast<double>(n - q) + extra;
  solved.sigma2 = solved.white.colwise().squaredNorm().transpose();
  if (replicates_.count > 0) solved.sigma2 += replicates_.squares / nugget;
  solved.sigma2 = (solved.sigma2 / degrees).cwiseMax(tiny);
  const double log_determinant = 2 * solved.K.diagonal().array().log().sum() +
                                 2 * qr.matrixQR().diagonal().array().abs().log().sum() - log_trend_[degree] +
                                 extra * at.log_nugget;
  solved.value = .5 * (degrees * solved.sigma2.array().log().sum() + static_cast<double>(C) * log_determinant);
  return std::isfinite(solved.value);
}

double RestrictedLikelihood::value(const Kernel& kernel, int degree, const Parameters& at) const {
  Solved solved;
  return solve(kernel, degree, at, false, solved) ? solved.value : infinity;
}

Eigen::MatrixXd RestrictedLikelihood::projected_inverse(const Solved& solved, double C) const {
  Eigen::MatrixXd P = Eigen::MatrixXd::Zero(size(), size());
  add_inverse(solved.K, C, P);
  const Eigen::MatrixXd B = solved.K.transpose().triangularView<Eigen::Upper>().solve(solved.Q);
  P.selfadjointView<Eigen::Lower>().rankUpdate(B, -C);
  return P;
}

std::optional<RestrictedLikelihood::LeftOut> RestrictedLikelihood::left_out(const Kernel& kernel, int degree,
                                                                            const Parameters& at) const {
  Solved solved;
  if (!solve(kernel, degree, at, false, solved)) return std::nullopt;
  const Eigen::VectorXd inverse = projected_inverse(solved, 1).diagonal().cwiseInverse();
  const Eigen::MatrixXd alpha = solved.K.transpose().triangularView<Eigen::Upper>().solve(solved.white);
  return LeftOut{inverse.asDiagonal() * alpha, inverse * solved.sigma2.transpose(), solved.sigma2};
}

// With P = K^-1 - K^-1 G (G^T K^-1 G)^-1 G^T K^-1 and alpha = P s, the derivative by a parameter t is half the trace of
// (C P - sum_c alpha_c alpha_c^T / sigma_c^2) dK/dt, and samples left out are missed by alpha_i / P_ii (Dubrule 1983).
RestrictedLikelihood::Value RestrictedLikelihood::with_derivatives(const Kernel& kernel, int degree,
                                                                   const Parameters& at) const {
  Solved solved;
  if (!solve(kernel, degree, at, true, solved))
    return {infinity, Eigen::VectorXd::Zero(samples_.points.rows()), 0, infinity};
  const Index n = size();
  const auto C = static_cast<double>(samples_.components());
  const auto upper = solved.K.transpose().triangularView<Eigen::Upper>();
  Eigen::MatrixXd P = projected_inverse(solved, C);
  const Eigen::MatrixXd alpha = upper.solve(solved.white);
  const Eigen::VectorXd weights = inverse_weights_.cwiseInverse();
  const Eigen::MatrixXd errors = (P.diagonal() / C).cwiseInverse().asDiagonal() * alpha;
  Value result{solved.value, Eigen::VectorXd::Zero(samples_.points.rows())};
  result.leave_one_out = std::sqrt((weights.asDiagonal() * errors.cwiseAbs2()).sum() /
                                   (weights.sum() * static_cast<double>(alpha.cols())));
  const Eigen::ArrayXXd squares = ((P.diagonal() / C).asDiagonal() * errors.cwiseAbs2()).array();
  result.kurtosis = squares.square().mean() / std::pow(squares.mean(), 2);
  P.selfadjointView<Eigen::Lower>().rankUpdate(alpha * solved.sigma2.cwiseSqrt().cwiseInverse().asDiagonal(), -1.0);
  // Half a trace is the sum over pairs; a pair's covariance grows with the logarithm of a length by -g z_a^2.
  for (Index j = 0; j + 1 < n; ++j) {
    const Eigen::VectorXd pairs = P.col(j).tail(n - j - 1).cwiseProduct(solved.slopes.col(j).tail(n - j - 1));
    subtract_slopes(solved.scaled, j, pairs, result.d_log_lengths);
  }
  const double nugget = std::exp(at.log_nugget);
  result.d_log_nugget = .5 * nugget * P.diagonal().dot(inverse_weights_);
  if (replicates_.count > 0)
    result.d_log_nugget += .5 * (C * static_cast<double>(replicates_.count) -
                                 (replicates_.squares.array() / solved.sigma2.array()).sum() / nugget);
  return result;
}

bool RestrictedLikelihood::leaves_noise(const Kernel& kernel, int degree, const Parameters& at) const {
  constexpr double deviations = 2;  // of the kurtosis of as many normal errors; chosen by hand
  return with_derivatives(kernel, degree, at).kurtosis < 3 + deviations * std::sqrt(24 / static_cast<double>(size()));
}

RestrictedLikelihood likelihood_of(const SampleView& samples, const Replicates& replicates,
                                   const std::vector<Index>& chosen, const Eigen::VectorXd& origin,
                                   const Eigen::VectorXd& units) {
  std::vector<Index> varied;
  for (Index c = 0; c < samples.components(); ++c)
    if ((samples.values(chosen, c).array() != samples.values(chosen[0], c)).any()) varied.push_back(c);
  if (varied.empty()) varied.push_back(0);
  Samples<Eigen::Dynamic> some{samples.points(Eigen::all, chosen), samples.values(chosen, varied), {}};
  some.points = units.cwiseInverse().asDiagonal() * (some.points.colwise() - origin);
  if (samples.weights.size() > 0) some.weights = samples.weights(chosen);
  Replicates scaled = replicates;
  if (scaled.count > 0) scaled.squares = replicates.squares(varied).eval();
  for (Index c = 0; c < some.components(); ++c) {
    auto column = some.values.col(c);
    column.array() -= column.mean();
    const double size = column.stableNorm() / std::sqrt(static_cast<double>(column.size()));
    if (!(size > 0)) continue;
    column /= size;
    if (scaled.count > 0) scaled.squares[c] = scaled.squares[c] / size / size;
  }
  if (scaled.count > 0 && !scaled.squares.allFinite()) scaled.count = 0;
  return {std::move(some), std::move(scaled)};
}

}  // namespace csrbf
