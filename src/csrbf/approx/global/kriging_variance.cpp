#include "csrbf/approx/global/kriging_variance.hpp"

#include "csrbf/approx/basis/polynomial_block.hpp"

#include <Eigen/Cholesky>
#include <Eigen/QR>

#include <algorithm>
#include <limits>

namespace csrbf {

// With G = [Y Z] (R; 0) the predictor of the value at x has the weights w = w0 + Z u, where w0 = Y R^-T g(x) makes it
// unbiased and u minimises its variance phi(0) - 2 w^T k(x) + w^T K w, K = A + lambda W^-1: a difference of a part that
// depends on w0 only and the gain |L^-1 Z^T (k - K w0)|^2, with L the Cholesky factor of Z^T K Z.
template <int Dim>
struct PowerFunction<Dim>::System {
  PolynomialBlock<Dim> block;
  Polynomials<Dim> polynomials;
  Eigen::HouseholderQR<Eigen::MatrixXd> qr;
  Eigen::MatrixXd K;
  Eigen::LLT<Eigen::MatrixXd> cholesky;

  explicit System(const PowerFunction& power);

  [[nodiscard]] Index constraints() const { return block.G.cols(); }
  [[nodiscard]] Eigen::MatrixXd unbiased(const PointsRef<Dim>& x) const;
};

template <int Dim>
PowerFunction<Dim>::System::System(const PowerFunction& power)
    : block(polynomial_block<Dim>(power.basis_->centers(), power.degree_, RankDeficiency::reduce)),
      polynomials(power.degree_) {
  K = power.basis_->dense_matrix(power.basis_->centers());
  const Index n = K.rows(), r = constraints();
  if (power.weights_.size() > 0)
    K.diagonal() += power.smoothing_ * power.weights_.cwiseInverse();
  else
    K.diagonal().array() += power.smoothing_;
  if (r == 0) {
    cholesky.compute(K);
    return;
  }
  qr.compute(block.G);
  if (r == n) return;
  Eigen::MatrixXd rotated = K;
  rotated.applyOnTheLeft(qr.householderQ().transpose());
  rotated.applyOnTheRight(qr.householderQ());
  cholesky.compute(rotated.bottomRightCorner(n - r, n - r));
}

// w0 of each point, n x m.
template <int Dim>
Eigen::MatrixXd PowerFunction<Dim>::System::unbiased(const PointsRef<Dim>& x) const {
  const Index n = K.rows(), r = constraints(), m = x.cols();
  const Points<Dim> local = (x.colwise() - block.frame.origin) / block.frame.scale;
  Eigen::MatrixXd rows(m, polynomials.size());
  polynomials.rows(local, rows.data());
  Eigen::MatrixXd w = Eigen::MatrixXd::Zero(n, m);
  w.topRows(r) = (rows * block.monomials).transpose();
  qr.matrixQR().topLeftCorner(r, r).template triangularView<Eigen::Upper>().adjoint().solveInPlace(w.topRows(r));
  w.applyOnTheLeft(qr.householderQ());
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
const typename PowerFunction<Dim>::System& PowerFunction<Dim>::system() const {
  std::call_once(once_, [this] { system_ = std::make_unique<const System>(*this); });
  return *system_;
}

template <int Dim>
Eigen::VectorXd PowerFunction<Dim>::evaluate(const PointsRef<Dim>& x) const {
  const System& s = system();
  const Index n = s.K.rows(), r = s.constraints();
  Eigen::MatrixXd k = basis_->dense_matrix(x).transpose();
  Eigen::VectorXd value = Eigen::VectorXd::Constant(x.cols(), basis_->kernel().value(0) + smoothing_);
  if (r > 0) {
    const Eigen::MatrixXd w = s.unbiased(x);
    const Eigen::MatrixXd Kw = s.K * w;
    value += (w.cwiseProduct(Kw - 2 * k)).colwise().sum().transpose();
    k -= Kw;
    k.applyOnTheLeft(s.qr.householderQ().transpose());
  }
  if (r < n) {
    Eigen::MatrixXd gain = k.bottomRows(n - r);
    s.cholesky.matrixL().solveInPlace(gain);
    value -= gain.colwise().squaredNorm().transpose();
  }
  return value.unaryExpr([](double v) { return v < 0 ? 0 : v; });  // keeps NaN
}

template <int Dim>
void KrigingVariance<Dim>::evaluate_block(const PointsRef<Dim>& x, const JetBlock& out) const {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  Eigen::Map<Eigen::VectorXd>(out.value, x.cols()) = sigma2_ * power_->evaluate(x);
  if (out.gradient != nullptr) std::fill_n(out.gradient, Dim * x.cols(), nan);
  if (out.hessian != nullptr) std::fill_n(out.hessian, symmetric_size<Dim> * x.cols(), nan);
}

#define CSRBF_INSTANTIATE(Dim)       \
  template class PowerFunction<Dim>; \
  template class KrigingVariance<Dim>;
CSRBF_FOR_EACH_DIM(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
