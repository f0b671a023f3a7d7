#include "csrbf/approx/global/smoothing_of_many.hpp"

#include "csrbf/approx/global/iterative_system.hpp"
#include "csrbf/core/error.hpp"

#include <Eigen/QR>

#include <algorithm>
#include <numeric>
#include <optional>
#include <random>

namespace csrbf {
namespace {

// Chosen by hand.
constexpr Index subset_size = 5000;
constexpr double step = 4;        // between smoothings that are compared
constexpr double flat = .01;      // change of the squared error below which smoothing does not matter
constexpr double shows = .05;     // share of the leave-one-out errors that is left at the samples, from which on it may
constexpr double accuracy = .02;  // of the errors, that residuals of the systems may be
constexpr double most_accurate = 1e-8, least_accurate = 1e-3;  // in units of the largest value
constexpr int most_steps = 12;                                 // in one direction
constexpr double full_rank_pivot = 1e-8;

// GCV of one set of samples.
template <int Dim>
class Score {
 public:
  Score(const Samples<Dim>& samples, const Kernel& kernel, double support, const Eigen::MatrixXd& G, double tolerance)
      : points_(samples.points),
        kernel_(kernel),
        support_(support),
        G_(G),
        inverse_weights_(samples.all_weights().cwiseInverse()),
        tolerance_(tolerance),
        columns_(samples.size(), samples.components() + 1) {
    std::mt19937_64 random(1);
    for (Index k = 0; k < samples.size(); ++k)
      columns_(k, 0) = ((random() >> 63) != 0 ? 1 : -1) * std::sqrt(inverse_weights_[k]);
    for (Index c = 0; c < samples.components(); ++c) {
      const auto s = samples.values.col(c);
      const double deviation = std::sqrt((s.array() - s.mean()).square().mean());
      columns_.col(c + 1) = s / (deviation > 0 ? deviation : 1);
    }
  }

  struct Value {
    double gcv = std::numeric_limits<double>::infinity();  // where the system cannot be solved
    double trace = 0;                                      // of W^-1 C, over n: 1 / lambda for large lambda
  };

  [[nodiscard]] Value at(double lambda) const {
    try {
      const IterativeSolution solution = solve_iteratively<Dim>(points_, kernel_, support_, lambda * inverse_weights_,
                                                                G_, columns_, {.tolerance = tolerance_});
      const double n = static_cast<double>(columns_.rows());
      const double trace = columns_.col(0).dot(solution.alpha.col(0)) / n;
      const auto alpha = solution.alpha.rightCols(columns_.cols() - 1);
      return {(alpha.array().square().colwise() * inverse_weights_.array()).sum() / n / (trace * trace), trace};
    } catch (const SolverFailure&) {
      return {};
    }
  }

  [[nodiscard]] double operator()(double log_lambda) const { return at(std::exp(log_lambda)).gcv; }

 private:
  PointsRef<Dim> points_;
  const Kernel& kernel_;
  double support_;
  const Eigen::MatrixXd& G_;
  Eigen::VectorXd inverse_weights_;
  double tolerance_;
  Eigen::MatrixXd columns_;  // signs, then the values
};

// Downhill in steps from `start`, where the score is `middle`, then the minimum of the parabola through the lowest
// three.
template <class F>
double minimize(const F& score, double start, double middle) {
  const double h = std::log(step);
  double below = score(start - h), above = score(start + h);
  for (int k = 0; k < most_steps && above < middle; ++k) {
    below = middle;
    middle = above;
    start += h;
    above = score(start + h);
  }
  for (int k = 0; k < most_steps && below < middle; ++k) {
    above = middle;
    middle = below;
    start -= h;
    below = score(start - h);
  }
  const double bend = below - 2 * middle + above;
  if (std::isfinite(bend) && bend > 0) start += std::clamp(.5 * (below - above) / bend, -.5, .5) * h;
  return start;
}

// From where smoothing shows; none if it does not help there.
template <int Dim>
std::optional<double> search(const Score<Dim>& score, double start) {
  const auto before = score.at(start);
  double first = std::log(start), value = before.gcv;
  if (before.trace > 0 && start * before.trace < shows) {
    first = std::log(shows / before.trace);
    value = score(first);
    if (!(value < (1 - flat) * before.gcv)) return {};
  }
  return std::exp(minimize(score, first, value));
}

}  // namespace

template <int Dim>
double smoothing_of_many(const Samples<Dim>& samples, const Kernel& kernel, double support, const Eigen::MatrixXd& G,
                         const SmoothingOfManyOptions& options) {
  require(options.start > 0 && std::isfinite(options.start), "smoothing_of_many", "start", options.start,
          "must be positive and finite");
  const double size = samples.values.cwiseAbs().maxCoeff();
  const double tolerance =
      std::clamp(accuracy * (size > 0 ? options.left_out / size : 1), most_accurate, least_accurate);
  std::optional<double> found;
  const Index n = samples.size();
  bool searched = false;
  if (n > 2 * subset_size) {
    std::vector<Index> some(n);
    std::iota(some.begin(), some.end(), Index{0});
    std::mt19937_64 random(2);
    for (Index k = 0; k < subset_size; ++k) std::swap(some[k], some[k + static_cast<Index>(random() % (n - k))]);
    some.resize(subset_size);
    const Eigen::MatrixXd of_some = G(some, Eigen::all);
    Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(of_some);
    qr.setThreshold(full_rank_pivot);
    searched = qr.rank() == G.cols();
    if (searched) {
      Samples<Dim> subset = chosen_samples(samples, some);
      found = search<Dim>({subset, kernel, support, of_some, tolerance}, options.start);
      report(options.progress, "choose", .5);
    }
  }
  const Score<Dim> score(samples, kernel, support, G, tolerance);
  if (!searched)
    found = search<Dim>(score, options.start);
  else if (found)
    found = std::exp(minimize(score, std::log(*found), score.at(*found).gcv));
  report(options.progress, "choose", 1);
  return found.value_or(options.start);
}

#define CSRBF_INSTANTIATE(Dim)                                                                               \
  template double smoothing_of_many<Dim>(const Samples<Dim>&, const Kernel&, double, const Eigen::MatrixXd&, \
                                         const SmoothingOfManyOptions&);
CSRBF_INSTANTIATE(1) CSRBF_INSTANTIATE(2) CSRBF_INSTANTIATE(3)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
