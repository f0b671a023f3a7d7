#include "csrbf/linalg/sparse_cholesky.hpp"

#include "csrbf/core/error.hpp"

#include <Eigen/IterativeLinearSolvers>
#include <Eigen/SparseCholesky>

#include <utility>

namespace csrbf {
namespace {

using SparseMatrix = Eigen::SparseMatrix<double>;

// Exposes the cost of the factor, known once the pattern is analysed.
class Factor : public Eigen::SimplicialLLT<SparseMatrix, Eigen::Lower, Eigen::AMDOrdering<int>> {
 public:
  [[nodiscard]] double flops() const { return m_nonZerosPerCol.cast<double>().squaredNorm(); }
};

using Preconditioner = Eigen::IncompleteCholesky<double, Eigen::Lower, Eigen::AMDOrdering<int>>;

bool same_pattern(const SparseMatrix& a, const SparseMatrix& b) {
  return a.rows() == b.rows() && a.nonZeros() == b.nonZeros() &&
         std::equal(a.outerIndexPtr(), a.outerIndexPtr() + a.cols() + 1, b.outerIndexPtr()) &&
         std::equal(a.innerIndexPtr(), a.innerIndexPtr() + a.nonZeros(), b.innerIndexPtr());
}

}  // namespace

struct SparseCholesky::Impl {
  SparseCholeskyOptions options;
  SparseMatrix N;  // for the iteration, and to recognise the same pattern
  Factor factor;
  Preconditioner preconditioner;
  bool analyzed = false;
  bool direct = true;
  Index iterations = 0;

  Index conjugate_gradients(const Eigen::VectorXd& b, Eigen::VectorXd& x) const;
};

SparseCholesky::SparseCholesky(SparseCholeskyOptions options) : impl_(std::make_unique<Impl>()) {
  impl_->options = std::move(options);
}
SparseCholesky::SparseCholesky(SparseCholesky&&) noexcept = default;
SparseCholesky& SparseCholesky::operator=(SparseCholesky&&) noexcept = default;
SparseCholesky::~SparseCholesky() = default;

bool SparseCholesky::direct() const {
  return impl_->direct;
}
Index SparseCholesky::iterations() const {
  return impl_->iterations;
}

bool SparseCholesky::factorize(const SparseMatrix& N) {
  Impl& s = *impl_;
  const bool known = s.analyzed && same_pattern(s.N, N);
  s.N = N;
  if (!known) {
    s.direct = s.options.method != SparseMethod::iterative;
    if (s.direct) s.factor.analyzePattern(N);
    if (s.options.method == SparseMethod::automatic && s.factor.flops() > s.options.direct_flops) s.direct = false;
    s.analyzed = true;
  }
  if (s.direct) {
    s.factor.factorize(N);
    return s.factor.info() == Eigen::Success;
  }
  s.preconditioner.compute(N);
  return s.preconditioner.info() == Eigen::Success;
}

// Returns the number of iterations (Hestenes and Stiefel 1952). Keeps the best iterate: when N is ill-conditioned
// rounding stops progress before the tolerance is reached.
Index SparseCholesky::Impl::conjugate_gradients(const Eigen::VectorXd& b, Eigen::VectorXd& x) const {
  const double goal = options.tolerance * b.norm();
  const auto full = N.selfadjointView<Eigen::Lower>();
  x.setZero(b.size());
  Eigen::VectorXd residual = b;
  Eigen::VectorXd best = x;
  double best_norm = residual.norm();
  Eigen::VectorXd z = preconditioner.solve(residual);
  Eigen::VectorXd direction = z;
  double rz = residual.dot(z);
  Index iteration = 0;
  while (best_norm > goal && iteration < options.max_iterations) {
    const Eigen::VectorXd image = full * direction;
    const double curvature = direction.dot(image);
    if (!(curvature > 0)) break;
    ++iteration;
    x += rz / curvature * direction;
    residual -= rz / curvature * image;
    if (residual.norm() < best_norm) {
      best_norm = residual.norm();
      best = x;
    }
    z = preconditioner.solve(residual);
    const double next = residual.dot(z);
    direction = z + next / rz * direction;
    rz = next;
    constexpr Index report_every = 16;  // iterations
    if (iteration % report_every == 0)
      report(options.progress, "solve", static_cast<double>(iteration) / static_cast<double>(options.max_iterations));
  }
  x = best;
  if (!(best_norm <= std::sqrt(options.tolerance) * b.norm()))
    throw SolverFailure("SparseCholesky: no convergence after " + std::to_string(iteration) +
                        " iterations; use smaller supports, more regularisation or the direct method");
  return iteration;
}

Eigen::MatrixXd SparseCholesky::solve(const Eigen::Ref<const Eigen::MatrixXd>& b) const {
  if (impl_->direct) return impl_->factor.solve(b);
  Eigen::MatrixXd x(b.rows(), b.cols());
  for (Index j = 0; j < b.cols(); ++j) {
    Eigen::VectorXd column;
    impl_->iterations += impl_->conjugate_gradients(b.col(j), column);
    x.col(j) = column;
  }
  return x;
}

}  // namespace csrbf
