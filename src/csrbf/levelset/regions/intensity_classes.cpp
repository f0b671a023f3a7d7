#include "csrbf/levelset/regions/intensity_classes.hpp"

#include "csrbf/core/error.hpp"

namespace csrbf {
namespace {

// The bins that are not empty, and what any run of them costs as one class.
class Runs {
 public:
  explicit Runs(const Histogram& histogram) : shift_(histogram.mean()) {
    for (Index k = 0; k < std::ssize(histogram.counts); ++k) {
      const double count = histogram.counts[k];
      if (count <= 0) continue;
      const double x = histogram.bins.center(k) - shift_;  // small numbers: little is lost in the difference below
      sums_.push_back(sums_.back() + Sums(count, count * x, count * x * x));
    }
  }
  [[nodiscard]] Index size() const { return std::ssize(sums_) - 1; }
  /// Mean of the bins begin to end - 1.
  [[nodiscard]] double mean(Index begin, Index end) const {
    const Sums s = sum(begin, end);
    return shift_ + s[1] / s[0];
  }
  [[nodiscard]] double cost(Index begin, Index end) const {
    const Sums s = sum(begin, end);
    return end - begin == 1 ? 0 : std::max(0.0, s[2] - s[1] * s[1] / s[0]);
  }

 private:
  using Sums = Eigen::Vector3d;
  [[nodiscard]] Sums sum(Index begin, Index end) const { return sums_[end] - sums_[begin]; }
  double shift_;
  std::vector<Sums> sums_{Sums::Zero()};
};

}  // namespace

IntensityClasses optimal_classes(const Histogram& histogram, Index classes) {
  const Runs runs(histogram);
  const Index n = runs.size();
  require(classes >= 1 && classes <= n, "optimal_classes", "classes", classes,
          "must be 1 to the number of different intensities, " + std::to_string(n));

  // best(c, j): least energy of c + 1 classes of the first j bins; start(c, j): where the last of them starts.
  constexpr double infinity = std::numeric_limits<double>::infinity();
  Eigen::MatrixXd best = Eigen::MatrixXd::Constant(classes, n + 1, infinity);
  Eigen::Matrix<Index, Eigen::Dynamic, Eigen::Dynamic> start =
      Eigen::Matrix<Index, Eigen::Dynamic, Eigen::Dynamic>::Zero(classes, n + 1);
  for (Index j = 1; j <= n; ++j) best(0, j) = runs.cost(0, j);
  for (Index c = 1; c < classes; ++c) {
    // Of the last class only the partition of all bins is needed.
    for (Index j = c + 1 < classes ? c + 1 : n; j <= n; ++j) {
      for (Index i = c; i < j; ++i) {
        const double energy = best(c - 1, i) + runs.cost(i, j);
        if (energy >= best(c, j)) continue;
        best(c, j) = energy;
        start(c, j) = i;
      }
    }
  }

  IntensityClasses result;
  result.energy = best(classes - 1, n);
  result.means.resize(classes);
  Index end = n;
  for (Index c = classes - 1; c >= 0; --c) {
    const Index begin = start(c, end);
    result.means[c] = runs.mean(begin, end);
    end = begin;
  }
  for (std::size_t c = 0; c + 1 < result.means.size(); ++c)
    result.thresholds.push_back(.5 * (result.means[c] + result.means[c + 1]));
  return result;
}

}  // namespace csrbf
