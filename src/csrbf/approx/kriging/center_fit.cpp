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
      const std::optional<CenterFit<Dim>> fit = equations ? solve(*equations, some) : std::nullopt;
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
  [[nodiscard]] std::optional<CenterFit<Dim>> solve(const CenterEquations<Dim>& equations,
                                                    const Samples<Dim>& in_place) {
    const double start = std::log(nugget_);
    nugget_ = std::exp(golden_section([&](double log) { return equations.deviance(std::exp(log)); }, start - range_,
                                      start + range_, steps));
    range_ = std::max(least_range, 0.4 * range_);
    return fit(equations, in_place, false);
  }

  // With the nugget found last.
  [[nodiscard]] std::optional<CenterFit<Dim>> fit(const CenterEquations<Dim>& equations, const Samples<Dim>& in_place,
                                                  bool with_variances) const {
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

// Errors of both fits at the same samples, left out in turns: samples x components.
struct LeftOutErrors {
  Eigen::MatrixXd of_centers = {}, of_patches = {};
  Eigen::VectorXd weights = {};

  // Logarithm of how much likelier the samples are by the centres than by the patches, if errors are normal: what noise
  // does to both makes no difference.
  [[nodiscard]] double evidence() const {
    const Eigen::RowVectorXd centers = weights.transpose() * of_centers.cwiseAbs2();
    const Eigen::RowVectorXd patches = weights.transpose() * of_patches.cwiseAbs2();
    const Eigen::RowVectorXd variances = centers.cwiseMin(patches) / static_cast<double>(of_centers.rows());
    return (patches - centers).cwiseQuotient(2 * variances.cwiseMax(std::numeric_limits<double>::min())).sum();
  }
};

template <class Rows>
void append(Rows& all, const Rows& some) {
  all.conservativeResize(all.rows() + some.rows(), some.cols());
  all.bottomRows(some.rows()) = some;
}

template <int Dim>
std::optional<LeftOutErrors> left_out_errors(const Samples<Dim>& samples, const LocalOptions& patches,
                                             const CenterSearch<Dim>& search, const CenterEquations<Dim>& equations) {
  constexpr double clear = 10;  // evidence that more folds hardly change; chosen by hand
  const double weight = samples.all_weights().mean();
  const auto as_given = [&](Samples<Dim> some) {
    some.weights *= weight;
    return search.in_place(some);
  };
  const Samples<Dim> normalized = samples.weights.size() > 0 ? normalize_weights(samples) : samples;
  LeftOutErrors errors;
  for (Index fold = 0; fold < HeldOutSamples<Dim>::folds(samples.size()); ++fold) {
    const HeldOutSamples<Dim> parts(normalized, fold);
    CenterEquations<Dim> of_others = equations;
    of_others.remove(as_given(parts.held_out()));
    const auto fit = search.fit(of_others, as_given(parts.others()), false);
    if (!fit) return std::nullopt;
    append(errors.of_centers, parts.errors(fit->components));
    append(errors.of_patches, parts.errors(patches));
    append(errors.weights, parts.held_out().all_weights());
    if (std::abs(errors.evidence()) > clear) break;
  }
  return errors;
}

}  // namespace

template <int Dim>
std::optional<CenterFit<Dim>> fit_at_centers(const Samples<Dim>& samples, const AxisCovariance<Dim>& covariance,
                                             const CenterOptions& options) {
  CenterSearch<Dim> search(samples, covariance, options);
  const auto equations = search.is_affordable() ? search.find(samples) : std::nullopt;
  if (!equations) return std::nullopt;
  const Samples<Dim> in_place = search.in_place(samples);
  return search.solve(*equations, in_place) ? search.fit(*equations, in_place, true) : std::nullopt;
}

template <int Dim>
std::optional<CenterFit<Dim>> better_at_centers(const Samples<Dim>& samples, const LocalOptions& patches,
                                                const CenterOptions& options) {
  // Patches must be this much likelier, in logarithms: where samples hardly tell both apart, one covariance of all of
  // them is the better guess. Chosen by hand.
  constexpr double clearly = 3;
  if (options.affordable < static_cast<double>(fewest_centers * fewest_centers * samples.size())) return std::nullopt;
  const CovarianceEstimate<Dim> estimate = estimate_axis_covariance(samples, Replicates{}, options.one_length);
  if (!estimate.best) return std::nullopt;
  for (AxisCovariance<Dim> covariance = *estimate.best;; covariance = shortened(covariance)) {
    CenterSearch<Dim> search(samples, covariance, options);
    std::optional<CenterEquations<Dim>> equations = search.is_affordable() ? search.find(samples) : std::nullopt;
    if (equations && search.solve(*equations, search.in_place(samples))) {
      const std::optional<LeftOutErrors> errors = left_out_errors(samples, patches, search, *equations);
      if (errors && !(errors->evidence() > -clearly)) return std::nullopt;
      if (auto fit = errors ? search.fit(*equations, search.in_place(samples), true) : std::nullopt) {
        fit->error = HeldOutError(errors->of_centers).rmse;
        return fit;
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
