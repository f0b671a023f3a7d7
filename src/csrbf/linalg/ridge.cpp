#include "csrbf/linalg/ridge.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/linalg/decompositions.hpp"
#include "csrbf/linalg/golden_section.hpp"

#include <Eigen/SVD>

#include <sstream>
#include <string>
#include <vector>

namespace csrbf {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

// The hat matrix in the eigenvectors of its kernel: S = U diag(mu / (mu + lambda)) U^T, the same for every lambda.
// With g = 1 / (mu + lambda) and data t the residual is outside + lambda U (g z), and 1 - S_kk is
// outside_leverage_k + lambda sum_i U_ki^2 g_i: no cancellation for small lambda.
struct Spectrum {
  Eigen::MatrixXd U;                 // N x r, orthonormal columns
  Eigen::VectorXd mu;                // r eigenvalues
  Eigen::MatrixXd z;                 // U^T t
  Eigen::MatrixXd outside;           // t - U z
  Eigen::VectorXd outside_leverage;  // 1 - sum_i U_ki^2
  double smallest_lambda = 0;        // below, mu + lambda is not positive to working precision

  Spectrum(Eigen::MatrixXd vectors, Eigen::VectorXd eigenvalues, const Eigen::MatrixXd& t)
      : U(std::move(vectors)), mu(std::move(eigenvalues)), z(U.transpose() * t) {
    if (complete()) return;
    outside = t - U * z;
    outside_leverage = (1 - U.rowwise().squaredNorm().array()).cwiseMax(0);
  }

  // Whether the columns of U are a basis of all data: then outside is zero, and lambda cancels in all ratios.
  [[nodiscard]] bool complete() const { return U.rows() == U.cols(); }
  [[nodiscard]] Eigen::VectorXd g(double lambda) const { return (mu.array() + lambda).inverse(); }
};

// (t - S t)_k / (1 - S_kk); infinite where a datum alone determines its own fitted value.
Eigen::MatrixXd leave_one_out(const Spectrum& spectrum, double lambda) {
  const Eigen::VectorXd g = spectrum.g(lambda);
  Eigen::MatrixXd errors = spectrum.U * (g.asDiagonal() * spectrum.z);
  Eigen::VectorXd freedom = spectrum.U.cwiseAbs2() * g;
  if (!spectrum.complete()) {
    errors = spectrum.outside + lambda * errors;
    freedom = spectrum.outside_leverage + lambda * freedom;
  }
  const double rounding = spectrum.complete() ? 0 : 1e-14;  // of 1 - S_kk, the difference of two numbers near 1
  for (Index k = 0; k < errors.rows(); ++k) {
    if (freedom[k] > rounding) {
      errors.row(k) /= freedom[k];
    } else {
      errors.row(k).setConstant(infinity);
    }
  }
  return errors;
}

double generalized_cross_validation(const Spectrum& spectrum, double lambda) {
  const auto N = static_cast<double>(spectrum.U.rows());
  const auto components = static_cast<double>(spectrum.z.cols());
  const Eigen::VectorXd g = spectrum.g(lambda);
  double residual = (g.asDiagonal() * spectrum.z).squaredNorm();
  double freedom = g.sum();
  if (!spectrum.complete()) {
    residual = spectrum.outside.squaredNorm() + lambda * lambda * residual;
    freedom = N - static_cast<double>(spectrum.U.cols()) + lambda * freedom;
  }
  return residual / (N * components) / std::pow(freedom / N, 2);
}

double score(const Spectrum& spectrum, double lambda, LambdaCriterion criterion) {
  if (lambda < spectrum.smallest_lambda) return infinity;
  const double value = criterion == LambdaCriterion::generalized_cross_validation
                           ? generalized_cross_validation(spectrum, lambda)
                           : leave_one_out(spectrum, lambda).squaredNorm();
  return std::isnan(value) ? infinity : value;
}

// The lambda0 with the best score: the best of a logarithmic grid, as the score may have several minima, refined
// between its neighbours.
double choose_lambda0(const Spectrum& spectrum, double unit, const RidgeOptions& options) {
  const auto f = [&](double exponent) { return score(spectrum, unit * std::pow(10.0, exponent), options.criterion); };
  const double first = std::log10(options.smallest);
  const double last = std::log10(options.largest);
  constexpr double per_decade = 2.5;  // grid points, chosen by hand: more cost time, fewer may miss a narrow minimum
  const auto intervals = static_cast<int>(std::ceil(per_decade * (last - first)));
  double best = last;
  double smallest = f(last);
  for (int i = intervals - 1; i >= 0; --i) {
    const double exponent = first + (last - first) * i / intervals;
    const double value = f(exponent);
    if (value < smallest) {
      smallest = value;
      best = exponent;
    }
  }
  const double step = (last - first) / intervals;
  constexpr int steps = 18;  // the interval shrinks to 1/6000
  const double refined = golden_section(f, std::max(first, best - step), std::min(last, best + step), steps);
  return std::pow(10.0, f(refined) < smallest ? refined : best);
}

void check(std::string_view function, const Eigen::Ref<const Eigen::MatrixXd>& matrix, std::string_view matrix_name,
           const Eigen::Ref<const Eigen::MatrixXd>& s, const RidgeOptions& options) {
  const auto size = [](const auto& m) { return std::to_string(m.rows()) + " x " + std::to_string(m.cols()); };
  require(matrix.size() > 0, function, matrix_name, size(matrix), "must have at least one row and one column");
  require(s.rows() == matrix.rows() && s.cols() > 0, function, "s", size(s),
          "must have one row per row of " + std::string(matrix_name) + " and at least one column");
  require(matrix.allFinite(), function, matrix_name, "NaN or infinity", "all entries must be finite");
  require(s.allFinite(), function, "s", "NaN or infinity", "all data must be finite; leave out missing data");
  require(options.weights.size() == 0 || options.weights.size() == s.rows(), function, "weights",
          options.weights.size(), "must be empty or hold one weight per datum");
  require(options.weights.allFinite() && (options.weights.array() >= 0).all(), function, "weights",
          "negative or not finite", "must not be negative");
  require(options.weights.size() == 0 || options.weights.maxCoeff() > 0, function, "weights", "all zero",
          "at least one must be positive");
  const double lambda0 = options.lambda0.value_or(0);
  require(lambda0 >= 0 && lambda0 < infinity, function, "lambda0", lambda0,
          "must be finite and not negative; leave it out to have it chosen");
  require(options.smallest > 0, function, "smallest", options.smallest, "must be positive");
  require(options.largest > options.smallest && options.largest < infinity, function, "largest", options.largest,
          "must be finite and larger than smallest");
}

Eigen::VectorXd weights_of(const RidgeOptions& options, Index count) {
  return options.weights.size() > 0 ? options.weights : Eigen::VectorXd::Ones(count);
}

// Everything except coefficients and fitted values, for the data of the spectrum and their weights.
RidgeFit assess(const Spectrum& spectrum, const Eigen::VectorXd& weights, double unit, const RidgeOptions& options) {
  RidgeFit fit;
  fit.lambda0 = options.lambda0 ? *options.lambda0 : choose_lambda0(spectrum, unit, options);
  fit.lambda = unit * fit.lambda0;
  const Eigen::MatrixXd weighted_errors = leave_one_out(spectrum, fit.lambda);
  fit.leave_one_out = weights.cwiseSqrt().cwiseInverse().asDiagonal() * weighted_errors;
  fit.gcv = generalized_cross_validation(spectrum, fit.lambda);
  fit.cross_validation_rmse =
      weighted_errors.norm() / std::sqrt(weights.sum() * static_cast<double>(weighted_errors.cols()));
  const Eigen::VectorXd shrunk = spectrum.mu.array() * spectrum.g(fit.lambda).array();
  fit.hat_diagonal = (spectrum.U.cwiseAbs2() * shrunk).cwiseMax(0).cwiseMin(1);
  return fit;
}

// F = U diag(sigma) V^T, through the triangular factor when F is tall.
struct Svd {
  Eigen::MatrixXd U;
  Eigen::VectorXd sigma;
  Eigen::MatrixXd V;

  explicit Svd(const Eigen::MatrixXd& F) {
    constexpr unsigned thin = Eigen::ComputeThinU | Eigen::ComputeThinV;
    if (F.rows() <= F.cols()) {
      take(Eigen::BDCSVD<Eigen::MatrixXd>(F, thin));
      return;
    }
    const Eigen::HouseholderQR<Eigen::MatrixXd> qr(F);
    const Eigen::MatrixXd R = qr.matrixQR().topRows(F.cols()).triangularView<Eigen::Upper>();
    take(Eigen::BDCSVD<Eigen::MatrixXd>(R, thin));
    Eigen::MatrixXd padded = Eigen::MatrixXd::Zero(F.rows(), F.cols());
    padded.topRows(F.cols()) = U;
    U = qr.householderQ() * padded;
  }

  void take(const Eigen::BDCSVD<Eigen::MatrixXd>& svd) {
    U = svd.matrixU();
    sigma = svd.singularValues();
    V = svd.matrixV();
  }
};

}  // namespace

RidgeFit ridge(const Eigen::Ref<const Eigen::MatrixXd>& B, const Eigen::Ref<const Eigen::MatrixXd>& s,
               const RidgeOptions& options) {
  check("ridge", B, "B", s, options);
  const Eigen::VectorXd all_weights = weights_of(options, B.rows());
  std::vector<Index> used;
  for (Index k = 0; k < B.rows(); ++k)
    if (all_weights[k] > 0) used.push_back(k);
  const Eigen::VectorXd weights = all_weights(used);
  const Eigen::VectorXd root = weights.cwiseSqrt();
  const Svd svd(root.asDiagonal() * B(used, Eigen::all));
  const Eigen::VectorXd& sigma = svd.sigma;

  const double rounding = static_cast<double>(std::max(B.rows(), B.cols())) * 1e-16;
  const Index rank = (sigma.array() > rounding * sigma[0]).count();
  if (options.lambda0 == 0.0 && rank < B.cols()) {
    throw SolverFailure("ridge: the " + std::to_string(B.cols()) + " columns of B have only rank " +
                        std::to_string(rank) + ": give lambda0 > 0, or leave out columns without data");
  }

  const Spectrum spectrum(svd.U, sigma.cwiseAbs2(), root.asDiagonal() * s(used, Eigen::all));
  const double unit = weights.sum() / static_cast<double>(B.cols());
  const RidgeFit used_fit = assess(spectrum, weights, unit, options);
  RidgeFit fit = used_fit;
  fit.coefficients = svd.V * (sigma.cwiseProduct(spectrum.g(fit.lambda)).asDiagonal() * spectrum.z);
  fit.fitted = B * fit.coefficients;
  fit.leave_one_out = s - fit.fitted;
  fit.hat_diagonal = Eigen::VectorXd::Zero(B.rows());
  fit.leave_one_out(used, Eigen::all) = used_fit.leave_one_out;
  fit.hat_diagonal(used) = used_fit.hat_diagonal;
  return fit;
}

RidgeFit kernel_ridge(const Eigen::Ref<const Eigen::MatrixXd>& A, const Eigen::Ref<const Eigen::MatrixXd>& s,
                      const RidgeOptions& options) {
  check("kernel_ridge", A, "A", s, options);
  require(A.rows() == A.cols(), "kernel_ridge", "A", A.cols(), "must have as many columns as rows");
  const Eigen::VectorXd weights = weights_of(options, A.rows());
  require(weights.minCoeff() > 0, "kernel_ridge", "weights", weights.minCoeff(),
          "must be positive; leave such data out");
  const Eigen::VectorXd root = weights.cwiseSqrt();
  const Eigen::MatrixXd full = A.selfadjointView<Eigen::Lower>();

  // (D A D + lambda) (D^-1 c) = D s with D = W^(1/2).
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(
      Eigen::MatrixXd(root.asDiagonal() * full * root.asDiagonal()));
  Spectrum spectrum(eigen.eigenvectors(), eigen.eigenvalues(), root.asDiagonal() * s);
  const Eigen::VectorXd& mu = spectrum.mu;
  const double rounding = static_cast<double>(A.rows()) * 1e-16 * mu.cwiseAbs().maxCoeff();
  spectrum.smallest_lambda = rounding - mu.minCoeff();
  const double unit = full.trace() / static_cast<double>(A.rows());
  RidgeFit fit = assess(spectrum, weights, unit, options);
  if (!(fit.lambda >= spectrum.smallest_lambda)) {
    std::ostringstream message;
    message << "kernel_ridge: A + lambda W^-1 is not positive definite, its smallest eigenvalue is "
            << mu.minCoeff() + fit.lambda << ": increase lambda0 = " << fit.lambda0
            << ", merge coincident points, or use a kernel that is positive definite in this dimension";
    throw SolverFailure(message.str());
  }
  fit.coefficients = root.asDiagonal() * (spectrum.U * (spectrum.g(fit.lambda).asDiagonal() * spectrum.z));
  fit.fitted = full * fit.coefficients;
  return fit;
}

}  // namespace csrbf
