#include "csrbf/approx/global/axis_covariance.hpp"

#include "csrbf/approx/global/kernel_ladder.hpp"
#include "csrbf/approx/global/posterior_points.hpp"
#include "csrbf/approx/global/restricted_likelihood.hpp"
#include "csrbf/approx/global/slope_directions.hpp"
#include "csrbf/approx/global/spread_samples.hpp"
#include "csrbf/core/parallel.hpp"
#include "csrbf/linalg/quasi_newton_search.hpp"
#include "csrbf/spatial/even_pairs.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>

namespace csrbf {
namespace {

constexpr double no_likelihood = std::numeric_limits<double>::infinity();
// Chosen by hand; lengths in extents of the samples.
constexpr double shortest = 1e-4, longest = 1e3;
constexpr double least_nugget = 1e-12, largest_nugget = 1e3;  // some thousand roundings; noise alone
constexpr double usual_width = 0.4, usual_spread = 1.2;       // see prior()
// Searches on more and more samples, with so many evaluations: of the first kernel, of all, of the best, of the last.
constexpr std::array<Index, 4> sizes = {100, 160, 256, 400};
constexpr std::array<int, 4> steps = {24, 14, 10, 5};
constexpr std::size_t finalists = 2;
constexpr std::array<double, 5> any_nuggets = {least_nugget, 1e-5, 1e-4, 1e-3, 1e-2};
constexpr std::span<const double> no_noise(any_nuggets.data(), 1), some_noise(any_nuggets.data() + 1, 4);

class Search {
 public:
  using Covariance = AxisCovariance<Eigen::Dynamic>;

  Search(const SpreadSamples& places, const Replicates& replicates, bool one_length)
      : one_length_(one_length), kernels_(kernel_ladder(static_cast<int>(places.samples.dimension()))) {
    const Eigen::VectorXd& extents = places.extents;
    const double largest = extents.maxCoeff();
    has_own_units_ = !one_length && ratio_of_extents<Eigen::Dynamic>(places.extents) > different_units;
    units_.setConstant(extents.size(), largest > 0 ? largest : 1);
    for (Index a = 0; a < extents.size(); ++a)
      if (extents[a] > 0) axes_.push_back(a);
    if (has_own_units_) units_(axes_) = extents(axes_);
    const SampleView& samples = places.samples;
    spacing_ = std::pow(samples.size(), -1 / std::max(1.0, static_cast<double>(axes_.size())));
    for (const Index size : sizes)
      if (likelihoods_.empty() || likelihoods_.back().size() < samples.size())
        likelihoods_.push_back(
            likelihood_of(samples, replicates, even_pairs(places.order, size), places.center, units_));
  }

  // Whether all coordinates are lengths in one unit.
  [[nodiscard]] bool has_one_unit() const { return !has_own_units_; }
  [[nodiscard]] double score() const { return score_; }
  // What angles must gain in score (Schwarz 1978).
  [[nodiscard]] double price_of_angles() const {
    const auto n = static_cast<double>(likelihoods_.back().observations());
    const auto dimension = static_cast<double>(units_.size());
    return 0.5 * dimension * (dimension - 1) * std::log(n) / n;
  }

  [[nodiscard]] std::optional<Covariance> find(Index fewest_more) {
    if (std::ssize(axes_) == 0 || likelihoods_.back().size() < parameters() + fewest_more) return std::nullopt;
    Found best = climb();
    if (!(best.value < no_likelihood)) return std::nullopt;
    const auto& likelihood = likelihoods_.back();
    const Eigen::VectorXd exact = with_nugget(best.x, least_nugget);
    if (value(best.model, exact, last_stage) < value(best.model, best.x, last_stage)) best.x = exact;
    const auto with_trend = [&](int degree) {
      const auto there = likelihood.with_derivatives(kernels_[best.model], degree, unpack(best.x));
      return score(there, likelihood.observations());
    };
    const double constant = with_trend(0), linear = likelihood.largest_degree() == 1 ? with_trend(1) : no_likelihood;
    Covariance result = covariance(best.model, best.x, 0);
    if (linear < constant) result.degree = 1;
    score_ = std::min(linear, constant);
    return result;
  }

  // Few samples leave lengths, noise and kernel open: those that stand for all that are likely, after find(). None
  // where so many samples are there that the best one will do.
  [[nodiscard]] std::vector<Covariance> likely() const {
    const auto& likelihood = likelihoods_.back();
    const auto n = static_cast<double>(likelihood.size());
    const auto most = static_cast<Index>(std::min(static_cast<double>(most_likely), affordable / (n * n * n)));
    if (most < 2) return {};
    std::vector<Covariance> candidates;
    std::vector<double> log_weights;
    double best = no_likelihood;
    for (const Found& found : tried_) best = std::min(best, value(found.model, found.x, last_stage));
    for (const Found& found : tried_) {
      const double mode = value(found.model, found.x, last_stage);
      if (!(mode < best + hardly_likely)) continue;
      const PosteriorPoints around = posterior_points(found.x, hessian(found), lower(), upper());
      for (std::size_t k = 0; k < around.points.size(); ++k)
        for (int degree = 0; degree <= likelihood.largest_degree(); ++degree) {
          const Eigen::VectorXd& x = around.points[k];
          const double here =
              likelihood.value(kernels_[found.model], degree, unpack(x)) + prior(found.model, x, nullptr);
          if (!(here < best + hardly_likely)) continue;
          candidates.push_back(covariance(found.model, x, degree));
          log_weights.push_back(around.log_volumes[static_cast<Index>(k)] - here);
        }
    }
    std::vector<Covariance> result;
    if (candidates.empty()) return result;
    for (const Share& share :
         even_shares(Eigen::Map<Eigen::VectorXd>(log_weights.data(), std::ssize(log_weights)), most)) {
      result.push_back(candidates[share.number]);
      result.back().weight = share.weight;
    }
    return result;
  }

 private:
  // Chosen by hand.
  static constexpr Index most_likely = 12;    // covariances
  static constexpr double affordable = 6e7;   // of these, times the third power of the number of samples
  static constexpr double hardly_likely = 6;  // below the likelihood of the best, as a logarithm
  static constexpr std::size_t last_stage = sizes.size() - 1;

  struct Found {
    std::size_t model = 0;
    Eigen::VectorXd x;  // logarithms of lengths and of the nugget
    double value = no_likelihood, score = no_likelihood;
  };

  static bool by_score(const Found& a, const Found& b) { return a.score < b.score; }

  [[nodiscard]] Index lengths() const { return one_length_ ? 1 : std::ssize(axes_); }
  [[nodiscard]] Index parameters() const { return lengths() + 1; }

  [[nodiscard]] RestrictedLikelihood::Parameters unpack(const Eigen::VectorXd& x) const {
    RestrictedLikelihood::Parameters at;
    at.log_lengths.setZero(units_.size());
    for (Index k = 0; k < std::ssize(axes_); ++k) at.log_lengths[axes_[k]] = x[one_length_ ? 0 : k];
    at.log_nugget = x[x.size() - 1];
    return at;
  }

  // Minus the logarithm of a prior of the distances where covariances are one half, Student's law of the logarithms
  // about a usual one: noise is no function of short length, and what few samples leave open is not extreme.
  [[nodiscard]] double prior(std::size_t model, const Eigen::VectorXd& x, Eigen::VectorXd* gradient) const {
    constexpr double degrees = 4;
    const Index p = lengths();
    const double usual = std::log(usual_width * std::sqrt(static_cast<double>(axes_.size())) / half_widths_[model]);
    const Eigen::ArrayXd off = (x.head(p).array() - usual) / usual_spread;
    if (gradient != nullptr) gradient->head(p).array() += (degrees + 1) * off / (degrees + off.square()) / usual_spread;
    return (degrees + 1) / 2 * (1 + off.square() / degrees).log().sum();
  }

  [[nodiscard]] double value(std::size_t model, const Eigen::VectorXd& x, std::size_t stage) const {
    return likelihoods_[std::min(stage, likelihoods_.size() - 1)].value(kernels_[model], 0, unpack(x)) +
           prior(model, x, nullptr);
  }

  // Both the mean log density of a sample given those before it, and the errors of samples given all others.
  static double score(const RestrictedLikelihood::Value& v, Index n) {
    constexpr double least = 1e-30;
    return v.value / static_cast<double>(n) + std::log(std::max(v.leave_one_out, least));
  }

  [[nodiscard]] Eigen::VectorXd slopes(const RestrictedLikelihood::Value& v) const {
    Eigen::VectorXd gradient = Eigen::VectorXd::Zero(parameters());
    for (Index k = 0; k < std::ssize(axes_); ++k) gradient[one_length_ ? 0 : k] += v.d_log_lengths[axes_[k]];
    gradient[parameters() - 1] = v.d_log_nugget;
    return gradient;
  }

  static Eigen::VectorXd with_nugget(Eigen::VectorXd x, double nugget) {
    x[x.size() - 1] = std::log(nugget);
    return x;
  }

  [[nodiscard]] Eigen::VectorXd bound(double length, double nugget) const {
    return with_nugget(Eigen::VectorXd::Constant(parameters(), std::log(length)), nugget);
  }
  [[nodiscard]] Eigen::VectorXd lower() const { return bound(shortest, least_nugget); }
  [[nodiscard]] Eigen::VectorXd upper() const { return bound(longest, largest_nugget); }

  // Of value(), by differences of its slopes for the fewest samples: it grows with their number.
  [[nodiscard]] Eigen::MatrixXd hessian(const Found& found) const {
    constexpr double step = 0.1;
    const auto& few = likelihoods_.front();
    const double more = static_cast<double>(likelihoods_.back().size()) / static_cast<double>(few.size());
    const Index p = parameters();
    const auto at = [&](const Eigen::VectorXd& x) {
      Eigen::VectorXd gradient = more * slopes(few.with_derivatives(kernels_[found.model], 0, unpack(x)));
      (void)prior(found.model, x, &gradient);
      return gradient;
    };
    const Eigen::VectorXd center = at(found.x);
    Eigen::MatrixXd result(p, p);
    for (Index k = 0; k < p; ++k) {
      Eigen::VectorXd x = found.x;
      x[k] += step;
      result.col(k) = (at(x) - center) / step;
    }
    if (!result.allFinite()) return Eigen::MatrixXd::Identity(p, p);
    return 0.5 * (result + result.transpose());
  }

  [[nodiscard]] Covariance covariance(std::size_t model, const Eigen::VectorXd& x, int degree) const {
    const auto at = unpack(x);
    Covariance result{kernels_[model], at.log_lengths.array().exp().matrix().cwiseProduct(units_),
                      std::exp(at.log_nugget), degree};
    if (result.nugget < 10 * least_nugget) result.nugget = 0;
    return result;
  }

  [[nodiscard]] Eigen::VectorXd longer(Eigen::VectorXd x, double log_factor) const {
    x.head(lengths()).array() += log_factor;
    return x;
  }

  // With the samples and evaluations of a stage, the last one there is or before, first with other nuggets.
  [[nodiscard]] Found search(std::size_t model, const Eigen::VectorXd& start, std::size_t stage,
                             std::span<const double> nuggets) const {
    const auto& likelihood = likelihoods_[std::min(stage, likelihoods_.size() - 1)];
    Found found{model, start};
    const auto f = [&](const Eigen::VectorXd& x, Eigen::VectorXd& gradient) {
      const auto v = likelihood.with_derivatives(kernels_[model], 0, unpack(x));
      gradient = slopes(v);
      const double total = v.value + prior(model, x, &gradient);
      if (total < found.value) {
        found.x = x;
        found.value = total;
        found.score = score(v, likelihood.observations());
      }
      return total;
    };
    // Values alone cost an eighth: other noise, along whose logarithm slopes vanish, other lengths.
    Eigen::VectorXd best = start;
    double least = value(model, start, stage);
    const auto attempt = [&](const Eigen::VectorXd& x) {
      if (const double other = value(model, x, stage); other < least) best = x, least = other;
    };
    for (const double nugget : nuggets) attempt(with_nugget(start, nugget));
    for (const Eigen::VectorXd& x : {longer(best, -0.5), longer(best, 0.5)}) attempt(x);
    (void)quasi_newton_search(f, best, lower(), upper(),
                              {.evaluations = steps[stage], .tolerance = 0.05, .first_step = 0.3});
    return found;
  }

  // The best of a few guesses, all axes alike or one of them short, and if there are enough samples the best of those
  // of quite other lengths: a season and its trend are different optima.
  [[nodiscard]] std::vector<Eigen::VectorXd> starts(std::size_t model, bool noisy) const {
    constexpr double longest_width = 3, one_short = .1, others = 2;
    const double quite_other = std::log(6.0);  // a factor of lengths that searches hardly cross; by hand
    std::vector<Eigen::VectorXd> widths, guesses, result;
    for (double width = longest_width; width > std::min(spacing_, one_short); width /= 2)
      widths.emplace_back(Eigen::VectorXd::Constant(lengths(), width));
    // Waves along one axis may be as short as the spacing there; one of many axes orders any noise.
    const double spacing = lengths() <= 2 ? 1 / static_cast<double>(likelihoods_.back().size()) : one_short;
    for (Index a = 0; lengths() > 1 && a < lengths(); ++a)
      for (double width = one_short; width > std::min(spacing, one_short / 2); width /= 2) {
        widths.emplace_back(Eigen::VectorXd::Constant(lengths(), others));
        widths.back()[a] = width;
      }
    for (const Eigen::VectorXd& width : widths)
      for (const double nugget : {noisy ? 1e-3 : 1e-7, noisy ? 3e-2 : 1e-2, .5}) {
        guesses.emplace_back(parameters());
        guesses.back() << (width / half_widths_[model]).array().log().matrix(), std::log(nugget);
      }
    Eigen::VectorXd values(std::ssize(guesses));
    parallel_for(std::ssize(guesses), 2, [&](Index begin, Index end) {
      for (Index k = begin; k < end; ++k) values[k] = value(model, guesses[static_cast<std::size_t>(k)], 0);
    });
    const Index most = likelihoods_.front().size() < sizes.front() ? 1 : 2;
    do {
      Index best = 0;
      values.minCoeff(&best);
      result.push_back(guesses[static_cast<std::size_t>(best)]);
      for (Index k = 0; k < values.size(); ++k) {
        const Eigen::VectorXd off = guesses[static_cast<std::size_t>(k)] - result.back();
        if (off.head(lengths()).cwiseAbs().maxCoeff() < quite_other) values[k] = no_likelihood;
      }
    } while (std::ssize(result) < most && values.minCoeff() < no_likelihood);
    return result;
  }

  // Of a kernel of middle smoothness. Short lengths explain what noise does, too: with noise and without are different
  // optima, between which the slope by the logarithm of the nugget vanishes: a start with little of it never leaves.
  [[nodiscard]] Found first(bool noisy) const {
    const std::span<const double> nuggets = noisy ? some_noise : no_noise;
    std::vector<Found> found;
    for (const Eigen::VectorXd& start : starts(middle_of_ladder, noisy))
      found.push_back(search(middle_of_ladder, search(middle_of_ladder, start, 0, nuggets).x, 1, nuggets));
    return *std::min_element(found.begin(), found.end(), by_score);
  }

  [[nodiscard]] Eigen::VectorXd for_other(const Found& found, std::size_t model) const {
    return longer(found.x, std::log(half_widths_[found.model] / half_widths_[model]));
  }

  // Noise and short lengths are different optima: where the first kernel cannot tell which it is, both are pursued.
  [[nodiscard]] Found climb() {
    constexpr double undecided = 6, clearly = 1, clean = 1e-6;  // log likelihoods and a nugget; chosen by hand
    const auto has_noise = [](const Found& found) { return found.x[found.x.size() - 1] > std::log(clean); };
    const Found any = first(false), noisy = first(true);
    const double gain = value(any.model, any.x, last_stage) - value(noisy.model, noisy.x, last_stage);
    if (has_noise(any)) return climb(gain > 0 ? noisy : any, any_nuggets);
    const Found exact = climb(any, no_noise);
    if (gain < (has_noise(noisy) ? -undecided : 0)) return exact;
    std::vector<Found> tried = std::move(tried_);
    const Found with_noise = climb(noisy, any_nuggets);
    if (with_noise.value + clearly < exact.value &&
        likelihoods_.back().leaves_noise(kernels_[with_noise.model], 0, unpack(with_noise.x)))
      return with_noise;
    tried_ = std::move(tried);
    return exact;
  }

  // From a kernel of middle smoothness to smoother or rougher ones as long as they are better; then the best ones
  // again. Without noise none is tried: at other lengths it explains more at first.
  [[nodiscard]] Found climb(const Found& start, std::span<const double> nuggets) {
    std::vector<Found> tried = {start};
    double best = tried.front().score;
    for (const int step : {1, -1}) {
      Found last = tried.front();
      int misses = 0;
      while (misses < 2) {
        const auto next = static_cast<std::ptrdiff_t>(last.model) + step;
        if (next < 0 || next >= std::ssize(kernels_)) break;
        last = search(static_cast<std::size_t>(next), for_other(last, static_cast<std::size_t>(next)), 1, nuggets);
        misses = last.score < best ? 0 : misses + 1;
        best = std::min(best, last.score);
        tried.push_back(last);
      }
      if (best < tried.front().score) break;
    }
    std::stable_sort(tried.begin(), tried.end(), by_score);
    tried_ = tried;
    tried.resize(std::min(finalists, tried.size()));
    for (std::size_t k = 0; k < tried.size(); ++k)
      tried_[k] = tried[k] = search(tried[k].model, tried[k].x, 2, nuggets);
    const Found& winner = *std::min_element(tried.begin(), tried.end(), by_score);
    const Found last = likelihoods_.size() > 3 ? search(winner.model, winner.x, 3, nuggets) : winner;
    return last.value < no_likelihood ? last : winner;
  }

  bool one_length_, has_own_units_ = false;
  double score_ = no_likelihood;  // of what was found
  double spacing_ = 1;            // of as many samples spread evenly, in extents
  Eigen::VectorXd units_;
  std::vector<Index> axes_;
  std::vector<Kernel> kernels_;
  std::vector<double> half_widths_ = half_widths(kernels_);
  std::vector<Found> tried_;                       // by climb()
  std::vector<RestrictedLikelihood> likelihoods_;  // of more and more samples
};

template <int Dim>
CovarianceEstimate<Dim> with_dimension(const std::optional<Search::Covariance>& best,
                                       const std::vector<Search::Covariance>& likely) {
  const auto with = [](const Search::Covariance& one) {
    return AxisCovariance<Dim>{one.kernel, one.lengths, one.nugget, one.degree, {}, one.weight};
  };
  CovarianceEstimate<Dim> estimate;
  if (best) estimate.best = with(*best);
  for (const Search::Covariance& one : likely) estimate.likely.push_back(with(one));
  return estimate;
}

}  // namespace

template <int Dim>
CovarianceEstimate<Dim> estimate_axis_covariance(const Samples<Dim>& samples, const Replicates& replicates,
                                                 bool one_length, Index fewest_more) {
  const auto spread = samples.values.colwise().maxCoeff() - samples.values.colwise().minCoeff();
  if (!(spread.maxCoeff() > 0)) return {};
  Search search(SpreadSamples(samples), replicates, one_length);
  const auto best = search.find(fewest_more);
  if (!best) return {};
  if constexpr (Dim <= largest_dimension) {  // in more, there are too many angles
    const auto axes = one_length || !search.has_one_unit() ? std::nullopt : slope_directions(samples);
    if (axes) {
      Samples<Dim> turned = samples;
      turned.points = axes->transpose() * samples.points;
      Search along(SpreadSamples(turned), replicates, false);
      const auto best_along = along.find(fewest_more);
      if (best_along && along.score() + along.price_of_angles() < search.score()) {
        CovarianceEstimate<Dim> other = with_dimension<Dim>(best_along, along.likely());
        other.best->axes = axes;
        for (AxisCovariance<Dim>& one : other.likely) one.axes = axes;
        return other;
      }
    }
  }
  return with_dimension<Dim>(best, search.likely());
}

#define CSRBF_INSTANTIATE(Dim) \
  template CovarianceEstimate<Dim> estimate_axis_covariance<Dim>(const Samples<Dim>&, const Replicates&, bool, Index);
CSRBF_FOR_MANY_DIMS(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
