#include "csrbf/approx/left_out/left_out_blocks.hpp"

#include "csrbf/approx/basis/polynomial_block.hpp"
#include "csrbf/approx/basis/radial_basis.hpp"
#include "csrbf/core/percentile.hpp"
#include "csrbf/linalg/decompositions.hpp"
#include "csrbf/linalg/dense_cholesky.hpp"
#include "csrbf/spatial/even_pairs.hpp"
#include "csrbf/spatial/kd_tree.hpp"
#include "csrbf/spatial/morton_order.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>

namespace csrbf {
namespace {

// Chosen by hand.
constexpr Index fewest_samples = 16, few_samples_used = 400, most_samples_used = 800;
constexpr double used_share = 0.4;                                      // of the samples, where that is more
constexpr std::array<double, 5> shares = {0.02, 0.05, 0.1, 0.2, 0.33};  // of them in a block
constexpr double largest_ball = 0.2;                                    // the same, around a sample
constexpr int orders_each = 3;
constexpr Index most_targets = 30;  // samples predicted in a block
constexpr double alike = 4;         // errors of a block that tell as much as one
constexpr double share_within = 0.95, within = 1.96;
constexpr double largest_factor = 1e8, least_distance = 2;
constexpr std::array<double, 5> shares_of_distances = {0.05, 0.25, 0.5, 0.75, 0.95};  // that growth may end at
constexpr double largest_square = 100;  // of an error over its deviation, that counts where growths are compared

// What samples in blocks say.
struct Errors {
  std::vector<double> distances;             // P^2 over what is usual
  std::vector<std::vector<double>> factors;  // by component: of P^2, that take an error to the end of its interval
};

// One system, some of whose samples are left out.
template <int Dim>
class Blocks {
 public:
  // All must outlive it.
  Blocks(const Samples<Dim>& samples, const InterpolateOptions& options, const Eigen::VectorXd& sigma2)
      : samples_(samples),
        sigma2_(sigma2),
        inverse_weights_(samples.all_weights().cwiseInverse()),
        smoothing_(options.smoothing.value_or(0)) {
    const Kernel kernel(options.kernel, Dim, options.parameter);
    K_ = RadialBasis<Dim>(kernel, samples.points, Eigen::VectorXd::Constant(1, options.support))
             .dense_matrix(samples.points);
    G_ = polynomial_block<Dim>(samples.points, std::max(options.degree, -1), RankDeficiency::reduce).G;
  }

  // Blocks of the deepest samples.
  void leave_out(const Eigen::VectorXd& depth, double largest, Errors& errors) {
    std::vector<Index> order(static_cast<std::size_t>(depth.size()));
    std::iota(order.begin(), order.end(), Index{0});
    std::stable_sort(order.begin(), order.end(), [&](Index i, Index j) { return depth[i] < depth[j]; });
    Eigen::MatrixXd L;
    const double nugget = factorize(order, L);
    if (!(nugget < std::numeric_limits<double>::infinity())) return;
    if (usual_ == 0) usual_ = usual(L, nugget);
    Eigen::MatrixXd white(L.rows(), G_.cols() + samples_.components());
    white << G_(order, Eigen::all), samples_.values(order, Eigen::all);
    solve_lower_in_place(L, white);
    for (const double share : shares)
      if (share <= largest)
        leave_out_last(std::lround(share * static_cast<double>(L.rows())), order, L, white, nugget, errors);
  }

 private:
  // The Cholesky factor of the system in an order; returns its nugget, which grows where rounding makes it singular.
  double factorize(const std::vector<Index>& order, Eigen::MatrixXd& L) const {
    constexpr double least = 1e-15, most = 1e-8;
    for (double nugget = smoothing_; nugget <= std::max(most, smoothing_); nugget = std::max(10 * nugget, least)) {
      L = K_(order, order);
      L.diagonal() += nugget * inverse_weights_(order);
      if (cholesky_in_place(L)) return nugget;
    }
    return std::numeric_limits<double>::infinity();
  }

  // As PowerFunction::usual(), but for the trend.
  double usual(const Eigen::MatrixXd& L, double nugget) const {
    constexpr Index some = 64;
    constexpr double share = 0.9, epsilon = std::numeric_limits<double>::epsilon();
    const Index n = L.rows(), count = std::min(n, some);
    Eigen::MatrixXd units = Eigen::MatrixXd::Zero(n, count);
    for (Index k = 0; k < count; ++k) units((2 * k + 1) * n / (2 * count), k) = 1;
    solve_lower_in_place(L, units);
    std::vector<double> without;
    for (const auto& unit : units.colwise()) without.push_back(1 / unit.squaredNorm() - nugget);
    return std::max({percentile(without, share), smoothing_, static_cast<double>(n) * epsilon * K_(0, 0)});
  }

  // What the samples before say of the last ones: with these rows w of L^-1 times the values, less the trend of the
  // others, their errors are L w, with the covariance L L^T of the block L in the corner.
  void leave_out_last(Index count, const std::vector<Index>& order, const Eigen::MatrixXd& L,
                      const Eigen::MatrixXd& white, double nugget, Errors& errors) const {
    const Index others = L.rows() - count, r = G_.cols(), C = samples_.components();
    if (count < 1 || count >= others || others <= r) return;
    const Eigen::MatrixXd corner = L.bottomRightCorner(count, count).template triangularView<Eigen::Lower>();
    Eigen::MatrixXd off = white.bottomRightCorner(count, C);
    Eigen::VectorXd variance = corner.rowwise().squaredNorm();
    if (r > 0) {
      const Eigen::MatrixXd trend = white.topLeftCorner(others, r), own = white.bottomLeftCorner(count, r);
      const Eigen::LLT<Eigen::MatrixXd> information(Eigen::MatrixXd(trend.transpose() * trend));
      if (information.info() != Eigen::Success) return;
      Eigen::MatrixXd pi = trend.transpose() * white.topRightCorner(others, C);
      solve_lower(information, pi);
      solve_upper(information, pi);
      off -= own * pi;
      Eigen::MatrixXd doubt = (corner * own).transpose();
      solve_lower(information, doubt);
      variance += doubt.colwise().squaredNorm().transpose();
    }
    off = (corner * off).eval();
    const Index targets = std::min(count, most_targets);
    for (Index t = 0; t < targets; ++t) {
      const Index k = (2 * t + 1) * count / (2 * targets);
      const double noise = nugget * inverse_weights_[order[static_cast<std::size_t>(others + k)]];
      const double power2 = variance[k] - noise;
      if (!(power2 > usual_)) continue;
      errors.distances.push_back(power2 / usual_);
      for (Index c = 0; c < C; ++c) {
        const double half = off(k, c) / within, sigma2 = sigma2_[c];
        errors.factors[static_cast<std::size_t>(c)].push_back(
            sigma2 > 0 ? (half * half - sigma2 * noise) / (sigma2 * power2) : 0);
      }
    }
  }

  const Samples<Dim>& samples_;
  const Eigen::VectorXd& sigma2_;
  Eigen::VectorXd inverse_weights_;
  double smoothing_, usual_ = 0;
  Eigen::MatrixXd K_, G_;
};

// Of a function that is not smooth, samples say nothing of what happens between those that are closest: a step of the
// function, or noise. Rounding alone for smooth ones, whose slope tells it.
template <int Dim>
double least_tried(const Samples<Dim>& samples, const InterpolateOptions& options) {
  constexpr double rounding = 1e-16;
  const Kernel kernel(options.kernel, Dim, options.parameter);
  if (kernel.smoothness() > 0 || samples.size() < 2 || options.support <= 0) return rounding;
  const KdTree<Dim> tree(samples.points);
  double least2 = std::numeric_limits<double>::infinity();
  for (Index i = 0; i < samples.size(); ++i) {
    std::array<Index, 2> nearest = {};
    std::array<double, 2> r2 = {};
    tree.nearest(samples.points.col(i), 2, nearest.data(), r2.data());
    least2 = std::min(least2, r2[1]);
  }
  return std::clamp(1 - kernel.value(std::sqrt(least2) / options.support), rounding, 1.0);
}

// The factors but for growth with an exponent, by logarithms of distances.
std::vector<double> without_growth(const std::vector<double>& factors, const Eigen::ArrayXd& logs, double exponent) {
  const Eigen::ArrayXd growth = (exponent * logs).exp();
  std::vector<double> rest(factors);
  for (std::size_t k = 0; k < rest.size(); ++k) rest[k] /= growth[static_cast<Index>(k)];
  return rest;
}

// Of the growths with which 95 % of the errors are within, the one by which all are likeliest.
void learn(const Errors& errors, const Eigen::VectorXd& sigma2, std::vector<ErrorGrowth>& growth) {
  const auto count = std::ssize(errors.distances);
  if (count < fewest_samples) return;
  const Eigen::ArrayXd logs = Eigen::Map<const Eigen::ArrayXd>(errors.distances.data(), count).log();
  const double doubt = 2 * std::sqrt(share_within * (1 - share_within) * alike / static_cast<double>(count));
  for (std::size_t c = 0; c < growth.size(); ++c) {
    const std::vector<double>& factors = errors.factors[c];
    std::vector<double> sorted(factors);
    if (!(sigma2[static_cast<Index>(c)] > 0) || !(percentile(sorted, share_within - doubt) > 1)) continue;
    double least = std::numeric_limits<double>::infinity();
    for (const double share : shares_of_distances) {
      std::vector<double> distances(errors.distances);
      const double distance = std::max(percentile(distances, share), least_distance), log = std::log(distance);
      const Eigen::ArrayXd near = logs.min(log);
      double low = 0, high = std::log(largest_factor) / log;
      constexpr int halvings = 20;
      for (int k = 0; k < halvings; ++k) {
        const double middle = (low + high) / 2;
        std::vector<double> rest = without_growth(factors, near, middle);
        (percentile(rest, share_within) > 1 ? low : high) = middle;
      }
      double score = high * near.sum();
      for (const double factor : without_growth(factors, near, high))
        score += std::clamp(within * within * factor, 0.0, largest_square);
      if (!(score < least)) continue;
      least = score;
      growth[c].distance = distance;
      growth[c].factor = std::exp(high * log);
    }
  }
}

}  // namespace

template <int Dim>
std::vector<ErrorGrowth> left_out_blocks(const Samples<Dim>& all, const InterpolateOptions& options,
                                         const Eigen::VectorXd& sigma2) {
  const Samples<Dim> samples = without_zero_weights(all);
  const Index n = samples.size(), C = samples.components();
  std::vector<ErrorGrowth> growth(static_cast<std::size_t>(C), ErrorGrowth{.least = least_tried(samples, options)});
  if (n < fewest_samples || !(sigma2.maxCoeff() > 0)) return growth;
  const Index used =
      std::clamp(static_cast<Index>(used_share * static_cast<double>(n)), few_samples_used, most_samples_used);
  const Samples<Dim> some = chosen_samples(samples, even_samples(morton_order<Dim>(samples.points), used));
  Blocks<Dim> blocks(some, options, sigma2);
  Errors errors;
  errors.factors.resize(static_cast<std::size_t>(C));
  std::mt19937_64 random(1);  // its sequence is fixed by the standard
  const auto uniform = [&] { return std::ldexp(static_cast<double>(random()), -64); };
  // Beyond the ends of a line more is unknown than in its gaps, of which blocks there would say too much.
  for (int k = 0; k < (Dim == 1 ? 0 : orders_each); ++k) {
    Point<Dim> direction;
    for (double& d : direction) d = uniform() - 0.5;
    blocks.leave_out(some.points.transpose() * direction, 1, errors);
  }
  for (int k = 0; k < orders_each; ++k) {
    const Point<Dim> middle = some.points.col(static_cast<Index>(uniform() * static_cast<double>(some.size())));
    blocks.leave_out(-(some.points.colwise() - middle).colwise().squaredNorm().transpose(), largest_ball, errors);
  }
  learn(errors, sigma2, growth);
  return growth;
}

#define CSRBF_INSTANTIATE(Dim)                                                                           \
  template std::vector<ErrorGrowth> left_out_blocks<Dim>(const Samples<Dim>&, const InterpolateOptions&, \
                                                         const Eigen::VectorXd&);
CSRBF_FOR_MANY_DIMS(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
