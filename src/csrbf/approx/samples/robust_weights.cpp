#include "csrbf/approx/samples/robust_weights.hpp"

#include "csrbf/approx/samples/local_deviations.hpp"
#include "csrbf/approx/samples/separate_tail.hpp"
#include "csrbf/spatial/kd_tree.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

namespace csrbf {
namespace {

// Chosen by hand.
constexpr double gross = 8;               // deviations of a gross error, at least
constexpr std::size_t near = 4;           // neighbours that tell peaks from errors
constexpr double most_of_one = 3;         // deviations that one of them counts for, at most
constexpr double peak = 0.05;             // height of a peak at the neighbours, on average
constexpr double same_side = 2.5;         // deviations of their sum, over what it has by chance
constexpr Index all_at_once = 2000;       // samples that are all looked at
constexpr Index blocks = 8, block = 256;  // of neighbours, beyond
constexpr double huber = 1.345;           // deviation up to which samples have their weight (Huber 1981)
constexpr double student_degrees = 4;     // of freedom (Lange et al. 1989)

// The samples nearest to a few of them: O(n) for each.
template <int Dim>
bool any_in_blocks(const Samples<Dim>& samples) {
  const Index n = samples.size();
  Eigen::VectorXd r2(n);
  std::vector<Index> order(static_cast<std::size_t>(n));
  for (Index k = 0; k < blocks; ++k) {
    r2 = (samples.points.colwise() - samples.points.col((2 * k + 1) * n / (2 * blocks))).colwise().squaredNorm();
    std::iota(order.begin(), order.end(), Index{0});
    std::nth_element(order.begin(), order.begin() + block, order.end(),
                     [&](Index a, Index b) { return r2[a] < r2[b]; });
    const std::vector<Index> chosen(order.begin(), order.begin() + block);
    Samples<Dim> some{samples.points(Eigen::all, chosen), samples.values(chosen, Eigen::all), {}};
    if (samples.weights.size() > 0) some.weights = samples.weights(chosen);
    std::vector<Index> all(chosen.size());
    std::iota(all.begin(), all.end(), Index{0});
    if (local_deviations(some, all).cwiseAbs().maxCoeff() > gross) return true;
  }
  return false;
}

// Far samples whose neighbours are off to the same side, though less, are on a peak, and no errors.
template <int Dim>
void keep_peaks(const Samples<Dim>& samples, const Eigen::VectorXd& differences, Eigen::VectorXd& factors) {
  const KdTree<Dim> tree(samples.points);
  const Eigen::VectorXd found = factors;
  std::array<Index, near + 1> nearest{};
  std::array<double, near + 1> r2{};
  for (Index i = 0; i < factors.size(); ++i) {
    if (found[i] > 0) continue;
    const Index count = tree.nearest(samples.points.col(i), near + 1, nearest.data(), r2.data());
    const double side = std::copysign(1.0, differences[i]);
    double sum = 0, height = 0, used = 0;
    for (Index k = 0; k < count; ++k) {
      const Index j = nearest[static_cast<std::size_t>(k)];
      if (j == i) continue;
      sum += std::clamp(side * differences[j], -most_of_one, most_of_one);
      height += side * differences[j];
      used += 1;
    }
    const bool is_wide = height > peak * used * std::abs(differences[i]);
    if (used > 0 && sum > same_side * std::sqrt(used) && is_wide) factors[i] = 1;
  }
}

}  // namespace

template <int Dim>
RobustWeights robust_weights(const Samples<Dim>& samples, const std::string& loss) {
  const Index n = samples.size();
  if (loss == "squares") return {};
  if (loss == "auto" && n > all_at_once && !any_in_blocks(samples)) return {};
  std::vector<Index> all(static_cast<std::size_t>(n));
  std::iota(all.begin(), all.end(), Index{0});
  const Eigen::VectorXd differences = local_deviations(samples, all);
  const Eigen::ArrayXd deviation = differences.array().abs();
  RobustWeights result;
  if (loss == "auto") {
    const std::optional<double> limit = separate_tail(deviation);
    if (!limit) return {};
    result.factors = (deviation <= std::max(*limit, gross)).template cast<double>();
    keep_peaks(samples, differences, result.factors);
    if (result.factors.minCoeff() > 0) return {};
  } else if (loss == "huber") {
    result.factors = huber / deviation.max(huber);
  } else {
    result.factors = (student_degrees + 1) / (student_degrees + deviation.max(1.0).square());
  }
  for (Index i = 0; i < n; ++i)
    if (result.factors[i] < .5) result.gross_errors.push_back(i);
  return result;
}

std::optional<double> value_beyond_all_others(const Eigen::Ref<const Eigen::VectorXd>& values,
                                              std::optional<double> known) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  constexpr double far = 3;  // ranges of the others; chosen by hand
  constexpr std::array<double, 9> usual = {-99, -999, -9999, -99999, 9999, 99999, -32768, 1e20, 1e30};
  for (const double sign : {1.0, -1.0}) {
    double largest = -infinity, next = -infinity, smallest = infinity;
    Index count = 0;
    for (const double v : values) {
      if (known && v == *known) continue;
      const double value = sign * v;
      smallest = std::min(smallest, value);
      if (value > largest) {
        next = std::exchange(largest, value);
        count = 1;
      } else if (value == largest) {
        ++count;
      } else {
        next = std::max(next, value);
      }
    }
    if (!(next > -infinity) || !(largest - next > far * (next - smallest))) continue;
    const double value = sign * largest;
    const bool is_usual = std::find(usual.begin(), usual.end(), value) != usual.end();
    const bool others_differ = next > smallest;
    if (others_differ && (is_usual || count > 1)) return value;
  }
  return std::nullopt;
}

#define CSRBF_INSTANTIATE(Dim) template RobustWeights robust_weights<Dim>(const Samples<Dim>&, const std::string&);
CSRBF_FOR_EACH_DIM(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
