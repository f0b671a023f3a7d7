#include "csrbf/approx/transform/choose_transform.hpp"

#include "csrbf/approx/global/kernel_ladder.hpp"
#include "csrbf/approx/global/restricted_likelihood.hpp"
#include "csrbf/spatial/even_pairs.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

namespace csrbf {
namespace {

// Chosen by hand.
constexpr Index fewest = 30;                // samples
constexpr Index searched = 160;             // samples whose likelihood is asked for
constexpr Index blocks = 8, in_block = 50;  // samples left out, of more than these: neighbours, as dense as all are
constexpr double different_sizes = 3;       // ratio of a large value, the 95 % quantile, to a small one, that of 5 %
constexpr double unexplained = 0.05;        // error of samples left out over the deviation of the values
constexpr double clearly = 2;               // standard errors by which normal densities of samples left out gain
constexpr double much_likelier = 4;         // logarithm of the ratio of likelihoods
constexpr std::array widths = {0.02, 0.05, 0.12, 0.3, 0.8};  // where the covariance is one half, in extents
constexpr std::array nuggets = {1e-3, 0.03, 0.15, 0.5, 2.0};

bool differ_in_size(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const auto n = std::ssize(values);
  return values.front() >= 0 &&
         values[static_cast<std::size_t>(19 * n / 20)] > different_sizes * values[static_cast<std::size_t>(n / 20)];
}

// Runs of neighbours along a curve through all; all of few.
std::vector<Index> even_blocks(const std::vector<Index>& order) {
  const auto n = std::ssize(order);
  if (n <= blocks * in_block) return order;
  std::vector<Index> chosen;
  for (Index b = 0; b < blocks; ++b) {
    const auto first = order.begin() + (n - in_block) * b / (blocks - 1);
    chosen.insert(chosen.end(), first, first + in_block);
  }
  return chosen;
}

// Places in extents of all.
Eigen::MatrixXd in_extents(const SampleView& samples) {
  Eigen::MatrixXd points = samples.points;
  for (auto axis : points.rowwise()) {
    axis.array() -= axis.minCoeff();
    if (const double extent = axis.maxCoeff(); extent > 0) axis /= extent;
  }
  return points;
}

// Some of the samples, on a scale.
class Scaled {
 public:
  Scaled(Eigen::MatrixXd points, Eigen::VectorXd values, Transform transform)
      : transform_(transform),
        kernel_(kernel_ladder(static_cast<int>(points.rows()))[middle_of_ladder]),
        values_(std::move(values)),
        z_(values_.unaryExpr([&](double v) { return transformed(transform, v); })) {
    const Eigen::VectorXd differences = z_.array() - z_.mean();
    deviation_ = differences.norm() / std::sqrt(static_cast<double>(z_.size()));
    if (std::isfinite(deviation_) && deviation_ > 0)
      likelihood_.emplace(Samples<Eigen::Dynamic>{std::move(points), differences / deviation_, {}}, Replicates{});
  }

  struct Best {
    double value = std::numeric_limits<double>::infinity();  // minus the logarithm of the density of the values
    RestrictedLikelihood::Parameters at;
  };

  [[nodiscard]] Best best() const {
    Best best;
    if (!likelihood_) return best;
    const auto dimension = static_cast<Index>(kernel_.dimension());
    const double unit = std::sqrt(static_cast<double>(dimension)) / half_widths({kernel_}).front();
    RestrictedLikelihood::Parameters at;
    for (const double width : widths)
      for (const double nugget : nuggets) {
        at.log_lengths.setConstant(dimension, std::log(width * unit));
        at.log_nugget = std::log(nugget);
        if (const double value = likelihood_->value(kernel_, 0, at); value < best.value) best = {value, at};
      }
    // Values that are 0 have a root, but no density on that scale: they count as the least of the others.
    double least = std::numeric_limits<double>::infinity(), jacobian = 0;
    for (const double v : values_)
      if (v > 0) least = std::min(least, v);
    for (const double v : values_) jacobian += log_slope(transform_, std::max(v, least));
    best.value += static_cast<double>(values_.size() - 1) * std::log(deviation_) - jacobian;
    return best;
  }

  // Of each value, predicted from all others: the error, and the deviation that is expected.
  struct Prediction {
    Eigen::ArrayXd errors, deviations;

    // Minus the logarithms of normal densities.
    [[nodiscard]] Eigen::ArrayXd surprises() const { return deviations.log() + 0.5 * (errors / deviations).square(); }
  };

  [[nodiscard]] std::optional<Prediction> predict(const RestrictedLikelihood::Parameters& at) const {
    const auto left_out = likelihood_ ? likelihood_->left_out(kernel_, 0, at) : std::nullopt;
    if (!left_out) return std::nullopt;
    const double noise = deviation_ * std::sqrt(std::exp(at.log_nugget) * left_out->sigma2[0]);
    Prediction result{Eigen::ArrayXd(values_.size()), Eigen::ArrayXd(values_.size())};
    for (Index i = 0; i < values_.size(); ++i) {
      const double z = z_[i] - deviation_ * left_out->errors(i, 0);
      const double error = values_[i] - mean_value(transform_, z, noise).value;
      const double squared = squared_error(transform_, z, deviation_ * deviation_ * left_out->variances(i, 0), noise);
      result.errors[i] = error;
      result.deviations[i] = std::sqrt(squared);
    }
    return result;
  }

 private:
  Transform transform_;
  Kernel kernel_;
  Eigen::VectorXd values_, z_;
  double deviation_ = 0;
  std::optional<RestrictedLikelihood> likelihood_;
};

// How differently deviations hold for small and large values: the logarithm of the ratio of the root mean squares of
// errors in deviations.
double imbalance(const Scaled::Prediction& found, const Eigen::ArrayXd& predicted, double middle) {
  const Eigen::ArrayXd squares = (found.errors / found.deviations).square();
  const Eigen::ArrayXd is_small = (predicted < middle).cast<double>();
  const double small = (squares * is_small).sum() / is_small.sum();
  const double large = (squares * (1 - is_small)).sum() / (1 - is_small).sum();
  return std::abs(std::log(small / large)) / 2;
}

// Whether values are predicted as well from another scale, with better deviations, at small values as at large ones.
bool is_better(const Scaled::Prediction& other, const Scaled::Prediction& plain, const Eigen::ArrayXd& values) {
  if (other.errors.square().sum() > plain.errors.square().sum()) return false;
  const Eigen::ArrayXd predicted = values - plain.errors;
  std::vector<double> sorted(predicted.begin(), predicted.end());
  const auto middle = sorted.begin() + std::ssize(sorted) / 2;
  std::nth_element(sorted.begin(), middle, sorted.end());
  if (!(imbalance(other, predicted, *middle) < imbalance(plain, predicted, *middle))) return false;
  const Eigen::ArrayXd gain = plain.surprises() - other.surprises();
  const auto n = static_cast<double>(gain.size());
  return gain.mean() > clearly * std::sqrt((gain - gain.mean()).square().sum()) / n;
}

}  // namespace

Transform choose_transform(const SampleView& samples, const std::vector<Index>& order) {
  if (samples.size() < fewest || !differ_in_size({samples.values.data(), samples.values.data() + samples.size()}))
    return Transform::none;
  const Eigen::MatrixXd points = in_extents(samples);
  const std::vector<Index> some = even_pairs(order, searched), more = even_blocks(order);
  const auto likeliest = [&](Transform transform) {
    return Scaled(points(Eigen::all, some), samples.values(some, 0), transform).best();
  };
  const auto predict = [&](Transform transform, const Scaled::Best& best) {
    return Scaled(points(Eigen::all, more), samples.values(more, 0), transform).predict(best.at);
  };
  const Scaled::Best plain = likeliest(Transform::none);
  if (!std::isfinite(plain.value)) return Transform::none;
  const auto predicted = predict(Transform::none, plain);
  if (!predicted) return Transform::none;
  const Eigen::ArrayXd values = samples.values(more, 0);
  if (predicted->errors.square().sum() < std::pow(unexplained, 2) * (values - values.mean()).square().sum())
    return Transform::none;
  Transform chosen = Transform::none;
  double least = predicted->surprises().sum();
  for (const Transform transform : {Transform::square_root, Transform::logarithm}) {
    const Scaled::Best best = likeliest(transform);
    if (!(best.value < plain.value - much_likelier)) continue;
    const auto other = predict(transform, best);
    if (!other || !is_better(*other, *predicted, values) || other->surprises().sum() >= least) continue;
    least = other->surprises().sum();
    chosen = transform;
  }
  return chosen;
}

}  // namespace csrbf
