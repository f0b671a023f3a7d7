#include "csrbf/approx/kriging/estimate_drift.hpp"

#include "csrbf/approx/kriging/covariance.hpp"
#include "csrbf/approx/samples/many_variables.hpp"
#include "csrbf/approx/samples/merge_duplicates.hpp"
#include "csrbf/approx/samples/robust_weights.hpp"
#include "csrbf/core/error.hpp"
#include "csrbf/linalg/decompositions.hpp"
#include "csrbf/spatial/morton_order.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

namespace csrbf {
namespace {

// Chosen by hand.
constexpr Index exact_samples = 1000, samples_of_block = 100, most_blocks = 200;
constexpr int most_rounds = 4;
constexpr double settled = 1e-3;           // change of beta, in its deviations
constexpr double least_variation = 1e-10;  // variance of a combination of covariates, of size 1

// Sums over blocks of covariates and values, whitened.
struct DriftSums {
  Eigen::MatrixXd ZZ, Zy;
  Eigen::VectorXd yy;
  double degrees = 0;
};

using AnySamples = Samples<Eigen::Dynamic>;

// What is different in every dimension.
struct DriftTools {
  std::function<RobustWeights(const AnySamples&, const std::string& loss)> robust;
  std::function<Covariance(const AnySamples&)> covariance;
  std::function<std::vector<Index>(const Eigen::MatrixXd&)> order;
};

template <int Dim>
DriftTools tools() {
  const auto of_dimension = [](const AnySamples& given) {
    return Samples<Dim>{given.points, given.values, given.weights};
  };
  return {[=](const AnySamples& given, const std::string& loss) { return robust_weights(of_dimension(given), loss); },
          [=](const AnySamples& given) {
            const Samples<Dim> distinct = merge_duplicates(normalize_weights(of_dimension(given))).samples;
            return estimate_covariance(distinct, ThinnedLevels<Dim>(distinct.points));
          },
          [](const Eigen::MatrixXd& points) { return morton_order<Dim>(Points<Dim>(points)); }};
}

class DriftSearch {
 public:
  DriftSearch(DriftTools tools, Eigen::MatrixXd points, const Eigen::MatrixXd& values,
              const Eigen::MatrixXd& covariates, const Eigen::VectorXd& weights, std::string loss)
      : tools_(std::move(tools)), values_(values), Z_(covariates), loss_(std::move(loss)) {
    samples_.points = std::move(points);
    samples_.weights = weights;
  }

  DriftEstimate find() {
    DriftEstimate estimate{ordinary(), {}, {}};
    drop_gross_errors(estimate.beta);
    for (int round = 0; round < most_rounds; ++round) {
      const Eigen::MatrixXd before = estimate.beta;
      estimate = generalised(covariance_of(estimate.beta));
      const Eigen::VectorXd deviation = estimate.unit_variance.diagonal().cwiseSqrt();
      const Eigen::MatrixXd unit = deviation * estimate.sigma2.cwiseSqrt().transpose();
      if (((estimate.beta - before).array().abs() <= settled * unit.array()).all()) break;
    }
    return estimate;
  }

 private:
  [[nodiscard]] double weight(Index i) const { return samples_.weight(i); }

  [[nodiscard]] Eigen::MatrixXd ordinary() const {
    const Eigen::VectorXd w = samples_.all_weights() / samples_.all_weights().sum();
    const Eigen::MatrixXd Z = Z_.rowwise() - (w.transpose() * Z_);
    const Eigen::MatrixXd y = values_.rowwise() - (w.transpose() * values_);
    return solve(Eigen::LDLT<Eigen::MatrixXd>(Eigen::MatrixXd(Z.transpose() * w.asDiagonal() * Z)),
                 Eigen::MatrixXd(Z.transpose() * w.asDiagonal() * y));
  }

  void drop_gross_errors(const Eigen::MatrixXd& beta) {
    if (loss_ == "squares") return;
    AnySamples residuals = samples_;
    residuals.values = values_ - Z_ * beta;
    const RobustWeights robust = tools_.robust(residuals, loss_);
    if (robust.factors.size() == 0) return;
    samples_.weights = samples_.all_weights().cwiseProduct(robust.factors);
    std::vector<Index> kept;
    for (Index i = 0; i < samples_.size(); ++i)
      if (samples_.weights[i] > 0) kept.push_back(i);
    samples_ = {samples_.points(Eigen::all, kept).eval(), Eigen::MatrixXd(), samples_.weights(kept).eval()};
    values_ = values_(kept, Eigen::all).eval();
    Z_ = Z_(kept, Eigen::all).eval();
  }

  [[nodiscard]] Covariance covariance_of(const Eigen::MatrixXd& beta) const {
    AnySamples residuals = samples_;
    residuals.values = values_ - Z_ * beta;
    return tools_.covariance(residuals);
  }

  [[nodiscard]] DriftEstimate generalised(const Covariance& covariance) const {
    const Index n = samples_.size(), k = values_.cols(), q = Z_.cols();
    DriftSums sums{Eigen::MatrixXd::Zero(q, q), Eigen::MatrixXd::Zero(q, k), Eigen::VectorXd::Zero(k)};
    const std::vector<Index> order = tools_.order(samples_.points);
    const Index each = n <= exact_samples ? n : samples_of_block;
    const Index blocks = n / each, stride = std::max<Index>(1, blocks / most_blocks);
    for (Index b = 0; b < blocks; b += stride) {
      const auto first = order.begin() + b * each;
      add_block({first, first + each}, covariance, sums);
    }
    const Eigen::LDLT<Eigen::MatrixXd> ldlt(sums.ZZ);
    DriftEstimate estimate;
    estimate.beta = solve(ldlt, sums.Zy);
    estimate.unit_variance = solve(ldlt, Eigen::MatrixXd(Eigen::MatrixXd::Identity(q, q)));
    estimate.sigma2 = (sums.yy - sums.Zy.cwiseProduct(estimate.beta).colwise().sum().transpose()).cwiseMax(0) /
                      std::max(1.0, sums.degrees - static_cast<double>(q));
    return estimate;
  }

  void add_block(const std::vector<Index>& rows, const Covariance& covariance, DriftSums& sums) const {
    const auto n = std::ssize(rows);
    const double mean_weight = samples_.all_weights().mean();
    Eigen::MatrixXd K(n, n);
    for (Index j = 0; j < n; ++j)
      for (Index i = j; i < n; ++i)
        K(i, j) = covariance.kernel.value((samples_.points.col(rows[i]) - samples_.points.col(rows[j])).norm() /
                                          covariance.length);
    for (Index i = 0; i < n; ++i)
      K(i, i) += std::max(covariance.nugget, least_nugget) * mean_weight / std::max(weight(rows[i]), 1e-300);
    const Eigen::LLT<Eigen::MatrixXd> llt(K);
    if (llt.info() != Eigen::Success) return;
    const Index q = Z_.cols(), k = values_.cols();
    Eigen::MatrixXd white(n, 1 + q + k);
    white << Eigen::VectorXd::Ones(n), Z_(rows, Eigen::all), values_(rows, Eigen::all);
    solve_lower(llt, white);
    const Eigen::VectorXd one = white.col(0).normalized();
    white -= one * (one.transpose() * white).eval();
    sums.ZZ += white.middleCols(1, q).transpose() * white.middleCols(1, q);
    sums.Zy += white.middleCols(1, q).transpose() * white.rightCols(k);
    sums.yy += white.rightCols(k).colwise().squaredNorm().transpose();
    sums.degrees += static_cast<double>(n - 1);
  }

  static constexpr double least_nugget = 1e-9;  // duplicates of points keep the matrix regular

  DriftTools tools_;
  AnySamples samples_;  // without values
  Eigen::MatrixXd values_, Z_;
  std::string loss_;
};

}  // namespace

DriftEstimate estimate_drift(const Eigen::MatrixXd& points, const Eigen::MatrixXd& values,
                             const Eigen::MatrixXd& covariates, const Eigen::VectorXd& weights,
                             const std::string& loss) {
  const Index q = covariates.cols();
  require(covariates.rows() > q + 2, "fit", "samples", covariates.rows(),
          "too few for " + std::to_string(q) + " covariates of a drift");
  const Eigen::RowVectorXd mean = covariates.colwise().mean();
  Eigen::MatrixXd Z = covariates.rowwise() - mean;
  Eigen::VectorXd unit = Z.colwise().stableNorm().transpose() / std::sqrt(static_cast<double>(Z.rows()));
  for (Index j = 0; j < q; ++j)
    require(unit[j] > least_variation * std::abs(mean[j]), "fit", "drift", j + 1,
            "this covariate is the same everywhere; leave it out");
  Z *= unit.cwiseInverse().asDiagonal();
  const Eigen::MatrixXd moments = Z.transpose() * Z / static_cast<double>(Z.rows());
  require(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(moments).eigenvalues()[0] > least_variation, "fit", "drift", q,
          "a covariate is a linear function of the others; leave it out");
  DriftEstimate estimate;
  switch (fitted_dimension(points.rows())) {
#define CSRBF_CASE(Dim)                                                                             \
  case Dim:                                                                                         \
    estimate = DriftSearch(tools<Dim>(), with_zeros<Dim>(points), values, Z, weights, loss).find(); \
    break;
    CSRBF_FOR_MANY_DIMS(CSRBF_CASE)
#undef CSRBF_CASE
    default:
      throw InvalidInput("fit: dimension: too many coordinates for a drift on a sphere or beside periods");
  }
  estimate.beta = unit.cwiseInverse().asDiagonal() * estimate.beta;
  estimate.unit_variance = unit.cwiseInverse().asDiagonal() * estimate.unit_variance * unit.cwiseInverse().asDiagonal();
  return estimate;
}

}  // namespace csrbf
