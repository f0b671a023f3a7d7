#include "csrbf/approx/kriging/covariance.hpp"

#include "csrbf/core/parallel.hpp"
#include "csrbf/linalg/decompositions.hpp"
#include "csrbf/linalg/golden_section.hpp"
#include "csrbf/linalg/simplex_search.hpp"
#include "csrbf/spatial/squared_distances.hpp"

#include <array>
#include <cmath>
#include <limits>
#include <numeric>

namespace csrbf {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
// Chosen by hand: more tell more about the covariance and cost more time.
constexpr Index block_size = 64;
constexpr Index blocks_per_level = 8;
constexpr double least_nugget = 1e-11;  // some hundred roundings: keeps smooth kernels positive definite
constexpr double largest_nugget = 1e3;  // noise alone
constexpr double largest_length = 20;   // in extents of the samples: longer ones look the same within them
constexpr double first_length = 0.3;    // in the same unit
constexpr double first_nugget = 1e-3;

// Neighbouring samples.
struct Block {
  Index n = 0;
  Eigen::VectorXd r2;      // squared distances, lower triangle by columns, in squared extents of the samples
  Eigen::MatrixXd values;  // in units of their deviations
  Eigen::VectorXd inverse_weights;
};

template <int Dim>
std::vector<Block> make_blocks(const Samples<Dim>& samples, const ThinnedLevels<Dim>& levels,
                               const Eigen::RowVectorXd& units, double extent, std::size_t count) {
  std::vector<Block> blocks;
  const auto add = [&](const std::vector<Index>& chosen) {
    Block block;
    block.n = static_cast<Index>(chosen.size());
    Points<Dim> x(Dim, block.n);
    for (Index i = 0; i < block.n; ++i)
      for (int a = 0; a < Dim; ++a) x(a, i) = samples.points(a, chosen[static_cast<std::size_t>(i)]) / extent;
    block.r2.resize(block.n * (block.n + 1) / 2);
    for (Index j = 0, at = 0; j < block.n; at += block.n - j, ++j)
      squared_distances<Dim>(x.data() + Dim * j, block.n - j, x.col(j), block.r2.data() + at);
    block.values = samples.values(chosen, Eigen::all) * units.cwiseInverse().asDiagonal();
    block.inverse_weights.resize(block.n);
    for (Index i = 0; i < block.n; ++i) block.inverse_weights[i] = 1 / samples.weight(chosen[i]);
    blocks.push_back(std::move(block));
  };
  for (const auto& level : levels.levels()) {
    if (count-- == 0) break;
    const auto n = static_cast<Index>(level.indices.size());
    if (n <= 2 * block_size) {
      add(level.indices);
      continue;
    }
    std::vector<Index> nearest(block_size), chosen(block_size);
    std::vector<double> r2(block_size);
    for (Index k = 0; k < blocks_per_level; ++k) {
      level.tree->nearest(level.points.col((2 * k + 1) * n / (2 * blocks_per_level)), block_size, nearest.data(),
                          r2.data());
      for (std::size_t i = 0; i < chosen.size(); ++i) chosen[i] = level.indices[static_cast<std::size_t>(nearest[i])];
      add(chosen);
    }
  }
  return blocks;
}

template <int Dim>
struct Values {
  double extent;             // of the samples
  Eigen::RowVectorXd units;  // deviations of the values, or 1

  explicit Values(const Samples<Dim>& samples)
      : extent(std::max(bounding_box<Dim>(samples.points).extent().maxCoeff(), 1e-300)) {
    const Eigen::RowVectorXd mean = samples.values.colwise().mean();
    units = (samples.values.rowwise() - mean).colwise().stableNorm();
    for (double& unit : units) unit = unit > 0 ? unit / std::sqrt(static_cast<double>(samples.size())) : 1;
  }
};

// What a block says about a covariance.
struct Evidence {
  double log_determinant = infinity;
  Eigen::VectorXd squares;  // of the whitened residuals, by component
  double degrees = 0;       // of freedom
};

class Likelihood {
 public:
  explicit Likelihood(std::vector<Block> blocks) : blocks_(std::move(blocks)) {}

  // Minus the logarithm, sigma^2 at its best; that goes to `sigma2`.
  double operator()(const Kernel& kernel, double length, double nugget, Eigen::VectorXd* sigma2 = nullptr) const {
    std::vector<Evidence> parts(blocks_.size());
    parallel_for(std::ssize(blocks_), 4, [&](Index begin, Index end) {
      for (Index b = begin; b < end; ++b) parts[b] = evidence(blocks_[b], kernel, length, nugget);
    });
    Eigen::VectorXd squares = Eigen::VectorXd::Zero(blocks_.front().values.cols());
    double log_determinant = 0, degrees = 0;
    for (const Evidence& part : parts) {
      if (!(part.log_determinant < infinity)) return infinity;
      log_determinant += part.log_determinant;
      squares += part.squares;
      degrees += part.degrees;
    }
    squares /= degrees;
    if (sigma2 != nullptr) *sigma2 = squares;
    constexpr double tiny = 1e-30;  // of a component without any variation
    return .5 *
           (degrees * squares.array().max(tiny).log().sum() + static_cast<double>(squares.size()) * log_determinant);
  }

 private:
  static Eigen::MatrixXd matrix(const Block& block, const Kernel& kernel, double length, double nugget) {
    const Eigen::VectorXd scaled = block.r2 / (length * length);
    Eigen::VectorXd phi(scaled.size());
    kernel.values(scaled.data(), scaled.size(), phi.data());
    Eigen::MatrixXd K(block.n, block.n);
    for (Index j = 0, at = 0; j < block.n; at += block.n - j, ++j) {
      K.col(j).tail(block.n - j) = phi.segment(at, block.n - j);
      K.row(j).tail(block.n - j) = phi.segment(at, block.n - j).transpose();
    }
    K.diagonal() += nugget * block.inverse_weights;
    return K;
  }

  static Evidence evidence(const Block& block, const Kernel& kernel, double length, double nugget) {
    Eigen::MatrixXd K = matrix(block, kernel, length, nugget);
    const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> llt(K);
    Evidence result;
    if (llt.info() != Eigen::Success) return result;
    Eigen::MatrixXd white(block.n, 1 + block.values.cols());
    white << Eigen::VectorXd::Ones(block.n), block.values;
    solve_lower(llt, white);
    const double information = white.col(0).squaredNorm();
    const Eigen::RowVectorXd mean = white.col(0).transpose() * white.rightCols(block.values.cols()) / information;
    result.squares = (white.rightCols(block.values.cols()) - white.col(0) * mean).colwise().squaredNorm().transpose();
    result.log_determinant = 2 * K.diagonal().array().log().sum() + std::log(information);
    result.degrees = static_cast<double>(block.n - 1);
    return result;
  }

  std::vector<Block> blocks_;
};

struct Model {
  const char* kernel;
  double parameter = std::numeric_limits<double>::quiet_NaN();
};
// From rough to smooth.
constexpr std::array<Model, 6> models = {
    {{"powered-exponential", 0.7}, {"matern-c0"}, {"matern-c2"}, {"matern-c4"}, {"matern-c6"}, {"gaussian"}}};
constexpr std::size_t middle_model = 2;

template <int Dim>
Kernel kernel_of(std::size_t model) {
  return Kernel(models[model].kernel, Dim, models[model].parameter);
}

}  // namespace

double prediction_variance(const Covariance& covariance, Index component, double share, double scale) {
  const double inflation = covariance.inflation.size() > 0 ? covariance.inflation[component] : 1;
  const double sigma2 =
      std::pow(covariance.sigma2[component], 1 - covariance.local) * std::pow(scale, covariance.local);
  return inflation * std::pow(share, covariance.growth) * sigma2;
}

template <int Dim>
Covariance with_nearby_nugget(const Samples<Dim>& samples, const ThinnedLevels<Dim>& levels, Covariance covariance) {
  constexpr int steps = 12;
  const Values<Dim> values(samples);
  const Likelihood likelihood(make_blocks(samples, levels, values.units, values.extent, 1));
  const auto minus_log = [&](double log_nugget) {
    return likelihood(covariance.kernel, covariance.length / values.extent, std::exp(log_nugget));
  };
  const double exact = std::log(least_nugget);
  const double best = golden_section(minus_log, exact, std::log(largest_nugget), steps);
  covariance.nugget = std::exp(minus_log(best) < minus_log(exact) ? best : exact);
  return covariance;
}

template <int Dim>
Covariance estimate_covariance(const Samples<Dim>& samples, const ThinnedLevels<Dim>& levels) {
  const Values<Dim> values(samples);
  const double extent = values.extent;
  const Eigen::RowVectorXd& units = values.units;
  const Likelihood likelihood(make_blocks(samples, levels, units, extent, levels.levels().size()));
  struct Found {
    SimplexMinimum minimum;
    bool tried = false;
  };
  std::array<Found, models.size()> found;
  const auto attempt = [&](std::size_t m, const Eigen::VectorXd& start, const Eigen::VectorXd& steps) {
    if (found[m].tried) return found[m].minimum.value;
    const Kernel kernel = kernel_of<Dim>(m);
    found[m] = {simplex_search(
                    [&](const Eigen::VectorXd& x) {
                      const double length = std::exp(x[0]), nugget = std::exp(x[1]);
                      if (length > largest_length || nugget > largest_nugget) return infinity;
                      return likelihood(kernel, length, std::max(nugget, least_nugget));
                    },
                    start, steps, {.evaluations = 50, .tolerance = 0.1}),
                true};
    return found[m].minimum.value;
  };
  // From a kernel of middle smoothness to rougher or smoother ones as long as they are better.
  std::size_t best = middle_model;
  attempt(best, Eigen::Vector2d(std::log(first_length), std::log(first_nugget)), Eigen::Vector2d(-1.5, -4));
  for (const int step : {1, -1}) {
    for (;;) {
      const std::size_t next = best + static_cast<std::size_t>(step);
      if (next >= models.size()) break;
      if (!(attempt(next, found[best].minimum.x, Eigen::Vector2d(-0.7, 1.5)) < found[best].minimum.value)) break;
      best = next;
    }
    if (best != middle_model) break;
  }
  Covariance result{.kernel = kernel_of<Dim>(best), .sigma2 = {}};
  const double length = std::exp(found[best].minimum.x[0]);
  result.nugget = std::max(std::exp(found[best].minimum.x[1]), least_nugget);
  likelihood(result.kernel, length, result.nugget, &result.sigma2);
  result.degree = result.kernel.is_rough() ? 1 : 0;
  result.length = length * extent;
  result.sigma2.array() *= units.transpose().array().square();
  return result;
}

#define CSRBF_INSTANTIATE(Dim)                                                                             \
  template Covariance with_nearby_nugget<Dim>(const Samples<Dim>&, const ThinnedLevels<Dim>&, Covariance); \
  template Covariance estimate_covariance<Dim>(const Samples<Dim>&, const ThinnedLevels<Dim>&);
CSRBF_FOR_MANY_DIMS(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
