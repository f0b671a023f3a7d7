#include "csrbf/approx/global/axis_covariance.hpp"

#include "csrbf/approx/basis/polynomial_block.hpp"
#include "csrbf/approx/global/restricted_likelihood.hpp"
#include "csrbf/approx/global/slope_directions.hpp"
#include "csrbf/core/error.hpp"
#include "csrbf/core/parallel.hpp"
#include "csrbf/linalg/quasi_newton_search.hpp"
#include "csrbf/linalg/saddle.hpp"
#include "csrbf/spatial/chosen_points.hpp"
#include "csrbf/spatial/morton_order.hpp"
#include "csrbf/spatial/squared_distances.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace csrbf {
namespace {

constexpr double no_likelihood = std::numeric_limits<double>::infinity();
// Chosen by hand; lengths in extents of the samples.
constexpr double shortest = 1e-4, longest = 1e3;
constexpr double largest_axis_jitter = 1e-9;            // see InterpolateOptions
constexpr double least_nugget = 1e-12;                  // some thousand roundings
constexpr double largest_nugget = 1e3;                  // noise alone
constexpr double different_units = 10;                  // ratio of the extents of axes that are units of their own
constexpr double usual_length = 0.5, usual_spread = 2;  // of the logarithms about the usual one
// Searches on more and more samples, with so many evaluations: of the first kernel, of all, of the best, of the last.
constexpr std::array<Index, 4> sizes = {100, 160, 256, 400};
constexpr std::array<int, 4> steps = {24, 14, 10, 5};
constexpr std::size_t finalists = 2;

struct Model {
  const char* kernel;
  double parameter = std::numeric_limits<double>::quiet_NaN();
};
// From rough to smooth.
constexpr std::array<Model, 7> models = {{{"powered-exponential", 0.7},
                                          {"matern-c0"},
                                          {"matern-c2"},
                                          {"matern-c4"},
                                          {"matern-c6"},
                                          {"inverse-multiquadric"},
                                          {"gaussian"}}};
constexpr std::size_t middle_model = 2;

// The distance at which a kernel is one half.
double half_width(const Kernel& kernel) {
  double lo = 0, hi = 1;
  while (kernel.value(hi) > .5) hi *= 2;
  for (int k = 0; k < 50; ++k) (kernel.value(.5 * (lo + hi)) > .5 ? lo : hi) = .5 * (lo + hi);
  return hi;
}

// Every k-th pair of samples that are neighbours along a curve: even, and with short distances.
template <int Dim>
std::vector<Index> even_pairs(const std::vector<Index>& order, Index count) {
  const auto n = std::ssize(order);
  if (n <= count) return order;
  std::vector<Index> chosen;
  const Index pairs = count / 2;
  for (Index k = 0; k < pairs; ++k) {
    const Index first = (2 * k + 1) * (n - 1) / (2 * pairs);
    chosen.push_back(order[first]);
    chosen.push_back(order[first + 1]);
  }
  return chosen;
}

template <int Dim>
class Search {
 public:
  Search(const Samples<Dim>& samples, const Replicates& replicates, bool one_length) : one_length_(one_length) {
    const Box<Dim> box = bounding_box<Dim>(samples.points);
    const double largest = box.extent().maxCoeff();
    double smallest = largest;
    for (const double extent : box.extent())
      if (extent > 0) smallest = std::min(smallest, extent);
    has_own_units_ = !one_length && largest > different_units * smallest;
    for (Index a = 0; a < Dim; ++a) {
      const double extent = box.extent()[a];
      units_[a] = has_own_units_ && extent > 0 ? extent : (largest > 0 ? largest : 1);
      if (extent > 0) axes_.push_back(a);
    }
    center_ = box.center();
    const std::vector<Index> order = morton_order<Dim>(samples.points);
    for (const Index size : sizes)
      if (likelihoods_.empty() || likelihoods_.back().size() < samples.size())
        likelihoods_.push_back(part(samples, replicates, even_pairs<Dim>(order, size)));
  }

  // Whether all coordinates are lengths in one unit.
  [[nodiscard]] bool has_one_unit() const { return !has_own_units_; }
  [[nodiscard]] double score() const { return score_; }
  // What angles must gain in score (Schwarz 1978).
  [[nodiscard]] double price_of_angles() const {
    const auto n = static_cast<double>(likelihoods_.back().observations());
    return 0.5 * Dim * (Dim - 1) * std::log(n) / n;
  }

  [[nodiscard]] std::optional<AxisCovariance<Dim>> find() {
    if (std::ssize(axes_) == 0 || likelihoods_.back().size() < fewest * (parameters() + 1)) return std::nullopt;
    Found best = climb();
    if (!(best.value < no_likelihood)) return std::nullopt;
    const auto& likelihood = likelihoods_.back();
    const std::size_t last = likelihoods_.size() - 1;
    Eigen::VectorXd exact = best.x;
    exact[parameters() - 1] = std::log(least_nugget);
    if (value(best.model, exact, last) < value(best.model, best.x, last)) best.x = exact;
    const auto at = unpack(best.x);
    AxisCovariance<Dim> result{kernels_[best.model], at.log_lengths.array().exp().matrix().cwiseProduct(units_),
                               std::exp(at.log_nugget)};
    if (result.nugget < 10 * least_nugget) result.nugget = 0;
    const double constant = score(likelihood.with_derivatives(kernels_[best.model], 0, at), likelihood.observations());
    const double linear =
        likelihood.largest_degree() == 1
            ? score(likelihood.with_derivatives(kernels_[best.model], 1, at), likelihood.observations())
            : no_likelihood;
    if (linear < constant) result.degree = 1;
    score_ = std::min(linear, constant);
    return result;
  }

 private:
  static constexpr Index fewest = 2;  // samples for every parameter

  struct Found {
    std::size_t model = 0;
    Eigen::VectorXd x;  // logarithms of lengths and of the nugget
    double value = no_likelihood, score = no_likelihood;
  };

  RestrictedLikelihood<Dim> part(const Samples<Dim>& samples, const Replicates& replicates,
                                 const std::vector<Index>& chosen) const {
    Samples<Dim> some{chosen_points<Dim>(samples.points, chosen), samples.values(chosen, Eigen::all), {}};
    for (Index i = 0; i < some.size(); ++i)
      for (int a = 0; a < Dim; ++a) some.points(a, i) = 1 / units_[a] * (some.points(a, i) - center_[a]);
    if (samples.weights.size() > 0) some.weights = samples.weights(chosen);
    Replicates scaled = replicates;
    for (Index c = 0; c < some.components(); ++c) {
      auto column = some.values.col(c);
      column.array() -= column.mean();
      const double size = column.stableNorm() / std::sqrt(static_cast<double>(column.size()));
      if (!(size > 0)) continue;
      column /= size;
      if (scaled.count > 0) scaled.squares[c] = scaled.squares[c] / size / size;
    }
    if (scaled.count > 0 && !scaled.squares.allFinite()) scaled.count = 0;
    return {std::move(some), std::move(scaled)};
  }

  [[nodiscard]] Index lengths() const { return one_length_ ? 1 : std::ssize(axes_); }
  [[nodiscard]] Index parameters() const { return lengths() + 1; }

  [[nodiscard]] typename RestrictedLikelihood<Dim>::Parameters unpack(const Eigen::VectorXd& x) const {
    typename RestrictedLikelihood<Dim>::Parameters at;
    at.log_lengths.setZero();
    for (Index k = 0; k < std::ssize(axes_); ++k) at.log_lengths[axes_[k]] = x[one_length_ ? 0 : k];
    at.log_nugget = x[x.size() - 1];
    return at;
  }

  // Minus the logarithm of a weak prior of lengths, that of Cauchy: noise is no function of short length.
  [[nodiscard]] double prior(const Eigen::VectorXd& x, Eigen::VectorXd* gradient) const {
    const Index p = lengths();
    const Eigen::ArrayXd off = (x.head(p).array() - std::log(usual_length)) / usual_spread;
    if (gradient != nullptr) gradient->head(p).array() += 2 * off / (1 + off.square()) / usual_spread;
    return (1 + off.square()).log().sum();
  }

  [[nodiscard]] double value(std::size_t model, const Eigen::VectorXd& x, std::size_t stage) const {
    return likelihoods_[std::min(stage, likelihoods_.size() - 1)].value(kernels_[model], 0, unpack(x)) +
           prior(x, nullptr);
  }

  // Both the mean log density of a sample given those before it, and the errors of samples given all others.
  static double score(const typename RestrictedLikelihood<Dim>::Value& v, Index n) {
    constexpr double least = 1e-30;
    return v.value / static_cast<double>(n) + std::log(std::max(v.leave_one_out, least));
  }

  // With the samples and evaluations of a stage, the last one there is or before.
  [[nodiscard]] Found search(std::size_t model, const Eigen::VectorXd& start, std::size_t stage) const {
    const auto& likelihood = likelihoods_[std::min(stage, likelihoods_.size() - 1)];
    Found found{model, start};
    Eigen::VectorXd lower = Eigen::VectorXd::Constant(parameters(), std::log(shortest)), upper = lower;
    upper.setConstant(std::log(longest));
    lower[parameters() - 1] = std::log(least_nugget);
    upper[parameters() - 1] = std::log(largest_nugget);
    const auto f = [&](const Eigen::VectorXd& x, Eigen::VectorXd& gradient) {
      const auto v = likelihood.with_derivatives(kernels_[model], 0, unpack(x));
      gradient.setZero();
      for (Index k = 0; k < std::ssize(axes_); ++k) gradient[one_length_ ? 0 : k] += v.d_log_lengths[axes_[k]];
      gradient[parameters() - 1] = v.d_log_nugget;
      const double total = v.value + prior(x, &gradient);
      if (total < found.value) {
        found.x = x;
        found.value = total;
        found.score = score(v, likelihood.observations());
      }
      return total;
    };
    // Values alone cost an eighth: without noise, shorter, longer.
    Eigen::VectorXd best = start;
    double least = value(model, start, stage);
    const auto attempt = [&](const Eigen::VectorXd& x) {
      const double other = value(model, x, stage);
      if (other < least) best = x;
      least = std::min(least, other);
    };
    Eigen::VectorXd exact = start;
    exact[parameters() - 1] = std::log(least_nugget);
    attempt(exact);
    const Eigen::VectorXd from = best;
    for (const double step : {-0.5, 0.5}) {
      Eigen::VectorXd x = from;
      x.head(lengths()).array() += step;
      attempt(x);
    }
    (void)quasi_newton_search(f, best, lower, upper,
                              {.evaluations = steps[stage], .tolerance = 0.05, .first_step = 0.3});
    return found;
  }

  // The best of a few guesses: all axes alike, or one of them short.
  [[nodiscard]] Eigen::VectorXd start(std::size_t model) const {
    constexpr std::array<double, 4> alike = {.05, .2, .7, 3};
    constexpr std::array<double, 3> nuggets = {1e-7, 1e-2, .5};
    constexpr double one_short = .1, others = 2;
    std::vector<Eigen::VectorXd> guesses;
    const auto add = [&](const Eigen::VectorXd& widths) {
      for (const double nugget : nuggets) {
        Eigen::VectorXd x(parameters());
        x << (widths / half_width(kernels_[model])).array().log().matrix(), std::log(nugget);
        guesses.push_back(x);
      }
    };
    for (const double width : alike) add(Eigen::VectorXd::Constant(lengths(), width));
    for (Index a = 0; lengths() > 1 && a < lengths(); ++a) {
      Eigen::VectorXd widths = Eigen::VectorXd::Constant(lengths(), others);
      widths[a] = one_short;
      add(widths);
    }
    Eigen::VectorXd values(std::ssize(guesses));
    parallel_for(std::ssize(guesses), 2, [&](Index begin, Index end) {
      for (Index k = begin; k < end; ++k) values[k] = value(model, guesses[static_cast<std::size_t>(k)], 0);
    });
    Index best = 0;
    values.minCoeff(&best);
    return guesses[static_cast<std::size_t>(best)];
  }

  [[nodiscard]] Eigen::VectorXd for_other(const Found& found, std::size_t model) const {
    Eigen::VectorXd x = found.x;
    x.head(lengths()).array() += std::log(half_width(kernels_[found.model]) / half_width(kernels_[model]));
    return x;
  }

  // From a kernel of middle smoothness to smoother or rougher ones as long as they are better; then the best ones
  // again.
  [[nodiscard]] Found climb() {
    for (const Model& model : models) kernels_.emplace_back(model.kernel, Dim, model.parameter);
    std::vector<Found> tried = {search(middle_model, search(middle_model, start(middle_model), 0).x, 1)};
    double best = tried.front().score;
    for (const int step : {1, -1}) {
      Found last = tried.front();
      int misses = 0;
      while (misses < 2) {
        const auto next = static_cast<std::ptrdiff_t>(last.model) + step;
        if (next < 0 || next >= std::ssize(models)) break;
        last = search(static_cast<std::size_t>(next), for_other(last, static_cast<std::size_t>(next)), 1);
        misses = last.score < best ? 0 : misses + 1;
        best = std::min(best, last.score);
        tried.push_back(last);
      }
      if (best < tried.front().score) break;
    }
    const auto by_score = [](const Found& a, const Found& b) { return a.score < b.score; };
    std::stable_sort(tried.begin(), tried.end(), by_score);
    tried.resize(std::min(finalists, tried.size()));
    for (Found& found : tried) found = search(found.model, found.x, 2);
    const Found& winner = *std::min_element(tried.begin(), tried.end(), by_score);
    const Found last = likelihoods_.size() > 3 ? search(winner.model, winner.x, 3) : winner;
    return last.value < no_likelihood ? last : winner;
  }

  bool one_length_, has_own_units_ = false;
  double score_ = no_likelihood;  // of what was found
  Point<Dim> units_, center_;
  std::vector<Index> axes_;
  std::vector<Kernel> kernels_;
  std::vector<RestrictedLikelihood<Dim>> likelihoods_;  // of more and more samples
};

}  // namespace

template <int Dim>
std::optional<AxisCovariance<Dim>> estimate_axis_covariance(const Samples<Dim>& samples, const Replicates& replicates,
                                                            bool one_length) {
  const auto spread = samples.values.colwise().maxCoeff() - samples.values.colwise().minCoeff();
  if (!(spread.maxCoeff() > 0)) return std::nullopt;
  Search<Dim> search(samples, replicates, one_length);
  std::optional<AxisCovariance<Dim>> found = search.find();
  if (!found || one_length || !search.has_one_unit()) return found;
  const std::optional<Eigen::Matrix<double, Dim, Dim>> axes = slope_directions(samples);
  if (!axes) return found;
  Samples<Dim> turned = samples;
  turned.points = axes->transpose() * samples.points;
  Search<Dim> along(turned, replicates, false);
  std::optional<AxisCovariance<Dim>> other = along.has_one_unit() ? along.find() : std::nullopt;
  if (!other || !(along.score() + along.price_of_angles() < search.score())) return found;
  other->axes = axes;
  return other;
}

template <int Dim>
double left_out_error(const Samples<Dim>& samples, const AxisCovariance<Dim>& covariance) {
  constexpr Index at_once = 800, block = 400, blocks = 4;  // samples; chosen by hand
  const Index n = samples.size(), size = n <= at_once ? n : block, core = n <= at_once ? n : block / 2;
  const Points<Dim> scaled = in_lengths<Dim>(samples.points, covariance);
  const std::vector<Index> order = morton_order<Dim>(scaled);
  double sum = 0;
  Index count = 0;
  for (Index k = 0; k < (n <= at_once ? 1 : blocks); ++k) {
    std::vector<Index> near = order;
    const Point<Dim> middle = scaled.col(order[(2 * k + 1) * n / (2 * blocks)]);
    const auto distance = [&](Index i) { return (scaled.col(i) - middle).squaredNorm(); };
    std::partial_sort(near.begin(), near.begin() + size, near.end(),
                      [&](Index a, Index b) { return distance(a) < distance(b); });
    near.resize(static_cast<std::size_t>(size));
    const Points<Dim> x = chosen_points<Dim>(scaled, near);
    Eigen::VectorXd w(size), r2(size);
    for (Index i = 0; i < size; ++i) w[i] = samples.weight(near[static_cast<std::size_t>(i)]);
    Eigen::MatrixXd A = Eigen::MatrixXd::Zero(size, size);
    for (Index j = 0; j < size; ++j) {
      squared_distances<Dim>(x.data() + Dim * j, size - j, x.col(j), r2.data());
      covariance.kernel.values(r2.data(), size - j, &A(j, j));
    }
    const Eigen::MatrixXd G = polynomial_block<Dim>(x, covariance.degree, RankDeficiency::reduce).G;
    try {
      const SaddleOptions options{.lambda = covariance.nugget, .weights = w, .largest_rescue = largest_axis_jitter};
      const Eigen::MatrixXd errors =
          solve_saddle(A, G, samples.values(near, Eigen::all), options).leave_one_out.topRows(core);
      sum += errors.cwiseAbs().sum();
      count += errors.size();
    } catch (const SolverFailure&) {
      return no_likelihood;
    }
  }
  return sum / static_cast<double>(count);
}

#define CSRBF_INSTANTIATE(Dim)                                                                                      \
  template std::optional<AxisCovariance<Dim>> estimate_axis_covariance<Dim>(const Samples<Dim>&, const Replicates&, \
                                                                            bool);                                  \
  template double left_out_error<Dim>(const Samples<Dim>&, const AxisCovariance<Dim>&);
CSRBF_FOR_EACH_DIM(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
