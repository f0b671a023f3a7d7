#include "csrbf/approx/global/many_rbfs.hpp"

#include "csrbf/approx/basis/expansion.hpp"
#include "csrbf/approx/global/iterative_system.hpp"
#include "csrbf/core/error.hpp"
#include "csrbf/linalg/decompositions.hpp"
#include "csrbf/spatial/chosen_points.hpp"
#include "csrbf/spatial/coincident_points.hpp"

namespace csrbf {
namespace {

constexpr Index fewest = 4000;            // points, up to which dense systems take seconds
constexpr double tolerance = 1e-8;        // of the residuals, in units of the largest value
constexpr double rank_threshold = 1e-11;  // as in solve_saddle()

using Matrix = Eigen::MatrixXd;
using ValuesRef = Eigen::Ref<const Matrix>;

Matrix in_frame(const RbfCoefficients& f, const ValuesRef& x) {
  return ((x.colwise() - f.shift).array().colwise() / f.scale.array()).matrix();
}

// The samples at each place as one: their mean, weighted by the inverse of the smoothing.
struct Merged {
  std::vector<Index> place;  // of each sample
  std::vector<Index> first;  // sample of each place
  Matrix values;             // k x places
  Eigen::VectorXd smoothing;
};

template <int Dim>
Merged merge(const Points<Dim>& y, const ValuesRef& s, const Eigen::Ref<const Eigen::VectorXd>& smoothing) {
  const std::vector<Index> twin = first_coincident<Dim>(y);
  Merged merged;
  merged.place.resize(y.cols());
  for (Index i = 0; i < y.cols(); ++i) {
    if (twin[i] == i) {
      merged.place[i] = std::ssize(merged.first);
      merged.first.push_back(i);
    } else {
      merged.place[i] = merged.place[twin[i]];
    }
  }
  merged.values = s(Eigen::all, merged.first);
  merged.smoothing = smoothing(merged.first);
  for (Index i = 0; i < y.cols(); ++i) {
    const Index at = merged.place[i];
    if (merged.first[at] == i) continue;
    double& lambda = merged.smoothing[at];
    if (lambda + smoothing[i] == 0)
      throw SolverFailure("RBFInterpolator: the system of equations is singular: points " +
                          std::to_string(merged.first[at]) + " and " + std::to_string(i) +
                          " coincide; merge them, or give a positive smoothing");
    const double share = lambda / (lambda + smoothing[i]);  // of the new value
    merged.values.col(at) += share * (s.col(i) - merged.values.col(at));
    lambda = smoothing[i] * share;
  }
  return merged;
}

// Each sample's own coefficients: those of a place, in parts that differ as its values do.
Matrix split(const Merged& merged, const Matrix& alpha, const ValuesRef& s,
             const Eigen::Ref<const Eigen::VectorXd>& smoothing) {
  Matrix own(s.cols(), alpha.cols());
  std::vector<Index> exact(merged.first.size(), -1);
  for (Index i = 0; i < s.cols(); ++i)
    if (smoothing[i] == 0) exact[merged.place[i]] = i;
  Matrix rest = alpha;
  for (Index i = 0; i < s.cols(); ++i) {
    const Index at = merged.place[i];
    if (smoothing[i] == 0) continue;
    // smoothing_i alpha_i = s_i - f, and lambda alpha = mean - f.
    const Eigen::RowVectorXd f = merged.values.col(at).transpose() - merged.smoothing[at] * alpha.row(at);
    own.row(i) = (s.col(i).transpose() - f) / smoothing[i];
    rest.row(at) -= own.row(i);
  }
  for (std::size_t at = 0; at < exact.size(); ++at)
    if (exact[at] >= 0) own.row(exact[at]) = rest.row(static_cast<Index>(at));
  return own;
}

template <int Dim>
RbfCoefficients solve_in(const RbfBasis& basis, const Matrix& y, const ValuesRef& s,
                         const Eigen::Ref<const Eigen::VectorXd>& smoothing, const Progress& progress) {
  RbfCoefficients f = RbfBasis::frame(y);
  const Points<Dim> points = y;
  const Merged merged = merge<Dim>(points, s, smoothing);
  const Points<Dim> places = chosen_points<Dim>(points, merged.first);
  Matrix G = basis.monomials.values(in_frame(f, places));
  const Eigen::RowVectorXd norms = G.colwise().norm();
  for (Index q = 0; q < G.cols(); ++q)
    if (norms[q] > 0) G.col(q) /= norms[q];
  if (G.cols() > 0) {
    Eigen::ColPivHouseholderQR<Matrix> qr(G);
    qr.setThreshold(rank_threshold);
    if (qr.rank() < G.cols())
      throw SolverFailure(
          "RBFInterpolator: the system of equations is singular: the points do not determine the "
          "polynomial (" +
          std::to_string(qr.rank()) + " of its " + std::to_string(G.cols()) +
          " coefficients); lower the degree or add points that are not on one line or plane");
  }
  IterativeSolution solution;
  try {
    solution = solve_iteratively<Dim>(places, basis.kernel, 1 / std::sqrt(basis.epsilon2), merged.smoothing, G,
                                      merged.values.transpose(), {.tolerance = tolerance, .progress = progress});
  } catch (const SolverFailure& failure) {
    throw ManyRbfs::IllConditioned(failure.what());
  }
  f.alpha = split(merged, solution.alpha, s, smoothing);
  f.pi = solution.pi;
  for (Index q = 0; q < G.cols(); ++q) f.pi.row(q) /= norms[q];
  return f;
}

template <int Dim>
class ManyRbfsIn : public ManyRbfs {
 public:
  ManyRbfsIn(const RbfBasis& basis, const Matrix& y, const RbfCoefficients& f)
      : basis_(basis), shift_(f.shift), scale_(f.scale), pi_(f.pi) {
    const auto radial = std::make_shared<const RadialBasis<Dim>>(
        basis.kernel, Points<Dim>(y), Eigen::VectorXd::Constant(1, 1 / std::sqrt(basis.epsilon2)));
    for (Index c = 0; c < f.alpha.cols(); ++c) sums_.emplace_back(radial, f.alpha.col(c));
  }

  [[nodiscard]] Matrix evaluate(const ValuesRef& x) const override {
    Matrix values(std::ssize(sums_), x.cols());
    const Points<Dim> at = x;
    for (Index c = 0; c < values.rows(); ++c) values.row(c) = sums_[c].evaluate(at).value.transpose();
    if (pi_.rows() > 0) {
      const Matrix local = ((x.colwise() - shift_).array().colwise() / scale_.array()).matrix();
      values += (basis_.monomials.values(local) * pi_).transpose();
    }
    for (Index i = 0; i < x.cols(); ++i)
      if (!x.col(i).allFinite()) values.col(i).setConstant(std::numeric_limits<double>::quiet_NaN());
    return values;
  }

 private:
  RbfBasis basis_;
  Eigen::VectorXd shift_, scale_;
  Matrix pi_;
  std::vector<Expansion<Dim>> sums_ = {};
};

}  // namespace

bool ManyRbfs::suits(const RbfBasis& basis, Index dimension, Index n) {
  return dimension <= 3 && n > fewest && basis.monomials.dimension == dimension && basis.epsilon2 > 0 &&
         basis.monomials.size() >= MonomialSteps(static_cast<int>(dimension), basis.kernel.order() - 1).size();
}

RbfCoefficients ManyRbfs::solve(const RbfBasis& basis, const Matrix& y, const ValuesRef& s,
                                const Eigen::Ref<const Eigen::VectorXd>& smoothing, const Progress& progress) {
  if (y.rows() == 1) return solve_in<1>(basis, y, s, smoothing, progress);
  if (y.rows() == 2) return solve_in<2>(basis, y, s, smoothing, progress);
  return solve_in<3>(basis, y, s, smoothing, progress);
}

std::unique_ptr<const ManyRbfs> ManyRbfs::make(const RbfBasis& basis, const Matrix& y, const RbfCoefficients& f) {
  if (y.rows() == 1) return std::make_unique<const ManyRbfsIn<1>>(basis, y, f);
  if (y.rows() == 2) return std::make_unique<const ManyRbfsIn<2>>(basis, y, f);
  return std::make_unique<const ManyRbfsIn<3>>(basis, y, f);
}

}  // namespace csrbf
