#include "csrbf/approx/kriging/center_fit.hpp"

#include "csrbf/approx/basis/expansion.hpp"
#include "csrbf/approx/basis/polynomial_block.hpp"
#include "csrbf/approx/global/kriging_variance.hpp"
#include "csrbf/approx/samples/deviation.hpp"
#include "csrbf/approx/samples/mapped_field.hpp"
#include "csrbf/approx/samples/merge_duplicates.hpp"
#include "csrbf/approx/unity/held_out_error.hpp"
#include "csrbf/core/parallel.hpp"
#include "csrbf/linalg/dense_cholesky.hpp"
#include "csrbf/linalg/golden_section.hpp"
#include "csrbf/spatial/chosen_points.hpp"
#include "csrbf/spatial/even_pairs.hpp"
#include "csrbf/spatial/farthest_points.hpp"
#include "csrbf/spatial/kd_tree.hpp"
#include "csrbf/spatial/morton_order.hpp"
#include "csrbf/spatial/squared_distances.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace csrbf {
namespace {

// Chosen by hand.
constexpr Index most_centers = 2000;
constexpr Index rows_at_once = 1024;
constexpr double smallest_nugget = 1e-14;

// The normal equations of penalised least squares: with K = L L^T of the centres, functions k(x) L^-T u + g(x) pi of
// penalty lambda |u|^2, which are as well conditioned as can be.
template <int Dim>
class NormalEquations {
 public:
  // Points in the lengths of the covariance.
  NormalEquations(const AxisCovariance<Dim>& covariance, const Points<Dim>& centers, PolynomialBlock<Dim> trend,
                  Eigen::RowVectorXd mean)
      : kernel_(covariance.kernel), centers_(centers), trend_(std::move(trend)), mean_(std::move(mean)) {
    constexpr double least_jitter = 1e-13, largest_jitter = 1e-8;
    const Index m = centers.cols();
    for (double jitter = least_jitter; jitter <= largest_jitter; jitter *= 10) {
      L_ = covariances(centers_);
      L_.diagonal().array() += jitter;
      if (cholesky_in_place(L_)) {
        is_regular_ = true;
        break;
      }
    }
    const Index p = m + trend_.monomials.cols();
    A_.setZero(p, p);
    b_.setZero(p, mean_.size());
    squares_.setZero(mean_.size());
  }

  [[nodiscard]] bool is_regular() const { return is_regular_; }

  void add(const Samples<Dim>& samples) {
    const Index m = centers_.cols(), p = A_.rows();
    const Polynomials<Dim> polynomials(trend_.frame.degree);
    for (Index begin = 0; begin < samples.size(); begin += rows_at_once) {
      const Index n = std::min(rows_at_once, samples.size() - begin);
      const Points<Dim> x = samples.points.middleCols(begin, n);
      Eigen::VectorXd root = Eigen::VectorXd::Ones(n);
      if (samples.weights.size() > 0) root = samples.weights.segment(begin, n).cwiseSqrt();
      const Eigen::MatrixXd y = root.asDiagonal() * (samples.values.middleRows(begin, n).rowwise() - mean_);
      Eigen::MatrixXd D(p, n);
      D.topRows(m) = covariances(x);
      solve_lower_in_place(L_, D.topRows(m));
      if (p > m) {
        Eigen::MatrixXd G(n, polynomials.size());
        polynomials.rows(in_units<Dim>(x, trend_.frame.origin, trend_.frame.scale), G.data());
        D.bottomRows(p - m) = (G * trend_.monomials).transpose();
      }
      D *= root.asDiagonal();
      const Eigen::MatrixXd minus = -D, transposed = D.transpose();
      constexpr Index strip = 192;
      for (Index c = 0; c < p; c += strip)
        subtract_product(minus.bottomRows(p - c), transposed.middleCols(c, std::min(strip, p - c)),
                         A_.block(c, c, p - c, std::min(strip, p - c)));
      b_ += D * y;
      squares_ += y.colwise().squaredNorm().transpose();
      weight_ += root.squaredNorm();
      samples_ += n;
    }
  }

  // Minus twice the logarithm of the restricted likelihood, but for a constant.
  [[nodiscard]] double deviance(double nugget) const {
    const Solved solved = solve(nugget);
    if (!solved.is_regular) return std::numeric_limits<double>::infinity();
    double logs = 0, C = 0;
    for (const double misfit : solved.misfit) {
      if (!(misfit > 0)) continue;  // a constant
      logs += std::log(misfit);
      C += 1;
    }
    return degrees() * logs + C * (2 * solved.factor.diagonal().array().log().sum() -
                                   static_cast<double>(centers_.cols()) * std::log(nugget));
  }

  [[nodiscard]] std::optional<CenterFit<Dim>> fit(double nugget, const Samples<Dim>& samples,
                                                  const AxisCovariance<Dim>& covariance, bool with_variances) const {
    Solved solved = solve(nugget);
    if (!solved.is_regular) return std::nullopt;
    const Index m = centers_.cols(), p = A_.rows(), C = mean_.size();
    CenterFit<Dim> result{.covariance = covariance, .centers = m};
    result.covariance.nugget = nugget;
    // The trace of the matrix that takes the samples to what is fitted to them: p - lambda tr (A^-1)_uu.
    Eigen::MatrixXd inverse = solved.factor;
    invert_lower_in_place(inverse);
    double trace = 0;
    for (Index j = 0; j < m; ++j) trace += inverse.col(j).tail(p - j).squaredNorm();
    const double effective = static_cast<double>(p) - nugget * trace;
    Eigen::MatrixXd solution = solved.white;
    solved.factor.template triangularView<Eigen::Lower>().transpose().solveInPlace(solution);
    const Eigen::VectorXd residual = solved.misfit - nugget * solution.topRows(m).colwise().squaredNorm().transpose();
    const double left = 1 - effective / static_cast<double>(samples_);
    result.error = left > 0 ? std::sqrt(residual.cwiseMax(0).sum() / (weight_ * static_cast<double>(C))) / left
                            : std::numeric_limits<double>::infinity();
    Eigen::MatrixXd alpha = solution.topRows(m);
    L_.template triangularView<Eigen::Lower>().transpose().solveInPlace(alpha);

    using Map = typename MappedField<Dim>::Map;
    Map map = covariance.lengths.cwiseInverse().asDiagonal();
    if (covariance.axes) map *= covariance.axes->transpose();
    const auto basis = std::make_shared<const RadialBasis<Dim>>(kernel_, centers_, Eigen::VectorXd::Ones(1));
    const Box<Dim> box = bounding_box<Dim>(samples.points);
    for (Index c = 0; c < C; ++c) {
      Eigen::VectorXd pi = solution.col(c).tail(p - m);
      PolynomialTail<Dim> tail = trend_.tail(pi);
      tail.coefficients[0] += mean_[c];
      result.components.push_back(std::make_shared<const MappedField<Dim>>(
          std::make_shared<const Expansion<Dim>>(basis, alpha.col(c), std::move(tail), box), map));
    }
    const Eigen::VectorXd left_out = (left > 0 ? 1 / (weight_ * left * left) : 0) * residual.cwiseMax(0);
    if (with_variances) add_variances(solved.misfit / degrees(), left_out, samples, basis, map, result);
    return result;
  }

 private:
  // Samples left out are off by their noise at least, and by it and sigma^2 P^2 about: with the share s of P^2 that is
  // so, sigma^2 s (P^2 + lambda / s). `noise`, `left_out`: mean squares, by component.
  void add_variances(const Eigen::VectorXd& noise, const Eigen::VectorXd& left_out, const Samples<Dim>& samples,
                     const std::shared_ptr<const RadialBasis<Dim>>& basis, const typename MappedField<Dim>::Map& map,
                     CenterFit<Dim>& result) const {
    constexpr double doubt = 1.25, least_share = 1e-12;  // chosen by hand
    const double nugget = result.covariance.nugget;
    const Eigen::VectorXd weights = weights_of(samples);
    const auto power_for = [&](double lambda) {
      return std::make_shared<const PowerFunction<Dim>>(basis, result.covariance.degree, lambda,
                                                        lambda / nugget * weights);
    };
    double ratio = 0, count = 0;  // of errors left out to noise
    for (Index c = 0; c < noise.size(); ++c) {
      if (!(noise[c] > 0) || !(left_out[c] > 0)) continue;  // a constant
      ratio += left_out[c] / noise[c];
      ++count;
    }
    auto power = power_for(nugget);
    double share = 1, of_noise = 1;
    const double power2 = mean_power2(*power, samples.points);
    if (count > 0 && std::isfinite(power2)) {
      ratio /= count;
      of_noise = std::min(1.0, ratio);
      share = std::clamp((doubt * ratio - of_noise) * nugget / power2, least_share, 1.0);
      if (share < 1 || of_noise < 1) power = power_for(of_noise * nugget / share);
    }
    const Box<Dim> box = bounding_box<Dim>(samples.points);
    for (const double all : noise) {
      result.noise.push_back(std::sqrt(of_noise * all));
      result.variances.push_back(std::make_shared<const MappedField<Dim>>(
          std::make_shared<const KrigingVariance<Dim>>(power, share * all / nugget, box), map));
    }
  }

  // Mean P^2 at some of the samples.
  [[nodiscard]] static double mean_power2(const PowerFunction<Dim>& power, const Points<Dim>& points) {
    constexpr Index asked = 200;
    const Points<Dim> some = chosen_points<Dim>(points, even_samples(morton_order<Dim>(points), asked));
    return std::max((power.evaluate(some).array() - power.smoothing()).mean(), 1e-300);
  }

  struct Solved {
    bool is_regular = false;
    Eigen::MatrixXd factor = {}, white = {};
    Eigen::VectorXd misfit = {};  // the least of the objective, by component
  };

  [[nodiscard]] double degrees() const { return static_cast<double>(samples_ - (A_.rows() - centers_.cols())); }

  // Of the centres with points: one column each.
  [[nodiscard]] Eigen::MatrixXd covariances(const Points<Dim>& x) const {
    const Index m = centers_.cols();
    Eigen::MatrixXd K(m, x.cols());
    parallel_for(x.cols(), 16, [&](Index begin, Index end) {
      Eigen::VectorXd r2(m);
      for (Index i = begin; i < end; ++i) {
        squared_distances<Dim>(centers_.data(), m, x.col(i), r2.data());
        kernel_.values(r2.data(), m, K.col(i).data());
      }
    });
    return K;
  }

  [[nodiscard]] Solved solve(double nugget) const {
    const Index m = centers_.cols();
    Solved solved{.factor = A_, .white = b_};
    solved.factor.diagonal().head(m).array() += nugget;
    solved.is_regular = cholesky_in_place(solved.factor);
    if (!solved.is_regular) return solved;
    solve_lower_in_place(solved.factor, solved.white);
    constexpr double rounding = 1e-15;
    solved.misfit = (squares_ - solved.white.colwise().squaredNorm().transpose()).cwiseMax(rounding * squares_);
    solved.is_regular = solved.misfit.maxCoeff() > 0;
    return solved;
  }

  // What samples around each centre weigh together: to the variance they are one sample there.
  [[nodiscard]] Eigen::VectorXd weights_of(const Samples<Dim>& samples) const {
    const KdTree<Dim> tree(centers_);
    std::vector<Index> nearest(static_cast<std::size_t>(samples.size()));
    parallel_for(samples.size(), 256, [&](Index begin, Index end) {
      for (Index i = begin; i < end; ++i) {
        double r2 = 0;
        tree.nearest(samples.points.col(i), 1, &nearest[static_cast<std::size_t>(i)], &r2);
      }
    });
    Eigen::VectorXd weights = Eigen::VectorXd::Zero(centers_.cols());
    for (Index i = 0; i < samples.size(); ++i) weights[nearest[static_cast<std::size_t>(i)]] += samples.weight(i);
    return weights;
  }

  Kernel kernel_;
  Points<Dim> centers_;
  PolynomialBlock<Dim> trend_;
  Eigen::RowVectorXd mean_;
  bool is_regular_ = false;
  Eigen::MatrixXd L_, A_, b_;  // A's lower triangle
  Eigen::VectorXd squares_;
  double weight_ = 0;
  Index samples_ = 0;
};

// What is the same for any number of centres. Points are in the lengths of the covariance.
template <int Dim>
class CenterSearch {
 public:
  CenterSearch(const Samples<Dim>& samples, const AxisCovariance<Dim>& covariance, const CenterOptions& options)
      : covariance_(covariance), options_(options), nugget_(std::max(covariance.nugget, smallest_nugget)) {
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
  [[nodiscard]] std::optional<NormalEquations<Dim>> find(const Samples<Dim>& samples) {
    const Samples<Dim> all = in_place(samples), some = spread_over(all);
    std::optional<NormalEquations<Dim>> found;
    double before = std::numeric_limits<double>::infinity(), best = before;
    double nugget = nugget_;
    Index chosen = 0;
    for (Index m = fewest_centers; chosen < most_; m = std::min(2 * m, most_)) {
      report(options_.progress, "solve", static_cast<double>(m) / static_cast<double>(2 * most_));
      std::optional<NormalEquations<Dim>> equations = equations_for(m, some);
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
  [[nodiscard]] std::optional<CenterFit<Dim>> solve(const NormalEquations<Dim>& equations, const Samples<Dim>& in_place,
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

  [[nodiscard]] std::optional<NormalEquations<Dim>> equations_for(Index centers, const Samples<Dim>& in_place) const {
    NormalEquations<Dim> equations(covariance_, Points<Dim>(centers_.leftCols(centers)), trend_, mean_);
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
  const std::optional<AxisCovariance<Dim>> covariance =
      estimate_axis_covariance(samples, Replicates{}, options.one_length).best;
  if (!covariance) return std::nullopt;
  const double weight = samples.all_weights().mean();
  const HeldOutSamples<Dim> held_out(samples.weights.size() > 0 ? normalize_weights(samples) : samples);
  const auto as_given = [&](Samples<Dim> some) {
    some.weights *= weight;
    return some;
  };
  const Samples<Dim> kept = as_given(held_out.others());
  CenterSearch<Dim> search(kept, *covariance, options);
  std::optional<NormalEquations<Dim>> equations = search.is_affordable() ? search.find(kept) : std::nullopt;
  const auto fit = equations ? search.solve(*equations, search.in_place(kept), false) : std::nullopt;
  if (!fit) return std::nullopt;
  // By the same samples: what noise does to both makes no difference.
  const HeldOutError of_patches(held_out.errors(patches)), of_centers(held_out.errors(fit->components));
  if (!(of_centers.rmse < of_patches.rmse)) return std::nullopt;
  equations->add(search.in_place(as_given(held_out.held_out())));
  std::optional<CenterFit<Dim>> all = search.solve(*equations, search.in_place(samples));
  if (all) all->error = of_centers.rmse;
  return all;
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
