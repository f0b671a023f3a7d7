#include "csrbf/approx/levels/level_builder.hpp"

#include "csrbf/spatial/chosen_points.hpp"
#include "csrbf/spatial/kd_tree.hpp"

namespace csrbf {
namespace {

// Weighted mean as the first value plus the mean difference to it: exact for constant data.
template <int Dim>
Eigen::RowVectorXd weighted_mean(const Samples<Dim>& samples) {
  const Eigen::VectorXd weights = samples.all_weights() / samples.all_weights().sum();
  const Eigen::RowVectorXd first = samples.values.row(0);
  return first + weights.transpose() * (samples.values.rowwise() - first);
}

// Distance of a sample to the nearest other one.
template <int Dim>
double nearest_distance(const KdTree<Dim>& tree, const Point<Dim>& x) {
  Index index[2];
  double squared[2];
  return tree.nearest(x, 2, index, squared) == 2 ? std::sqrt(squared[1]) : 1;
}

}  // namespace

template <int Dim>
LevelBuilder<Dim>::LevelBuilder(const Samples<Dim>& samples, const char* function, Progress progress,
                                DuplicateValue duplicates)
    : progress_(std::move(progress)) {
  require_valid(samples, function);
  merged_ = merge_duplicates(samples, duplicates);
  mean_ = weighted_mean(merged_.samples);
  residual_ = merged_.samples.values.rowwise() - mean_;
  expansions_.resize(samples.components());
}

// Centres far from everything that a level changes have coefficients of the size of rounding errors: dropping them
// makes evaluations faster.
template <int Dim>
void LevelBuilder<Dim>::append(const std::shared_ptr<const RadialBasis<Dim>>& basis,
                               const Eigen::MatrixXd& coefficients, double lambda0) {
  constexpr double rounding = 1e-16;
  const double negligible = rounding * range();
  std::vector<Index> kept;
  for (Index j = 0; j < basis->size(); ++j)
    if (!(coefficients.row(j).cwiseAbs().maxCoeff() <= negligible)) kept.push_back(j);
  std::shared_ptr<const RadialBasis<Dim>> used = basis;
  if (static_cast<Index>(kept.size()) < basis->size()) {
    const Eigen::VectorXd supports = basis->supports().size() > 1 && !kept.empty()
                                         ? Eigen::VectorXd(basis->supports()(kept))
                                         : basis->supports().head(1);
    used =
        std::make_shared<const RadialBasis<Dim>>(basis->kernel(), chosen_points<Dim>(basis->centers(), kept), supports);
  }
  const Box<Dim> bounds = bounding_box<Dim>(samples().points);
  for (Index c = 0; c < samples().components(); ++c) {
    PolynomialTail<Dim> tail;
    if (reports_.empty()) tail = {0, Point<Dim>::Zero(), 1, Eigen::VectorXd::Constant(1, mean_[c])};
    expansions_[c].push_back(
        std::make_shared<const Expansion<Dim>>(used, coefficients(kept, c), std::move(tail), bounds));
  }
  LevelReport level;
  level.centers = basis->size();
  if (level.centers > 0) {
    level.smallest_support = basis->supports().minCoeff();
    level.largest_support = basis->supports().maxCoeff();
  }
  level.lambda0 = lambda0;
  const Eigen::VectorXd weights = samples().all_weights();
  const double mean_square = weights.dot(residual_.rowwise().squaredNorm()) / weights.sum();
  level.rmse = std::sqrt(mean_square / static_cast<double>(samples().components()));
  level.max_error = max_error();
  reports_.push_back(level);
}

template <int Dim>
void LevelBuilder<Dim>::add(const Kernel& kernel, const PointsRef<Dim>& centers, const Eigen::VectorXd& supports,
                            LevelSolve solve, std::optional<double> lambda0) {
  require(kernel.compact(), "LevelBuilder", "kernel", kernel.name(),
          "fits by levels need a compactly supported kernel; choose wendland-c2 or another one");
  const auto basis = std::make_shared<const RadialBasis<Dim>>(kernel, centers, supports);
  const Eigen::SparseMatrix<double, Eigen::RowMajor> B = basis->matrix(samples().points);
  Eigen::MatrixXd coefficients;
  if (solve == LevelSolve::interpolation) {
    // Rows of B at the centres; the residual there is read off the nearest sample, which the centre is.
    const KdTree<Dim> tree(samples().points);
    Eigen::MatrixXd right(centers.cols(), residual_.cols());
    for (Index j = 0; j < centers.cols(); ++j) {
      Index i = 0;
      double squared = 0;
      tree.nearest(centers.col(j), 1, &i, &squared);
      right.row(j) = residual_.row(i);
    }
    const Eigen::SparseMatrix<double> A = basis->matrix(centers);
    // The supports follow the spacing, so the condition is moderate and iterations are few: direct solutions pay only
    // while they are cheap. Chosen by hand.
    constexpr double direct_flops = 1e9;
    SparseCholesky solver({.direct_flops = direct_flops, .progress = progress_});
    if (!solver.factorize(A))
      throw SolverFailure(
          "LevelBuilder: the interpolation matrix is not positive definite to working precision; use a "
          "less smooth kernel, smaller supports or least squares");
    coefficients = solver.solve(right);
    coefficients += solver.solve(right - A * coefficients);
    residual_ -= B * coefficients;
    lambda0 = 0;
  } else {
    SparseLeastSquaresOptions options{.lambda0 = lambda0, .weights = samples().weights};
    options.solver.progress = progress_;
    if (solve == LevelSolve::native) {
      const Eigen::SparseMatrix<double> A = basis->matrix(centers);
      options.penalty = 0.5 * (A + Eigen::SparseMatrix<double>(A.transpose()));
    }
    const SparseLeastSquaresFit fit = sparse_least_squares(B, residual_, options);
    coefficients = fit.coefficients;
    residual_ -= fit.fitted;
    lambda0 = fit.lambda0;
  }
  append(basis, coefficients, *lambda0);
}

template <int Dim>
void LevelBuilder<Dim>::add_diagonal(const Kernel& kernel, const std::vector<Index>& ids) {
  const KdTree<Dim> tree(samples().points);
  const auto n = static_cast<Index>(ids.size());
  Points<Dim> centers(Dim, n);
  Eigen::VectorXd supports(n);
  Eigen::MatrixXd coefficients(n, residual_.cols());
  for (Index j = 0; j < n; ++j) {
    const Index i = ids[j];
    centers.col(j) = samples().points.col(i);
    supports[j] = nearest_distance<Dim>(tree, centers.col(j));
    coefficients.row(j) = residual_.row(i);
    residual_.row(i).setZero();
  }
  append(std::make_shared<const RadialBasis<Dim>>(kernel, centers, n > 0 ? supports : Eigen::VectorXd::Ones(1)),
         coefficients, 0);
}

template <int Dim>
std::vector<Index> LevelBuilder<Dim>::violations(double tolerance) {
  // The sums of a fit and of an evaluation round differently.
  const LevelFit<Dim> fit = finish();
  for (Index c = 0; c < residual_.cols(); ++c)
    residual_.col(c) = samples().values.col(c) - fit.fields[c]->evaluate(samples().points).value;
  std::vector<Index> ids;
  for (Index i = 0; i < samples().size(); ++i)
    if (error(i) > tolerance) ids.push_back(i);
  return ids;
}

template <int Dim>
LevelFit<Dim> LevelBuilder<Dim>::finish(double tolerance) const {
  constexpr double rounding = 1e-12;  // of the range: what the sums of a few levels lose
  LevelFit<Dim> fit;
  for (const auto& levels : expansions_)
    fit.fields.push_back(std::make_shared<const LevelSum<Dim>>(levels, bounding_box<Dim>(samples().points)));
  fit.levels = reports_;
  fit.merged_duplicates = merged_.merged();
  fit.converged = reports_.empty() || reports_.back().max_error <= tolerance + rounding * range();
  return fit;
}

#define CSRBF_INSTANTIATE(Dim) template class LevelBuilder<Dim>;
CSRBF_FOR_EACH_DIM(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
