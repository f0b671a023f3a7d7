#include "csrbf/approx/global/kriging_variance.hpp"

#include "csrbf/approx/basis/polynomial_block.hpp"
#include "csrbf/core/percentile.hpp"
#include "csrbf/linalg/decompositions.hpp"
#include "csrbf/linalg/dense_cholesky.hpp"
#include "csrbf/spatial/chosen_points.hpp"
#include "csrbf/spatial/farthest_points.hpp"
#include "csrbf/spatial/kd_tree.hpp"
#include "csrbf/spatial/squared_distances.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace csrbf {
namespace {

// Chosen by hand.
constexpr Index most_dense = 4000;  // centres in one system
constexpr Index nearest = 64;       // beyond: centres near the point ...
constexpr Index covering = 64;      // ... and spread over all
constexpr Index some = 64;          // samples that tell what is usual
constexpr double share_of_usual = 0.9;

}  // namespace

// With G = [Y Z] (R; 0) the predictor of the value at x has the weights w = w0 + Z u, where w0 = Y R^-T g(x) makes it
// unbiased and u minimises its variance phi(0) - 2 w^T k(x) + w^T K w, K = A + lambda W^-1: a difference of a part that
// depends on w0 only and the gain |L^-1 Z^T (k - K w0)|^2, with L the Cholesky factor of Z^T K Z.
template <int Dim>
struct PowerFunction<Dim>::System {
  PolynomialBlock<Dim> block;
  Polynomials<Dim> polynomials;
  Index size, constraints;
  Eigen::HouseholderQR<Eigen::MatrixXd> qr;
  Eigen::MatrixXd Y, KY, YKY;
  Eigen::MatrixXd L;  // empty without any u

  explicit System(const PowerFunction& power);

  [[nodiscard]] Eigen::MatrixXd unbiased(const PointsRef<Dim>& x) const;
};

template <int Dim>
PowerFunction<Dim>::System::System(const PowerFunction& power)
    : block(polynomial_block<Dim>(power.basis_->centers(), power.degree_, RankDeficiency::reduce)),
      polynomials(power.degree_),
      size(power.basis_->size()),
      constraints(block.G.cols()) {
  const Index n = size, r = constraints;
  const auto matrix = [&](double nugget) {
    Eigen::MatrixXd K = power.basis_->dense_matrix(power.basis_->centers());
    if (power.weights_.size() > 0)
      K.diagonal() += (power.smoothing_ + nugget) * power.weights_.cwiseInverse();
    else
      K.diagonal().array() += power.smoothing_ + nugget;
    return K;
  };
  const auto reduce = [&] {
    if (r == 0) return;
    apply_q_transposed(qr, L);
    apply_q_on_the_right(qr, L);
    L = L.bottomRightCorner(n - r, n - r).eval();
  };
  L = matrix(0);
  const double largest = L.cwiseAbs().maxCoeff();
  if (r > 0) {
    qr.compute(block.G);
    Y = thin_q(qr, r);
    KY = L * Y;
    YKY = Y.transpose() * KY;
  }
  reduce();
  // It has been solved before, but may be singular to rounding: the variance is then that of a little more noise. Once
  // that is above the sum of any row the matrix is positive definite.
  constexpr double epsilon = std::numeric_limits<double>::epsilon();
  const double heaviest = power.weights_.size() > 0 ? power.weights_.maxCoeff() : 1;
  const double most = 10 * static_cast<double>(n) * largest * heaviest;
  for (double nugget = epsilon * largest; !cholesky_in_place(L) && nugget < most; nugget *= 10) {
    L = matrix(nugget);
    reduce();
  }
}

// R^-T g(x) of each point, so that w0 = Y of it.
template <int Dim>
Eigen::MatrixXd PowerFunction<Dim>::System::unbiased(const PointsRef<Dim>& x) const {
  const Points<Dim> local = in_units<Dim>(x, block.frame.origin, block.frame.scale);
  Eigen::MatrixXd rows(x.cols(), polynomials.size());
  polynomials.rows(local, rows.data());
  Eigen::MatrixXd w = (rows * block.monomials).transpose();
  qr.matrixQR().topRows(constraints).template triangularView<Eigen::Upper>().adjoint().solveInPlace(w);
  return w;
}

template <int Dim>
PowerFunction<Dim>::PowerFunction(std::shared_ptr<const RadialBasis<Dim>> basis, int degree, double smoothing,
                                  Eigen::VectorXd weights)
    : basis_(std::move(basis)), degree_(degree), smoothing_(smoothing), weights_(std::move(weights)) {
  require(weights_.size() == 0 || weights_.size() == basis_->size(), "PowerFunction", "weights", weights_.size(),
          "there must be one per centre, or none");
}

template <int Dim>
PowerFunction<Dim>::~PowerFunction() = default;

template <int Dim>
struct PowerFunction<Dim>::Neighborhoods {
  Points<Dim> mapped;  // distances between which are those of the basis
  KdTree<Dim> tree;
  std::vector<Index> spread;
  PolynomialBlock<Dim> block;
  Polynomials<Dim> polynomials;

  explicit Neighborhoods(const PowerFunction& power)
      : mapped(power.basis_->metric().transforms.empty()
                   ? power.basis_->centers()
                   : Points<Dim>(power.basis_->metric().transforms.front() * power.basis_->centers())),
        tree(mapped),
        spread(farthest_points<Dim>(mapped, covering).indices),
        block(polynomial_block<Dim>(power.basis_->centers(), power.degree_, RankDeficiency::reduce)),
        polynomials(power.degree_) {}
};

template <int Dim>
Eigen::VectorXd PowerFunction<Dim>::evaluate(const PointsRef<Dim>& x) const {
  return basis_->size() > most_dense ? evaluate_nearest(x) : evaluate_all(x);
}

// With K w + G mu = k and G^T w = g the variance is phi(0) + lambda - k^T w - g^T mu.
template <int Dim>
Eigen::VectorXd PowerFunction<Dim>::evaluate_nearest(const PointsRef<Dim>& x) const {
  once_.call([this] { neighborhoods_ = std::make_unique<const Neighborhoods>(*this); });
  const Neighborhoods& all = *neighborhoods_;
  const Kernel& kernel = basis_->kernel();
  const Index r = all.block.G.cols();
  const double column = std::sqrt(static_cast<double>(basis_->size()));  // G has columns of unit norm
  const Points<Dim> local = in_units<Dim>(x, all.block.frame.origin, all.block.frame.scale);
  Eigen::MatrixXd rows(x.cols(), all.polynomials.size());
  all.polynomials.rows(local, rows.data());
  rows = (column * rows * all.block.monomials).eval();
  Eigen::VectorXd result(x.cols());
  std::vector<double> r2(nearest);
  for (Index at = 0; at < x.cols(); ++at) {
    std::vector<Index> ids(nearest);
    Point<Dim> p = x.col(at);
    if (!basis_->metric().transforms.empty()) p = basis_->metric().transforms.front() * p;
    if (!p.allFinite()) {
      result[at] = std::numeric_limits<double>::quiet_NaN();
      continue;
    }
    ids.resize(all.tree.nearest(p, nearest, ids.data(), r2.data()));
    ids.insert(ids.end(), all.spread.begin(), all.spread.end());
    std::sort(ids.begin(), ids.end());
    ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
    const Index m = std::ssize(ids);
    Points<Dim> points(Dim, m + 1);
    for (Index i = 0; i < m; ++i) points.col(i) = all.mapped.col(ids[i]);
    points.col(m) = p;
    Eigen::MatrixXd distances(m + 1, m + 1), K(m + 1, m + 1);
    for (Index j = 0; j <= m; ++j) squared_distances<Dim>(points.data(), m + 1, points.col(j), distances.col(j).data());
    distances /= basis_->support(0) * basis_->support(0);
    kernel.values(distances.data(), distances.size(), K.data());
    const double scale = K.cwiseAbs().maxCoeff();
    Eigen::MatrixXd system = Eigen::MatrixXd::Zero(m + r, m + r);
    Eigen::VectorXd right(m + r);
    system.topLeftCorner(m, m) = K.topLeftCorner(m, m) / scale;
    right.head(m) = K.col(m).head(m) / scale;
    for (Index i = 0; i < m; ++i) {
      system(i, i) += smoothing_ / (weights_.size() > 0 ? weights_[ids[i]] : 1) / scale;
      system.block(i, m, 1, r) = column * all.block.G.row(ids[i]);
    }
    system.bottomLeftCorner(r, m) = system.topRightCorner(m, r).transpose();
    right.tail(r) = rows.row(at).transpose();
    const Eigen::VectorXd solution = solve_by_lu(system, right);
    result[at] = std::max(0., kernel.value(0) + smoothing_ - scale * solution.dot(right));
  }
  return result;
}

template <int Dim>
const typename PowerFunction<Dim>::System& PowerFunction<Dim>::system() const {
  once_.call([this] { system_ = std::make_unique<const System>(*this); });
  return *system_;
}

// Without sample i, P^2 + lambda / w_i is the inverse of element (i, i) of Z (Z^T K Z)^-1 Z^T.
template <int Dim>
double PowerFunction<Dim>::usual() const {
  once_usual_.call([this] {
    const System& s = system();
    const Index n = s.size, r = s.constraints, count = std::min(n, some);
    // Less is rounding, or is lost in the noise.
    constexpr double epsilon = std::numeric_limits<double>::epsilon();
    usual_ = std::max(smoothing_, static_cast<double>(n) * epsilon * std::abs(basis_->kernel().value(0)));
    if (r >= n) return;
    Eigen::MatrixXd units = Eigen::MatrixXd::Zero(n, count);
    for (Index k = 0; k < count; ++k) units((2 * k + 1) * n / (2 * count), k) = 1;
    if (r > 0) apply_q_transposed(s.qr, units);
    solve_lower_in_place(s.L, units.bottomRows(n - r));
    std::vector<double> without(static_cast<std::size_t>(count));
    for (Index k = 0; k < count; ++k) {
      const double weight = weights_.size() > 0 ? weights_[(2 * k + 1) * n / (2 * count)] : 1;
      without[static_cast<std::size_t>(k)] =
          std::max(0.0, 1 / units.col(k).tail(n - r).squaredNorm() - smoothing_ / weight);
    }
    usual_ = std::max(percentile(without, share_of_usual), usual_);
  });
  return usual_;
}

template <int Dim>
Eigen::VectorXd PowerFunction<Dim>::evaluate_all(const PointsRef<Dim>& x) const {
  const System& s = system();
  const Index n = s.size, r = s.constraints;
  Eigen::MatrixXd k = basis_->dense_matrix(x).transpose();
  Eigen::VectorXd value = Eigen::VectorXd::Constant(x.cols(), basis_->kernel().value(0) + smoothing_);
  if (r > 0) {
    const Eigen::MatrixXd w = s.unbiased(x);
    value += w.cwiseProduct(s.YKY * w - 2 * s.Y.transpose() * k).colwise().sum().transpose();
    k -= s.KY * w;
    apply_q_transposed(s.qr, k);
  }
  if (r < n) {
    solve_lower_in_place(s.L, k.bottomRows(n - r));
    value -= k.bottomRows(n - r).colwise().squaredNorm().transpose();
  }
  return value.unaryExpr([](double v) { return v < 0 ? 0 : v; });  // keeps NaN
}

template <int Dim>
void KrigingVariance<Dim>::evaluate_block(const PointsRef<Dim>& x, const JetBlock& out) const {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  Eigen::Map<Eigen::VectorXd> value(out.value, x.cols());
  value = power_->evaluate(x);
  if (growth_.factor > 1 && power_->basis()->size() <= most_dense) {
    const double lambda = power_->smoothing(), usual = power_->usual();
    const double exponent = std::log(growth_.factor) / std::log(growth_.distance);
    for (double& v : value)
      if (const double power2 = v - lambda; power2 > usual)  // NaN stays
        v = lambda + power2 * std::min(growth_.factor, std::pow(power2 / usual, exponent));
  }
  for (double& v : value)
    if (v < growth_.least) v = growth_.least;
  value *= sigma2_;
  if (out.gradient != nullptr) std::fill_n(out.gradient, Dim * x.cols(), nan);
  if (out.hessian != nullptr) std::fill_n(out.hessian, symmetric_size<Dim> * x.cols(), nan);
}

#define CSRBF_INSTANTIATE(Dim)       \
  template class PowerFunction<Dim>; \
  template class KrigingVariance<Dim>;
CSRBF_FOR_MANY_DIMS(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
