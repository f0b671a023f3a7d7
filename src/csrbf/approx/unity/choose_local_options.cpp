#include "csrbf/approx/unity/choose_local_options.hpp"

#include "csrbf/approx/unity/local_fit.hpp"
#include "csrbf/approx/unity/partition_of_unity_field.hpp"
#include "csrbf/approx/unity/patch_samples.hpp"
#include "csrbf/core/parallel.hpp"

#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <utility>

namespace csrbf {
namespace {

// Chosen by hand: more patches and targets give more reliable errors and cost more time.
constexpr Index patches = 256;                 // half of them spread over the volume, half over the samples
constexpr Index interpolant_targets = 12;      // samples predicted in each, at most, where it interpolates
constexpr Index least_squares_targets = 1200;  // the same for least squares, where noise hides small differences
constexpr Index cell_samples = 16;             // samples per cell of the cover that places the patches

// Errors as shares of the range of the values, chosen by hand.
constexpr double exact = 1e-10;        // below, accuracy is not worth any time
constexpr double exact_uneven = 5e-9;  // the same for unevenly spread samples, far from which errors are larger
constexpr double noticeable = 1e-6;    // above, an error may be due to noise, and counts before the cost

// Time per sample and evaluation, in units of that of one more radial function in every evaluation (about 7 ns).
constexpr double point_cost = 250;  // the part that is the same for all local functions
constexpr double monomial_cost = 0.4;
constexpr double flop_cost = 0.01;
constexpr double kernel_work = 25;       // flops of a radial function
constexpr double inaccurate_cost = 1e5;  // above all others, of options whose error is noticeable

// The cost counts by a power that grows with the number of samples; chosen by hand.
constexpr double largest_exponent = 4;
constexpr double small_sample = 1e4;  // samples up to which time does not matter

// Trials use fewer patches the longer these take; chosen by hand.
constexpr double little_work = 4e8;  // flops of a trial that may use all patches
constexpr double most_work = 2e9;    // flops of a trial on one patch in usual_stride; on fewer if it takes more
constexpr Index usual_stride = 4, largest_stride = 16;

constexpr Index most_known = 400;  // samples of patches that are kept from trial to trial

constexpr double even_share = 0.05;  // of lopsided patches, above which samples are unevenly spread; chosen by hand

// The search grids, chosen by hand.
constexpr std::array<double, 5> smoothings = {1e-6, 1e-4, 1e-2, 1e-1, 1};
constexpr std::array<double, 5> strong_smoothings = {1e-2, 1e-1, 1, 10, 100};
constexpr std::array<Index, 5> large_patches = {250, 700, 1500, 3000, 6000};  // samples
constexpr Index many_centers = 48;                                            // of a large patch
constexpr const char* fractal_kernel = "powered-exponential";                 // close to r^1.4 within a patch
constexpr double fractal_support = 8;                                         // in radii of the patch

// Samples in patches spread over the data, each predicted by the patch fitted without it: what the search sees of it.
class Trials {
 public:
  Trials() = default;
  Trials(const Trials&) = delete;
  Trials& operator=(const Trials&) = delete;
  virtual ~Trials() = default;

  // Share of the patches spread over the volume whose samples are lopsided.
  [[nodiscard]] virtual double lopsided_share(Index samples) const = 0;

  // Mean over the components of the absolute error, or its square in a unit, at each target of each patch, nearest to
  // its centre first: targets x patches. NaN for patches left out because patches of this size take long.
  [[nodiscard]] virtual Eigen::ArrayXXd errors(const LocalOptions& options, double work,
                                               std::optional<double> unit_of_squares) const = 0;
};

template <int Dim>
class CrossValidation : public Trials {
 public:
  CrossValidation(const Samples<Dim>& samples, const Cover<Dim>& cover)
      : cover_(cover),
        values_(cover.in_order(samples.values)),
        weights_(cover.in_order(samples.weights)),
        tried_(spread_cells(cover, patches)) {}

  [[nodiscard]] double lopsided_share(Index samples) const override {
    typename Cover<Dim>::Search search;
    Index lopsided_patches = 0;
    for (Index i = 0; i < tried_.by_volume; ++i) {
      const Box<Dim>& cell = cover_.cell(tried_.cells[i]);
      cover_.nearest(cell.center(), samples, cell.diagonal(), search);
      if (lopsided<Dim>(cover_.points(), search.found)) ++lopsided_patches;
    }
    return static_cast<double>(lopsided_patches) / static_cast<double>(std::max<Index>(tried_.by_volume, 1));
  }

  [[nodiscard]] Eigen::ArrayXXd errors(const LocalOptions& options, double work,
                                       std::optional<double> unit_of_squares) const override {
    const auto all = static_cast<Index>(tried_.cells.size()), components = values_.cols();
    Index stride = work * static_cast<double>(patches) <= little_work ? 1 : usual_stride;
    while (stride < largest_stride && work * static_cast<double>(patches) > most_work * static_cast<double>(stride))
      stride *= 2;
    std::vector<Index> chosen;
    for (Index i = 0; i < all; i += stride) chosen.push_back(i);
    const auto count = static_cast<Index>(chosen.size());
    const Index most = options.centers < options.samples ? least_squares_targets : interpolant_targets;
    const Index targets = std::clamp<Index>(options.samples / 5, 1, std::min(most, cover_.points().cols()));
    Eigen::ArrayXXd error = Eigen::ArrayXXd::Constant(targets, all, std::numeric_limits<double>::quiet_NaN());
    std::vector<FoundSamples<Dim>>* known = nullptr;
    if (const Index n = std::min(options.samples, cover_.points().cols()); n <= most_known) {
      known = &known_[{n, options.centers > 0 ? options.anisotropy : 0}];
      known->resize(tried_.cells.size());
    }
    const auto compute = [&](Index begin, Index end) {
      LocalFitter<Dim> fitter(cover_, values_, weights_, options);
      LocalModels<Dim> models = fitter.models();
      models.resize(batch_lanes);
      std::vector<double> left_out(batch_lanes * components * targets);
      for (Index b = begin; b < end; ++b) {
        const int used = static_cast<int>(std::min<Index>(batch_lanes, count - batch_lanes * b));
        std::array<Index, batch_lanes> cells{};
        std::array<FoundSamples<Dim>*, batch_lanes> patch_samples{};
        for (int l = 0; l < used; ++l) {
          const auto patch = static_cast<std::size_t>(chosen[static_cast<std::size_t>(batch_lanes * b + l)]);
          cells[l] = tried_.cells[patch];
          if (known != nullptr) patch_samples[l] = &(*known)[patch];
        }
        fitter.fit(cells.data(), used, models, 0, known != nullptr ? patch_samples.data() : nullptr);
        fitter.left_out_errors(targets, left_out.data());
        for (int l = 0; l < used; ++l) {
          const Eigen::Map<const Eigen::ArrayXXd> lane(left_out.data() + components * targets * l, targets, components);
          const Index patch = chosen[batch_lanes * b + l];
          for (Index t = 0; t < targets; ++t)
            error(t, patch) =
                unit_of_squares ? (lane.row(t) / *unit_of_squares).square().mean() : lane.row(t).abs().mean();
        }
      }
    };
    parallel_for((count + batch_lanes - 1) / batch_lanes, 1, compute);
    return error;
  }

 private:
  const Cover<Dim>& cover_;
  Eigen::MatrixXd values_;
  Eigen::VectorXd weights_;
  SpreadCells tried_;
  // Of each of the cells, by their number and anisotropy: many trials have the same.
  mutable std::map<std::pair<Index, double>, std::vector<FoundSamples<Dim>>> known_;
};

// Samples per patch over the leaf size of the cover, as in leaf_size() of fit_patches.cpp: supports overlap, and the
// ball of samples is larger.
double share_of_sample(double growth, int dimension) {
  return 1.25 * 0.72 * std::pow(growth, dimension);
}

// Searches the options step by step; each step keeps the best trial so far.
class Chooser {
 public:
  Chooser(const SampleView& samples, double growth, const Trials& trials, const PartitionOfUnityOptions& given)
      : given_(given),
        dimension_(static_cast<int>(samples.dimension())),
        share_of_sample_(share_of_sample(growth, dimension_)),
        validation_(trials),
        size_(samples.size()),
        range_((samples.values.colwise().maxCoeff() - samples.values.colwise().minCoeff()).maxCoeff()),
        cost_exponent_(given.accuracy > 0
                           ? largest_exponent
                           : std::clamp(2 * std::log10(static_cast<double>(samples.size()) / small_sample), 0.0,
                                        largest_exponent)),
        uneven_(validation_.lopsided_share(base_samples()) > even_share),
        accuracy_(given.accuracy > 0 ? given.accuracy : (uneven_ ? exact_uneven : exact) * range_) {}

  ChosenLocalOptions choose() {
    try_interpolants();
    if (!given_.samples_per_patch) try_larger_patches();
    if (size_ > too_few() && mean(best_.errors, best_.errors) > noticeable * range_) {
      if (!given_.smoothing) try_smoothings(smoothings);
      try_least_squares();
      if (!given_.smoothing) refine_smoothing();
    }
    const double range = range_ > 0 ? range_ : 1;  // squares neither overflow nor vanish
    const Eigen::ArrayXXd squares = validation_.errors(best_.options, best_.work, range);
    return {best_.options, mean(best_.errors, best_.errors), range * std::sqrt(mean(squares, squares))};
  }

 private:
  struct Trial {
    LocalOptions options;
    Eigen::ArrayXXd errors = {};
    double work = 0;
    double cost = 0;
  };

  // Samples to recognise noise, of an interpolant at least, and per patch of the first trials, by dimension; chosen by
  // hand.
  [[nodiscard]] Index too_few() const { return 2 * dimension_; }
  [[nodiscard]] Index fewest_samples() const { return 2 * dimension_ + 2; }
  [[nodiscard]] Index base_samples() const { return by_dimension({16, 60, 100, 160, 200, 250}); }
  // Samples with which an evaluation takes a few microseconds at most.
  [[nodiscard]] Index largest_interpolant() const { return by_dimension({100, 200, 250, 250, 400, 550}); }
  [[nodiscard]] Index by_dimension(const std::array<Index, 6>& numbers) const {
    return numbers[static_cast<std::size_t>(std::min(dimension_, 6) - 1)];
  }
  [[nodiscard]] Index monomials(int degree) const { return monomial_count(dimension_, degree); }

  // Evaluates options, after replacing those given by the user, and keeps them if they are better than the best.
  bool attempt(LocalOptions options) {
    if (given_.kernel) options.kernel = *given_.kernel;
    if (given_.degree) options.degree = *given_.degree;
    const bool everywhere = options.centers == options.samples;
    if (given_.samples_per_patch) options.samples = *given_.samples_per_patch;
    options.samples = std::min(options.samples, size_);
    options.centers = everywhere ? options.samples : std::min(options.centers, options.samples - 1);
    if (given_.centers_per_patch) options.centers = std::min(*given_.centers_per_patch, options.samples);
    if (given_.anisotropy) options.anisotropy = *given_.anisotropy;
    if (given_.smoothing) options.smoothing = *given_.smoothing;
    while (!given_.degree && options.degree > 0 && 2 * monomials(options.degree) > options.samples) --options.degree;
    if (best_.errors.size() > 0 && options == best_.options) return false;
    const double n = static_cast<double>(options.samples), M = static_cast<double>(options.centers),
                 Q = static_cast<double>(monomials(options.degree));
    const double work = options.centers == options.samples ? n * n * n / 3 + n * Q * Q + 10 * n * n
                                                           : n * (Q + M) * (Q + M) + kernel_work * n * M;
    // Of an evaluation, and of the share of a sample in the fit.
    const double cost = point_cost + M + monomial_cost * Q + work * share_of_sample_ / n * flop_cost;
    const Eigen::ArrayXXd errors = validation_.errors(options, work, std::nullopt);
    if (best_.errors.size() == 0) {
      best_ = {options, errors, work, cost};
      return true;
    }
    const double before = score(best_.errors, errors, best_.cost), now = score(errors, best_.errors, cost);
    if (!(now < before)) return false;
    best_ = {options, errors, work, cost};
    return true;
  }

  // Mean error at the targets of both trials, times a power of the cost.
  double score(const Eigen::ArrayXXd& errors, const Eigen::ArrayXXd& others, double cost) const {
    const double error = mean(errors, others);
    return error <= std::max(noticeable * range_, accuracy_)
               ? std::max(error, accuracy_) * std::pow(cost, cost_exponent_)
               : error * std::pow(inaccurate_cost, cost_exponent_);
  }

  static double mean(const Eigen::ArrayXXd& errors, const Eigen::ArrayXXd& others) {
    const Index targets = std::min(errors.rows(), others.rows());
    double sum = 0, count = 0;
    for (Index patch = 0; patch < errors.cols(); ++patch) {
      if (std::isnan(errors(0, patch)) || std::isnan(others(0, patch))) continue;
      sum += errors.col(patch).head(targets).sum();
      count += static_cast<double>(targets);
    }
    return sum / count;
  }

  // Smooth functions need high degrees, rough ones low degrees and rough kernels.
  void try_interpolants() {
    struct Model {
      const char* kernel;
      int degree;
    };
    // Of two that are exact the first stays: without polynomials, straight lines end with the patch.
    constexpr std::array<Model, 9> models = {{{"wendland-c2", 1},
                                              {"wendland-c4", 2},
                                              {"wendland-c6", 3},
                                              {"wendland-c6", 4},
                                              {"wendland-c6", 5},
                                              {"wendland-c6", 6},
                                              {"wendland-c6", 7},
                                              {"wendland-c0", 1},
                                              {"wendland-c0", 0}}};
    for (const Model& model : models) {
      LocalOptions options;
      options.kernel = model.kernel;
      options.degree = model.degree;
      options.samples = options.centers = std::max(base_samples(), (uneven_ ? 10 : 5) * monomials(model.degree) / 2);
      if (options.samples <= largest_interpolant()) attempt(options);
    }
    if (is_rough() && !given_.kernel) {
      LocalOptions options = best_.options;
      options.kernel = fractal_kernel;
      options.support = fractal_support;
      options.degree = 0;
      attempt(options);
    }
    if (uneven_) return;
    for (int degree = 2; degree <= 6; ++degree) {  // polynomials alone are cheapest, but need samples all around
      LocalOptions options;
      options.degree = degree;
      options.samples = 3 * monomials(degree);
      options.centers = 0;
      if (options.samples <= std::min(largest_interpolant(), size_)) attempt(options);
    }
  }

  void try_larger_patches() {
    const LocalOptions first = best_.options;
    if (first.centers == 0) return;
    for (const double factor : {0.5, 1.6, 2.5, 4.0}) {
      if (factor < 1 && uneven_) continue;
      LocalOptions options = first;
      options.samples = options.centers =
          std::max(std::min(size_, fewest_samples()), static_cast<Index>(factor * static_cast<double>(first.samples)));
      if (options.samples > std::min(largest_interpolant(), size_)) break;
      if (!attempt(options) && factor > 1) break;
    }
  }

  template <class Values>
  void try_smoothings(const Values& values) {
    LocalOptions options = best_.options;
    if (options.centers == 0) return;
    for (const double smoothing : values) {
      options.smoothing = smoothing;
      attempt(options);
    }
  }

  // By a decade, then by half of one: finer steps hardly change the errors. Least squares keep the decades of their
  // grid.
  void refine_smoothing() {
    if (!(best_.options.smoothing > 0) || best_.options.centers != best_.options.samples) return;
    for (const double step : {10.0, std::sqrt(10.0)}) {
      LocalOptions options = best_.options;
      const double middle = options.smoothing;
      for (const double smoothing : {middle / step, middle * step}) {
        options.smoothing = smoothing;
        if (attempt(options)) break;
      }
    }
  }

  [[nodiscard]] bool is_rough() const {
    const LocalOptions& best = best_.options;
    return best.centers == best.samples && Kernel(best.kernel, dimension_).is_rough();
  }

  // With noise, many samples per unknown are best.
  void try_least_squares() {
    if (given_.centers_per_patch && given_.samples_per_patch) return;
    int misses = 0;
    for (const Index samples : large_patches) {
      if (4 * samples > size_ || misses == 2) break;
      LocalOptions polynomial;
      polynomial.degree = 4;
      polynomial.samples = samples;
      polynomial.centers = 0;
      LocalOptions radial = polynomial;
      radial.degree = 3;
      radial.centers = many_centers;
      radial.smoothing = best_.options.centers == many_centers ? best_.options.smoothing : 1;
      const bool better = attempt(polynomial);
      misses = attempt(radial) || better ? 0 : misses + 1;
    }
    if (best_.options.centers == many_centers && !given_.smoothing) try_smoothings(strong_smoothings);
  }

  PartitionOfUnityOptions given_;
  int dimension_;
  double share_of_sample_;
  const Trials& validation_;
  Index size_;
  double range_;
  double cost_exponent_;
  bool uneven_;
  double accuracy_;  // error below which more accuracy is not worth any time
  Trial best_;
};

}  // namespace

template <int Dim>
Cover<Dim> cover_to_choose_by(const Samples<Dim>& samples) {
  return {samples.points, cell_samples, cover_growth<Dim>, CoverUse::fitting};
}

template <int Dim>
ChosenLocalOptions choose_local_options(const Samples<Dim>& samples, const Cover<Dim>& cover,
                                        const PartitionOfUnityOptions& given) {
  const CrossValidation<Dim> trials(samples, cover);
  return Chooser(SampleView(samples), cover_growth<Dim>, trials, given).choose();
}

template <int Dim>
ChosenLocalOptions choose_local_options(const Samples<Dim>& samples, const PartitionOfUnityOptions& given) {
  const Cover<Dim> cover = cover_to_choose_by(samples);
  if (samples.weights.size() == 0) return choose_local_options(samples, cover, given);
  return choose_local_options(normalize_weights(samples), cover, given);
}

#define CSRBF_INSTANTIATE(Dim)                                                                  \
  template Cover<Dim> cover_to_choose_by<Dim>(const Samples<Dim>&);                             \
  template ChosenLocalOptions choose_local_options<Dim>(const Samples<Dim>&, const Cover<Dim>&, \
                                                        const PartitionOfUnityOptions&);        \
  template ChosenLocalOptions choose_local_options<Dim>(const Samples<Dim>&, const PartitionOfUnityOptions&);
CSRBF_FOR_EACH_DIM(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
