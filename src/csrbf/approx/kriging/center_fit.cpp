#include "csrbf/approx/kriging/center_fit.hpp"

#include "csrbf/approx/basis/polynomial_block.hpp"
#include "csrbf/approx/kriging/center_equations.hpp"
#include "csrbf/approx/samples/merge_duplicates.hpp"
#include "csrbf/approx/unity/held_out_error.hpp"
#include "csrbf/linalg/golden_section.hpp"
#include "csrbf/spatial/chosen_points.hpp"
#include "csrbf/spatial/farthest_points.hpp"
#include "csrbf/spatial/morton_order.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace csrbf {
namespace {

// Chosen by hand.
constexpr Index most_centers = 2000;
constexpr double smallest_nugget = 1e-14;

// What is the same for any number of centres. Points are in the lengths of the covariance.
template <int Dim>
class CenterSearch {
 public:
  CenterSearch(const Samples<Dim>& samples, const AxisCovariance<Dim>& covariance, const CenterOptions& options)
      : covariance_(covariance), options_(options), nugget_(covariance.nugget) {
    if (!(nugget_ > smallest_nugget)) {  // none was found: any
      nugget_ = std::sqrt(smallest_nugget);
      range_ = -std::log(nugget_);
    }
    const auto n = static_cast<double>(samples.size());
    const Eigen::VectorXd weights = samples.all_weights();
    mean_ = weights.transpose() * samples.values / weights.sum();
    most_ = std::min({most_centers, static_cast<Index>(std::sqrt(options.affordable / n)), samples.size() / 2});
    if (most_ < fewest_centers) return;
    const Points<Dim> places = in_lengths<Dim>(samples.points, covariance);
    trend_ = polynomial_block<Dim>(places, std::max(0, covariance.degree), RankDeficiency::reduce);
    centers_ = chosen_points<Dim>(places, farthest_points<Dim>(places, most_).indices);
    most_ = centers_.cols();
  }

  [[nodiscard]] bool is_affordable() const { return most_ >= fewest_centers; }

  // Samples in the lengths of the covariance.
  [[nodiscard]] Samples<Dim> in_place(const Samples<Dim>& samples) const {
    return {in_lengths<Dim>(samples.points, covariance_), samples.values, samples.weights};
  }

  // The equations of all samples for as many centres as some of them ask for; none where no number is good enough, or
  // the centres are dependent by rounding.
  [[nodiscard]] std::optional<CenterEquations<Dim>> find(const Samples<Dim>& samples) {
    const Samples<Dim> all = in_place(samples), some = spread_over(all);
    std::optional<CenterEquations<Dim>> found;
    double before = std::numeric_limits<double>::infinity(), best = before;
    double nugget = nugget_;
    Index chosen = 0;
    for (Index m = fewest_centers; chosen < most_; m = std::min(2 * m, most_)) {
      report(options_.progress, "solve", static_cast<double>(m) / static_cast<double>(2 * most_));
      std::optional<CenterEquations<Dim>> equations = equations_for(m, some);
      const std::optional<CenterFit<Dim>> fit = equations ? solve(*equations, some, false) : std::nullopt;
      if (!fit) break;
      const bool is_better = fit->error < (1 - noticeable) * best;
      if (fit->error < best) {
        best = fit->error;
        chosen = m;
        found = std::move(equations);
        nugget = nugget_;
      }
      const double excess = best / options_.error_to_beat - 1;
      const double doublings = std::log2(static_cast<double>(most_) / static_cast<double>(m));
      if (excess > hopeful && excess * std::pow(std::min(1.0, excess / before), doublings) > hopeful)
        return std::nullopt;
      if (!is_better || m == most_) break;
      before = excess;
    }
    nugget_ = nugget;
    if (chosen == 0 || !(best < (1 + hopeful) * options_.error_to_beat)) return std::nullopt;
    return some.size() == all.size() ? found : equations_for(chosen, all);
  }

  // With the likeliest nugget, which fits to more samples and centres start from.
  [[nodiscard]] std::optional<CenterFit<Dim>> solve(const CenterEquations<Dim>& equations, const Samples<Dim>& in_place,
                                                    bool with_variances = true) {
    const double start = std::log(nugget_);
    nugget_ = std::exp(golden_section([&](double log) { return equations.deviance(std::exp(log)); }, start - range_,
                                      start + range_, steps));
    range_ = std::max(least_range, 0.4 * range_);
    return equations.fit(nugget_, in_place, covariance_, with_variances);
  }

 private:
  static constexpr Index enough_to_choose = 10'000;  // samples
  static constexpr double noticeable = 1e-3;         // share of the error that more centres must take away
  static constexpr double hopeful = 0.05;            // above the error to beat, which few samples tell
  static constexpr double least_range = 0.4;
  static constexpr int steps = 5;

  [[nodiscard]] std::optional<CenterEquations<Dim>> equations_for(Index centers, const Samples<Dim>& in_place) const {
    CenterEquations<Dim> equations(covariance_, Points<Dim>(centers_.leftCols(centers)), trend_, mean_);
    if (!equations.is_regular()) return std::nullopt;
    equations.add(in_place);
    return equations;
  }

  [[nodiscard]] static Samples<Dim> spread_over(const Samples<Dim>& samples) {
    const Index stride = (samples.size() + enough_to_choose - 1) / enough_to_choose;
    if (stride < 2) return samples;
    const std::vector<Index> order = morton_order<Dim>(samples.points);
    std::vector<Index> some;
    for (Index i = stride / 2; i < samples.size(); i += stride) some.push_back(order[static_cast<std::size_t>(i)]);
    return chosen_samples(samples, some);
  }

  const AxisCovariance<Dim>& covariance_;
  const CenterOptions& options_;
  Index most_ = 0;
  Points<Dim> centers_;
  PolynomialBlock<Dim> trend_;
  Eigen::RowVectorXd mean_;
  double nugget_, range_ = 3;  // of its logarithm, on both sides
};

// A smooth function hardly tells lengths beyond its box, where systems are singular by rounding.
template <int Dim>
AxisCovariance<Dim> shortened(AxisCovariance<Dim> covariance) {
  constexpr double shorter = 0.3;
  covariance.lengths *= shorter;
  covariance.nugget = 0;
  return covariance;
}

}  // namespace

template <int Dim>
std::optional<CenterFit<Dim>> fit_at_centers(const Samples<Dim>& samples, const AxisCovariance<Dim>& covariance,
                                             const CenterOptions& options) {
  CenterSearch<Dim> search(samples, covariance, options);
  const auto equations = search.is_affordable() ? search.find(samples) : std::nullopt;
  return equations ? search.solve(*equations, search.in_place(samples)) : std::nullopt;
}

template <int Dim>
std::optional<CenterFit<Dim>> better_at_centers(const Samples<Dim>& samples, const LocalOptions& patches,
                                                const CenterOptions& options) {
  if (options.affordable < static_cast<double>(fewest_centers * fewest_centers * samples.size())) return std::nullopt;
  const CovarianceEstimate<Dim> estimate = estimate_axis_covariance(samples, Replicates{}, options.one_length);
  if (!estimate.best) return std::nullopt;
  const double weight = samples.all_weights().mean();
  const HeldOutSamples<Dim> held_out(samples.weights.size() > 0 ? normalize_weights(samples) : samples);
  const auto as_given = [&](Samples<Dim> some) {
    some.weights *= weight;
    return some;
  };
  const Samples<Dim> kept = as_given(held_out.others()), others = as_given(held_out.held_out());
  for (AxisCovariance<Dim> covariance = *estimate.best;; covariance = shortened(covariance)) {
    CenterSearch<Dim> search(kept, covariance, options);
    std::optional<CenterEquations<Dim>> equations = search.is_affordable() ? search.find(kept) : std::nullopt;
    if (const auto fit = equations ? search.solve(*equations, search.in_place(kept), false) : std::nullopt) {
      // By the same samples: what noise does to both makes no difference. A tie may hide detail that few of them tell.
      const double error = HeldOutError(held_out.errors(fit->components)).rmse;
      if (!(error < HeldOutError(held_out.errors(patches)).rmse)) return std::nullopt;
      equations->add(search.in_place(others));
      if (std::optional<CenterFit<Dim>> all = search.solve(*equations, search.in_place(samples))) {
        all->error = error;
        return all;
      }
    }
    const Points<Dim> places = in_lengths<Dim>(samples.points, shortened(covariance));
    if (bounding_box<Dim>(places).extent().maxCoeff() > 1) return std::nullopt;
  }
}

#define CSRBF_INSTANTIATE(Dim)                                                                                \
  template std::optional<CenterFit<Dim>> fit_at_centers<Dim>(const Samples<Dim>&, const AxisCovariance<Dim>&, \
                                                             const CenterOptions&);
CSRBF_FOR_MANY_DIMS(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

#define CSRBF_INSTANTIATE(Dim)                                                                            \
  template std::optional<CenterFit<Dim>> better_at_centers<Dim>(const Samples<Dim>&, const LocalOptions&, \
                                                                const CenterOptions&);
CSRBF_FOR_EACH_DIM(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
