#include "csrbf/linalg/sparse_least_squares.hpp"

#include "csrbf/core/error.hpp"

#include <Eigen/SparseCore>

#include <random>
#include <vector>

namespace csrbf {
namespace {

constexpr const char* function = "sparse_least_squares";

using Rows = Eigen::SparseMatrix<double, Eigen::RowMajor>;
using Columns = Eigen::SparseMatrix<double>;

void check_least_squares(const Rows& B, const Eigen::Ref<const Eigen::MatrixXd>& s,
                         const SparseLeastSquaresOptions& options) {
  require(B.rows() > 0 && B.cols() > 0, function, "B", "empty", "needs at least one datum and one coefficient");
  require(s.rows() == B.rows(), function, "s", s.rows(), "there must be one row of data per row of B");
  require(Eigen::Map<const Eigen::VectorXd>(B.valuePtr(), B.nonZeros()).allFinite(), function, "B", "NaN or infinity",
          "every entry must be finite");
  require(s.allFinite(), function, "s", "NaN or infinity", "every datum must be finite");
  const Eigen::VectorXd& w = options.weights;
  require(w.size() == 0 || w.size() == B.rows(), function, "weights", w.size(), "there must be one per datum or none");
  require(w.size() == 0 || (w.allFinite() && w.minCoeff() >= 0), function, "weights", "negative or not finite",
          "weights must be finite and not negative");
  require(w.size() == 0 || w.maxCoeff() > 0, function, "weights", "all zero", "at least one must be positive");
  require(!options.lambda0 || (*options.lambda0 >= 0 && std::isfinite(*options.lambda0)), function, "lambda0",
          options.lambda0.value_or(0), "must be finite and not negative");
  require(options.smallest > 0 && options.smallest <= options.largest, function, "smallest", options.smallest,
          "must be positive and at most `largest`");
  require(options.penalty.size() == 0 || (options.penalty.rows() == B.cols() && options.penalty.cols() == B.cols()),
          function, "penalty", options.penalty.rows(), "must have one row and column per column of B");
  require(options.score_unit.slope.size() == 0 || (options.score_unit.slope.size() == B.cols() && s.cols() == 1),
          function, "score_unit.slope", options.score_unit.slope.size(),
          "must have one entry per column of B, for data of one component");
}

// The problem with weights applied and empty columns removed.
struct Problem {
  Rows B;             // rows times the roots of the weights
  Eigen::MatrixXd s;  // likewise
  Columns gram;       // B^T B
  Columns penalty;
  AffineFunction score_unit;
  Eigen::MatrixXd right;  // B^T s
  double weight = 0;      // sum of the weights
  Index data = 0;         // rows of positive weight

  [[nodiscard]] double lambda(double lambda0) const { return lambda0 * weight / penalty.diagonal().sum(); }
};

// The indices of the columns that have an entry.
std::vector<int> used_columns(const Rows& B) {
  std::vector<char> used(B.cols(), 0);
  for (Index i = 0; i < B.nonZeros(); ++i)
    if (B.valuePtr()[i] != 0) used[B.innerIndexPtr()[i]] = 1;
  std::vector<int> columns;
  for (std::size_t j = 0; j < used.size(); ++j)
    if (used[j] != 0) columns.push_back(static_cast<int>(j));
  return columns;
}

Rows selection(const std::vector<int>& columns, Index from) {
  Rows E(from, std::ssize(columns));
  E.reserve(std::ssize(columns));
  for (std::size_t i = 0; i < columns.size(); ++i) E.insert(columns[i], static_cast<Index>(i)) = 1;
  E.makeCompressed();
  return E;
}

Problem prepare(const Rows& B, const Eigen::Ref<const Eigen::MatrixXd>& s, const SparseLeastSquaresOptions& options,
                std::vector<int>& columns) {
  Problem p;
  p.B = B;
  p.s = s;
  p.weight = static_cast<double>(B.rows());
  p.data = B.rows();
  if (options.weights.size() > 0) {
    const Eigen::VectorXd roots = options.weights.cwiseSqrt();
    p.B = roots.asDiagonal() * B;
    p.s.array().colwise() *= roots.array();
    p.weight = options.weights.sum();
    p.data = (roots.array() > 0).count();
  }
  columns = used_columns(p.B);
  const bool all = std::ssize(columns) == B.cols();
  const Rows E = all ? Rows() : selection(columns, B.cols());
  if (!all) p.B = Rows(p.B * E);
  if (options.penalty.size() > 0) {
    p.penalty = all ? options.penalty : Columns(E.transpose() * options.penalty * E);
  } else {
    p.penalty.resize(p.B.cols(), p.B.cols());
    p.penalty.setIdentity();
  }
  p.score_unit = options.score_unit;
  if (p.score_unit.slope.size() > 0) p.score_unit.slope = Eigen::VectorXd(p.score_unit.slope(columns));
  const Columns transposed = p.B.transpose();
  p.gram = Columns(transposed * p.B);
  p.right = transposed * p.s;
  return p;
}

// Solves for one lambda; empty when the equations are not positive definite.
Eigen::MatrixXd solve(const Problem& p, double lambda, SparseCholesky& solver) {
  const Columns N = p.gram + lambda * p.penalty;
  if (!solver.factorize(N)) return {};
  Eigen::MatrixXd c = solver.solve(p.right);
  const Eigen::MatrixXd residual = p.B.transpose() * (p.s - p.B * c) - lambda * (p.penalty * c);
  c += solver.solve(residual);
  return c;
}

// lambda tr(N^-1 P) for the matrix N that the solver holds: M - tr S.
double unfitted(const Problem& p, double lambda, const SparseCholesky& solver) {
  constexpr Index exact = 256;  // columns up to which the trace is computed exactly; chosen by hand
  constexpr Index probes = 16;  // random vectors beyond (Hutchinson 1989); chosen by hand: cost against variance
  const Index M = p.B.cols();
  if (M <= exact) return lambda * solver.solve(Eigen::MatrixXd(p.penalty)).trace();
  std::mt19937_64 random(1);
  const Eigen::MatrixXd z = Eigen::MatrixXd::NullaryExpr(M, probes, [&] { return (random() >> 63) != 0 ? 1.0 : -1.0; });
  return lambda * (z.array() * solver.solve(p.penalty * z).array()).sum() / static_cast<double>(probes);
}

double gcv_score(const Problem& p, double lambda0, SparseCholesky& solver) {
  constexpr double rejected = std::numeric_limits<double>::infinity();
  constexpr double least_freedom = 1e-10;  // of 1 - tr S / N: below, the fit interpolates and the score is 0 / 0
  const double lambda = p.lambda(lambda0);
  const Eigen::MatrixXd c = solve(p, lambda, solver);
  if (c.size() == 0 || !c.allFinite()) return rejected;
  const auto n = static_cast<double>(p.data);
  const double freedom = 1 - (static_cast<double>(p.B.cols()) - unfitted(p, lambda, solver)) / n;
  if (!(freedom > least_freedom)) return rejected;
  double unit = p.score_unit.offset;
  if (p.score_unit.slope.size() > 0) unit += p.score_unit.slope.dot(c.col(0));
  if (!(unit > 0)) return rejected;
  return (p.s - p.B * c).squaredNorm() / n / (freedom * freedom) / (unit * unit);
}

// Minimises the score over whole decades, then by bisection between the best and its neighbours.
double choose_sparse_lambda0(const Problem& p, const SparseLeastSquaresOptions& options, SparseCholesky& solver,
                             double& gcv) {
  double best = std::log10(options.smallest);
  gcv = std::numeric_limits<double>::infinity();
  const auto attempt = [&](double exponent) {
    if (exponent < std::log10(options.smallest) || exponent > std::log10(options.largest)) return;
    const double score = gcv_score(p, std::pow(10, exponent), solver);
    if (score >= gcv) return;
    gcv = score;
    best = exponent;
  };
  const double decades = std::ceil(std::log10(options.largest / options.smallest));
  for (double i = 0; i <= decades; ++i) {
    report(options.solver.progress, "choose smoothing", i / (decades + 1));
    attempt(std::log10(options.largest) - i);
  }
  for (const double step : {0.5, 0.25, 0.125}) {
    const double middle = best;
    attempt(middle - step);
    attempt(middle + step);
  }
  if (!std::isfinite(gcv))
    throw SolverFailure(
        "sparse_least_squares: no regularisation in the range gives positive definite equations; give "
        "lambda0 or use fewer centres than data");
  return std::pow(10, best);
}

}  // namespace

SparseLeastSquaresFit sparse_least_squares(const Rows& B, const Eigen::Ref<const Eigen::MatrixXd>& s,
                                           const SparseLeastSquaresOptions& options) {
  check_least_squares(B, s, options);
  std::vector<int> columns;
  const Problem p = prepare(B, s, options, columns);
  SparseLeastSquaresFit fit;
  fit.dropped = B.cols() - std::ssize(columns);
  fit.coefficients.setZero(B.cols(), s.cols());
  fit.fitted.setZero(B.rows(), s.cols());
  fit.lambda0 = options.lambda0.value_or(0);
  if (columns.empty()) return fit;

  SparseCholesky solver(options.solver);
  if (!options.lambda0) fit.lambda0 = choose_sparse_lambda0(p, options, solver, fit.gcv);
  fit.lambda = p.lambda(fit.lambda0);
  const Eigen::MatrixXd c = solve(p, fit.lambda, solver);
  if (c.size() == 0 || !c.allFinite())
    throw SolverFailure(
        "sparse_least_squares: the columns of B are linearly dependent to working precision; use more "
        "regularisation, fewer centres or smaller supports");
  for (std::size_t i = 0; i < columns.size(); ++i) fit.coefficients.row(columns[i]) = c.row(static_cast<Index>(i));
  fit.fitted = B * fit.coefficients;
  fit.direct = solver.direct();
  fit.iterations = solver.iterations();
  return fit;
}

}  // namespace csrbf
