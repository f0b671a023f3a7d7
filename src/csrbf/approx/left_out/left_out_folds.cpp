#include "csrbf/approx/left_out/left_out_folds.hpp"

#include "csrbf/core/error.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <utility>

namespace csrbf {
namespace {

// Chosen by hand.
constexpr Index folds = 5;
constexpr double as_expected = 4;     // samples that errors are as expected of, before any is left out
constexpr double rounding = 1e-15;    // of the largest value
constexpr double largest_ratio = 36;  // of a squared error to its variance: what one sample can say

}  // namespace

template <int Dim>
Eigen::VectorXd left_out_folds(const Samples<Dim>& samples,
                               const std::function<FittedParts<Dim>(const Samples<Dim>&)>& fit) {
  const Index n = samples.size(), C = samples.components();
  if (n < folds) return Eigen::VectorXd::Ones(C);
  std::vector<Index> order(static_cast<std::size_t>(n));
  std::iota(order.begin(), order.end(), Index{0});
  std::mt19937_64 random(1);  // its sequence is fixed by the standard
  for (Index i = n - 1; i > 0; --i) std::swap(order[i], order[random() % static_cast<std::uint64_t>(i + 1)]);
  Eigen::ArrayXd ratios = Eigen::ArrayXd::Zero(C);
  for (Index k = 0; k < folds; ++k) {
    std::vector<Index> left_out, others;
    for (Index i = 0; i < n; ++i) (i % folds == k ? left_out : others).push_back(order[i]);
    FittedParts<Dim> parts;
    try {
      parts = fit(chosen_samples(samples, others));
    } catch (const SolverFailure&) {
    } catch (const InvalidInput&) {  // too few for the degree that is asked for
    }
    if (std::ssize(parts.variances) < C) return Eigen::VectorXd::Ones(C);
    const Points<Dim> places = samples.points(Eigen::all, left_out);
    for (Index c = 0; c < C; ++c) {
      const auto number = static_cast<std::size_t>(c);
      const Eigen::VectorXd values = samples.values(left_out, c);
      const Eigen::ArrayXd squares = (values - parts.components[number]->evaluate(places).value).array().square();
      const Eigen::ArrayXd expected = parts.variances[number]->evaluate(places).value;
      const double nothing = std::pow(rounding * samples.values.col(c).cwiseAbs().maxCoeff(), 2);
      for (Index k = 0; k < squares.size(); ++k)
        if (squares[k] > nothing)
          ratios[c] += squares[k] < largest_ratio * expected[k] ? squares[k] / expected[k] : largest_ratio;
    }
  }
  return ((as_expected + ratios) / (as_expected + static_cast<double>(n))).max(1.0).matrix();
}

#define CSRBF_INSTANTIATE(Dim)                                      \
  template Eigen::VectorXd left_out_folds<Dim>(const Samples<Dim>&, \
                                               const std::function<FittedParts<Dim>(const Samples<Dim>&)>&);
CSRBF_FOR_MANY_DIMS(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
