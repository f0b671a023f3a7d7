#include "csrbf/linalg/saddle.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/core/interruption.hpp"
#include "csrbf/linalg/decompositions.hpp"
#include "csrbf/linalg/dense_cholesky.hpp"
#include "csrbf/linalg/golden_section.hpp"

#include <sstream>
#include <string>
#include <utility>

namespace csrbf {
namespace {

using Matrix = Eigen::MatrixXd;
using MatrixRef = Eigen::Ref<const Eigen::MatrixXd>;

constexpr double unbounded = std::numeric_limits<double>::infinity();

std::string size_of(const MatrixRef& m) {
  return std::to_string(m.rows()) + " x " + std::to_string(m.cols());
}

void check_saddle(std::string_view function, const MatrixRef& A, const MatrixRef& G, const MatrixRef& s,
                  const Eigen::VectorXd& weights) {
  const Index n = A.rows();
  require(n > 0 && A.cols() == n, function, "A", size_of(A), "must be square and not empty");
  require(G.rows() == n || G.size() == 0, function, "G", size_of(G), "must have as many rows as A");
  require(G.cols() <= n, function, "G", size_of(G),
          "the polynomial has more coefficients than there are points; lower its degree or add points");
  require(s.rows() == n && s.cols() > 0, function, "s", size_of(s), "must have as many rows as A and a column");
  require(s.allFinite(), function, "s", "NaN or infinity", "all data must be finite; leave out missing data");
  require(A.allFinite() && G.allFinite(), function, "A and G", "NaN or infinity", "all entries must be finite");
  require(weights.size() == 0 || weights.size() == n, function, "weights", weights.size(),
          "must be empty or hold one weight per datum");
  require(weights.size() == 0 || (weights.minCoeff() > 0 && weights.allFinite()), function, "weights",
          weights.size() == 0 ? 1.0 : weights.minCoeff(), "must be positive and finite; leave such data out");
}

// The system scaled by the square roots of the weights, so that D = I, and reduced to the null space of G^T: A := Z^T A
// Z, with the orthogonal matrix [Y Z] of the QR decomposition G P = Y R.
class Reduced {
 public:
  Reduced(std::string_view function, const MatrixRef& A, const MatrixRef& G, const Eigen::VectorXd& weights)
      : n_(A.rows()), Q_(G.size() == 0 ? 0 : G.cols()), root_(Eigen::VectorXd::Ones(n_)) {
    if (weights.size() > 0) root_ = (weights / weights.maxCoeff()).cwiseSqrt();
    unit_ = weights.size() > 0 ? weights.maxCoeff() : 1;
    full_ = A.selfadjointView<Eigen::Lower>();
    if (weights.size() > 0) full_ = root_.asDiagonal() * full_ * root_.asDiagonal();
    if (Q_ == 0) return;
    qr_.compute(root_.asDiagonal() * G);
    // Share of a column outside the span of the others, below which it counts as dependent. Chosen by hand: far above
    // rounding, and far below what a polynomial needs to be determined.
    constexpr double dependent = 1e-11;
    qr_.setThreshold(dependent);
    if (qr_.rank() < Q_) {
      throw InvalidInput(std::string(function) + ": G = " + size_of(G) + ": has only rank " +
                         std::to_string(qr_.rank()) +
                         ": the points lie on the zero set of a polynomial of this degree; lower the degree or "
                         "add points");
    }
  }

  [[nodiscard]] Index unknowns() const { return n_ - Q_; }
  [[nodiscard]] const Eigen::VectorXd& root() const { return root_; }
  // lambda of the scaled system.
  [[nodiscard]] double scaled(double lambda) const { return lambda / unit_; }
  [[nodiscard]] double unscaled(double lambda) const { return lambda * unit_; }

  // Z^T A Z.
  [[nodiscard]] Matrix matrix() const {
    if (Q_ == 0) return full_;
    Matrix rotated = full_;
    stop_if_interrupted();
    rotated.applyOnTheLeft(qr_.householderQ().transpose());
    stop_if_interrupted();
    rotated.applyOnTheRight(qr_.householderQ());
    return rotated.bottomRightCorner(unknowns(), unknowns());
  }

  // Z^T x and Z y.
  [[nodiscard]] Matrix reduce(const Matrix& x) const {
    if (Q_ == 0) return x;
    Matrix rotated = x;
    rotated.applyOnTheLeft(qr_.householderQ().transpose());
    return rotated.bottomRows(unknowns());
  }
  [[nodiscard]] Matrix expand(const Matrix& y) const {
    if (Q_ == 0) return y;
    Matrix rotated(n_, y.cols());
    rotated << Matrix::Zero(Q_, y.cols()), y;
    rotated.applyOnTheLeft(qr_.householderQ());
    return rotated;
  }

  // pi from G pi = s - (A + lambda) alpha.
  [[nodiscard]] Matrix polynomial(const Matrix& s, const Matrix& alpha, double lambda) const {
    if (Q_ == 0) return Matrix(0, s.cols());
    return qr_.solve(s - full_ * alpha - lambda * alpha);
  }

 private:
  Index n_;
  Index Q_;
  Eigen::VectorXd root_;
  double unit_ = 1;
  Matrix full_;
  Eigen::ColPivHouseholderQR<Matrix> qr_;
};

// alpha_k / C_kk, with the scaling by the weights undone; infinite when C_kk is zero to working precision.
Matrix errors(const Matrix& alpha, const Eigen::VectorXd& inverse_diagonal, const Eigen::VectorXd& root) {
  const double zero = 1e-14 * inverse_diagonal.mean();
  Matrix e = alpha;
  for (Index k = 0; k < e.rows(); ++k) {
    if (inverse_diagonal[k] > zero) {
      e.row(k) /= inverse_diagonal[k] * root[k];
    } else {
      e.row(k).setConstant(unbounded);
    }
  }
  return e;
}

// The Cholesky factor L of Z^T A Z + lambda; raises lambda where that is not positive definite.
Matrix factorize(const Reduced& system, double largest_jitter, double& lambda) {
  constexpr double epsilon = std::numeric_limits<double>::epsilon();
  const Matrix reduced = system.matrix();
  const double unit = std::abs(reduced.trace()) / static_cast<double>(reduced.rows());
  for (double jitter = epsilon;; jitter *= 10) {
    Matrix L = reduced;
    L.diagonal().array() += lambda;
    const bool definite = cholesky_in_place(L);
    const double smallest = L.diagonal().minCoeff();
    const double largest = L.diagonal().maxCoeff();
    // A pivot (the square of the entry) no larger than its rounding error counts as 0.
    if (definite && smallest * smallest > 2 * epsilon * largest * largest) return L;
    if (!(jitter <= largest_jitter)) break;
    lambda = std::max(lambda, jitter * unit);
  }
  std::ostringstream message;
  message << "solve_saddle: the system is not positive definite to working precision with lambda = "
          << system.unscaled(lambda) << ": give a larger one (the mean diagonal entry is " << unit
          << "), merge coincident points, or use a smaller support or a kernel that is positive definite in this "
             "dimension";
  throw SolverFailure(message.str());
}

// The scores of all lambdas from the eigenvectors V and eigenvalues mu of A on the null space: C = V (mu + lambda)^-1
// V^T and I - S = lambda C.
struct SaddleSpectrum {
  Matrix V;
  Eigen::VectorXd mu;
  Matrix z;  // V^T s
  double smallest_lambda = 0;

  [[nodiscard]] Eigen::VectorXd g(double lambda) const { return (mu.array() + lambda).inverse(); }

  [[nodiscard]] double leave_one_out(double lambda) const {
    const Eigen::VectorXd inverse = g(lambda);
    const Matrix alpha = V * (inverse.asDiagonal() * z);
    const Eigen::VectorXd diagonal = V.cwiseAbs2() * inverse;
    return errors(alpha, diagonal, Eigen::VectorXd::Ones(V.rows())).squaredNorm();
  }

  [[nodiscard]] double gcv(double lambda) const {
    const Eigen::VectorXd inverse = g(lambda);
    const auto n = static_cast<double>(V.rows());
    const double trace = inverse.sum() / n;
    return (inverse.asDiagonal() * z).squaredNorm() / (n * static_cast<double>(z.cols())) / (trace * trace);
  }

  [[nodiscard]] double score(double lambda, LambdaCriterion criterion) const {
    if (lambda < smallest_lambda) return unbounded;
    const double value = criterion == LambdaCriterion::leave_one_out ? leave_one_out(lambda) : gcv(lambda);
    return std::isnan(value) ? unbounded : value;
  }
};

// Minimises f over exponents: the best of a grid (the score may have several minima), refined by golden section.
template <class Function>
double best_exponent(const Function& f, double first, double last) {
  constexpr double per_decade = 2.5;  // grid points, as in ridge()
  constexpr int steps = 16;           // of golden section: the interval shrinks to 1/2200
  const auto intervals = std::max(1, static_cast<int>(std::ceil(per_decade * (last - first))));
  const double step = (last - first) / intervals;
  double best = last;
  double smallest = f(last);
  for (int i = intervals - 1; i >= 0; --i) {
    const double value = f(first + step * i);
    if (value >= smallest) continue;
    smallest = value;
    best = first + step * i;
  }
  const double refined = golden_section(f, std::max(first, best - step), std::min(last, best + step), steps);
  return f(refined) < smallest ? refined : best;
}

}  // namespace

SaddleSolution solve_saddle(const MatrixRef& A, const MatrixRef& G, const MatrixRef& s, const SaddleOptions& options) {
  check_saddle("solve_saddle", A, G, s, options.weights);
  require(options.lambda >= 0 && options.lambda < unbounded, "solve_saddle", "lambda", options.lambda,
          "must be finite and not negative");
  const Reduced system("solve_saddle", A, G, options.weights);
  double lambda = system.scaled(options.lambda);
  const Matrix t = system.root().asDiagonal() * s;
  SaddleSolution solution;
  Matrix alpha = Matrix::Zero(s.rows(), s.cols());
  if (system.unknowns() > 0) {
    Matrix L = factorize(system, options.largest_rescue, lambda);
    const auto lower = L.triangularView<Eigen::Lower>();
    const double ratio = L.diagonal().maxCoeff() / L.diagonal().minCoeff();
    solution.condition = ratio * ratio;
    Matrix y = system.reduce(t);
    lower.solveInPlace(y);
    lower.adjoint().solveInPlace(y);
    alpha = system.expand(y);
    if (options.leave_one_out) {
      invert_lower_in_place(L);
      L.triangularView<Eigen::StrictlyUpper>().setZero();
      solution.leave_one_out = errors(alpha, system.expand(L.transpose()).rowwise().squaredNorm(), system.root());
    }
  } else if (options.leave_one_out) {
    solution.leave_one_out = Matrix::Constant(s.rows(), s.cols(), unbounded);
  }
  solution.lambda = system.unscaled(lambda);
  solution.pi = system.polynomial(t, alpha, lambda);
  solution.alpha = system.root().asDiagonal() * alpha;
  return solution;
}

SmoothingChoice choose_smoothing(const MatrixRef& A, const MatrixRef& G, const MatrixRef& s,
                                 const SmoothingOptions& options) {
  check_saddle("choose_smoothing", A, G, s, options.weights);
  require(options.smallest > 0, "choose_smoothing", "smallest", options.smallest, "must be positive");
  require(options.largest > options.smallest && options.largest < unbounded, "choose_smoothing", "largest",
          options.largest, "must be finite and larger than smallest");
  const Reduced system("choose_smoothing", A, G, options.weights);
  SmoothingChoice choice;
  const auto n = static_cast<double>(s.rows());
  choice.free_parameters = n;
  if (system.unknowns() == 0) return choice;
  const Eigen::SelfAdjointEigenSolver<Matrix> eigen(system.matrix());
  SaddleSpectrum spectrum{system.expand(eigen.eigenvectors()), eigen.eigenvalues(), {}, 0};
  spectrum.z = spectrum.V.transpose() * (system.root().asDiagonal() * s);
  const Eigen::VectorXd& mu = spectrum.mu;
  spectrum.smallest_lambda = n * 1e-16 * mu.cwiseAbs().maxCoeff() - mu.minCoeff();
  const double unit = mu.mean();
  if (!(unit > 0) || spectrum.score(options.largest * unit, options.criterion) == unbounded)
    throw SolverFailure("choose_smoothing: A is not positive definite; use a kernel made for this dimension");
  const auto f = [&](double exponent) { return spectrum.score(unit * std::pow(10.0, exponent), options.criterion); };
  const double strongest = std::log10(options.largest);
  double exponent = best_exponent(f, std::log10(options.smallest), strongest);
  // For pure noise the criterion is flat: a gain smaller than that of one parameter does not justify following the
  // samples.
  if (f(strongest) <= (1 + 1 / n) * f(exponent)) exponent = strongest;
  const double lambda = unit * std::pow(10.0, exponent);
  choice.lambda = system.unscaled(lambda);
  const double weight = system.root().squaredNorm();
  choice.leave_one_out = std::sqrt(spectrum.leave_one_out(lambda) / (weight * static_cast<double>(s.cols())));
  choice.gcv = system.unscaled(spectrum.gcv(lambda));
  choice.free_parameters = n - lambda * spectrum.g(lambda).sum();
  return choice;
}

}  // namespace csrbf
