#include "csrbf/approx/global/rbf_system.hpp"

#include "csrbf/approx/unity/lane_sums.hpp"
#include "csrbf/core/error.hpp"
#include "csrbf/core/parallel.hpp"
#include "csrbf/linalg/decompositions.hpp"
#include "csrbf/linalg/saddle.hpp"

#include <array>
#include <string>

namespace csrbf {
namespace {

using Matrix = Eigen::MatrixXd;
using MatrixRef = Eigen::Ref<const Eigen::MatrixXd>;
using VectorRef = Eigen::Ref<const Eigen::VectorXd>;

constexpr Index lanes = lane_sums::lanes;

// Up to eight points coordinate by coordinate; missing ones are copies of the last.
void gather(const MatrixRef& x, Index begin, Index count, std::vector<double>& to) {
  to.resize(lanes * x.rows());
  for (Index a = 0; a < x.rows(); ++a)
    for (Index l = 0; l < lanes; ++l) to[lanes * a + l] = x(a, begin + std::min(l, count - 1));
}

// Throws with the likely reason why a system is singular.
[[noreturn]] void fail(const Matrix& G) {
  std::string message = "RBFInterpolator: the system of equations is singular: ";
  const Index Q = G.cols();
  const Index rank = Q == 0 ? 0 : Eigen::ColPivHouseholderQR<Matrix>(G).rank();
  if (rank < Q) {
    message += "the points do not determine the polynomial (" + std::to_string(rank) + " of its " + std::to_string(Q) +
               " coefficients); lower the degree or add points that are not on one line or plane";
  } else {
    message += "merge coincident points, give a positive smoothing, or a larger epsilon";
  }
  throw SolverFailure(message);
}

// The solution of [A G; G^T 0] by LU, for matrices that are not positive definite on the null space.
void solve_indefinite(const MatrixRef& A, const Matrix& G, const MatrixRef& s, RbfCoefficients& f) {
  const Index n = A.rows();
  const Index Q = G.cols();
  Matrix system = Matrix::Zero(n + Q, n + Q);
  system.topLeftCorner(n, n) = A.selfadjointView<Eigen::Lower>();
  system.topRightCorner(n, Q) = G;
  system.bottomLeftCorner(Q, n) = G.transpose();
  Matrix right = Matrix::Zero(n + Q, s.rows());
  right.topRows(n) = s.transpose();
  const Eigen::PartialPivLU<Eigen::Ref<Matrix>> lu(system);
  if (!(system.diagonal().cwiseAbs().minCoeff() > 0)) fail(G);
  const Matrix solution = lu.solve(right);
  if (!solution.allFinite()) fail(G);
  f.alpha = solution.topRows(n);
  f.pi = solution.bottomRows(Q);
}

bool full_rank(const Matrix& G) {
  constexpr double dependent = 1e-11;  // as in solve_saddle()
  if (G.cols() == 0) return true;
  Eigen::ColPivHouseholderQR<Matrix> qr(G);
  qr.setThreshold(dependent);
  return qr.rank() == G.cols();
}

}  // namespace

MonomialSteps::MonomialSteps(int d, int degree) : dimension(d) {
  constexpr std::size_t most = 4096;  // coefficients, chosen by hand; indices have 16 bits
  if (degree < 0) return;
  parent = {0};
  axis = {0};
  std::size_t begin = 0;
  for (int of_degree = 1; of_degree <= degree; ++of_degree) {
    const std::size_t end = parent.size();
    for (std::size_t j = begin; j < end; ++j)
      for (int a = j == 0 ? 0 : axis[j]; a < d; ++a) {
        require(parent.size() < most, "RBFInterpolator", "degree", degree, "the polynomial has too many coefficients");
        parent.push_back(static_cast<std::int16_t>(j));
        axis.push_back(static_cast<std::int16_t>(a));
      }
    begin = end;
  }
}

Eigen::MatrixXi MonomialSteps::powers() const {
  Eigen::MatrixXi result = Eigen::MatrixXi::Zero(size(), dimension);
  for (Index j = 1; j < size(); ++j) {
    result.row(j) = result.row(parent[j]);
    ++result(j, axis[j]);
  }
  return result;
}

Matrix MonomialSteps::values(const MatrixRef& x) const {
  Matrix result(x.cols(), size());
  if (size() > 0) result.col(0).setOnes();
  for (Index j = 1; j < size(); ++j) result.col(j) = x.row(axis[j]).transpose().cwiseProduct(result.col(parent[j]));
  return result;
}

RbfCoefficients RbfBasis::frame(const Matrix& y) {
  const Eigen::VectorXd lo = y.rowwise().minCoeff();
  const Eigen::VectorXd hi = y.rowwise().maxCoeff();
  RbfCoefficients f;
  f.shift = .5 * lo + .5 * hi;
  f.scale = .5 * hi - .5 * lo;
  for (double& s : f.scale)
    if (!(s > 0)) s = 1;
  return f;
}

Matrix RbfBasis::matrix(const Matrix& y, const VectorRef& smoothing) const {
  const Index n = y.cols();
  Matrix A = Matrix::Zero(n, n);
  // Eight columns at a time, from the diagonal down.
  const auto columns = [&](Index group_begin, Index group_end) {
    std::vector<double> at;
    std::vector<double> r2(lanes * n);
    std::vector<double> phi(r2.size());
    for (Index j = lanes * group_begin; j < std::min(n, lanes * group_end); j += lanes) {
      const Index count = std::min(lanes, n - j);
      gather(y, j, count, at);
      lane_sums::distances(at.data(), static_cast<int>(y.rows()), y.col(j).data(), n - j, epsilon2, r2.data());
      kernel.values(r2.data(), lanes * (n - j), phi.data());
      for (Index l = 0; l < count; ++l)
        for (Index i = j; i < n; ++i) A(i, j + l) = phi[lanes * (i - j) + l];
    }
  };
  parallel_for((n + lanes - 1) / lanes, 4, columns);
  A.diagonal() += smoothing;
  return A;
}

RbfCoefficients RbfBasis::solve(const Matrix& y, const MatrixRef& s, const VectorRef& smoothing) const {
  RbfCoefficients f = frame(y);
  const Matrix G = monomials.values(((y.colwise() - f.shift).array().colwise() / f.scale.array()).matrix());
  if (!full_rank(G)) fail(G);
  const Matrix A = matrix(y, smoothing);
  require(A.diagonal().allFinite() && A.bottomLeftCorner(1, y.cols()).allFinite(), "RBFInterpolator", "epsilon",
          std::sqrt(epsilon2), "the radial functions overflow; scale the points");
  try {
    SaddleSolution solution = solve_saddle(A, G, s.transpose(), {.leave_one_out = false});
    f.alpha = std::move(solution.alpha);
    f.pi = std::move(solution.pi);
  } catch (const SolverFailure&) {
    solve_indefinite(A, G, s, f);
  }
  return f;
}

void RbfBasis::evaluate(const Matrix& y, const RbfCoefficients& f, const MatrixRef& x,
                        Eigen::Ref<Matrix> values) const {
  constexpr Index tile = 256;  // centres at a time; r2 and phi of eight points take 32 KB of the cache
  const int d = static_cast<int>(y.rows());
  const Index n = y.cols();
  const Index k = f.alpha.cols();
  std::vector<double> at;
  std::vector<double> local(lanes * d);
  std::vector<double> jets(lanes * std::max<Index>(monomials.size(), 1));
  std::vector<double> sums(lanes * k);
  std::array<double, lanes * tile> r2;
  std::array<double, lanes * tile> phi;
  for (Index i = 0; i < x.cols(); i += lanes) {
    const Index count = std::min(lanes, x.cols() - i);
    gather(x, i, count, at);
    for (int a = 0; a < d; ++a)
      for (Index l = 0; l < lanes; ++l) {
        const auto entry = static_cast<std::size_t>(lanes * a + l);
        local[entry] = (at[entry] - f.shift[a]) / f.scale[a];
      }
    for (Index c = 0; c < k; ++c)
      lane_sums::polynomial(local.data(), d, monomials.parent.data(), monomials.axis.data(), monomials.size(),
                            f.pi.col(c).data(), 1, jets.data(), sums.data() + lanes * c);
    for (Index j = 0; j < n; j += tile) {
      const Index part = std::min(tile, n - j);
      lane_sums::distances(at.data(), d, y.col(j).data(), part, epsilon2, r2.data());
      kernel.values(r2.data(), lanes * part, phi.data());
      for (Index c = 0; c < k; ++c)
        lane_sums::add_values(phi.data(), f.alpha.col(c).data() + j, part, sums.data() + lanes * c);
    }
    for (Index l = 0; l < count; ++l)
      for (Index c = 0; c < k; ++c) values(c, i + l) = sums[lanes * c + l];
  }
}

}  // namespace csrbf
