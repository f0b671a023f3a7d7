#include "csrbf/approx/unity/local_variance.hpp"

#include "csrbf/approx/unity/cell_constants.hpp"
#include "csrbf/approx/unity/local_fit.hpp"
#include "csrbf/approx/unity/partition_of_unity_field.hpp"
#include "csrbf/core/parallel.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace csrbf {
namespace {

// Chosen by hand: more patches resolve the variance better and cost more time.
constexpr Index most_patches = 1024;
constexpr Index fewest_patches = 16;
constexpr Index most_targets = 64;
constexpr double most_products = 1e9;  // multiplications: some hundredths of a second
constexpr double close = 0.03;         // distance of twins over that of neighbours
// Squared errors averaged to a variance: standard deviations are accurate to 1 / sqrt(2 * 48), a tenth.
constexpr Index pooled = 48;
constexpr double nothing = 1e-24;  // of squares: where values are constant

// Samples left out per patch, those nearest to its middle: half of its samples cover its cell.
Index target_count(Index samples) {
  return std::clamp<Index>(samples / 2, 1, most_targets);
}

Index patch_count(Index cells, const LocalOptions& options, int dimension) {
  double polynomials = 1;
  for (int a = 1; a <= dimension; ++a) polynomials *= static_cast<double>(options.degree + a) / a;
  const auto n = static_cast<double>(options.samples);
  const double unknowns = options.centers < options.samples ? polynomials + static_cast<double>(options.centers) : n;
  const double work = unknowns * unknowns * (n + static_cast<double>(target_count(options.samples)));
  return std::min(cells, std::clamp(static_cast<Index>(most_products / work), fewest_patches, most_patches));
}

// Squared errors of samples that were left out.
template <int Dim>
struct Errors {
  Points<Dim> points;
  Eigen::MatrixXd squares;  // components x points, times the weights
  Eigen::VectorXd weights;
};

// Of the samples nearest to the middles of some cells spread over the cover.
template <int Dim>
Errors<Dim> left_out_errors(const Cover<Dim>& cover, const Samples<Dim>& samples, const LocalOptions& options) {
  constexpr Index lanes = batch_lanes;
  const Eigen::MatrixXd values = cover.in_order(samples.values);
  const Eigen::VectorXd weights = cover.in_order(samples.weights);
  const Index count = patch_count(cover.size(), options, Dim);
  const Index C = values.cols(), targets = target_count(std::min(options.samples, values.rows()));
  std::vector<Index> cells;
  for (Index i = 0; i < count; ++i) cells.push_back(i * cover.size() / count);
  Errors<Dim> errors{Points<Dim>(Dim, count * targets), Eigen::MatrixXd(C, count * targets),
                     Eigen::VectorXd::Ones(count * targets)};
  parallel_for((count + lanes - 1) / lanes, 4, [&](Index begin, Index end) {
    LocalFitter<Dim> fitter(cover, values, weights, options);
    LocalModels<Dim> models = fitter.models();
    models.resize(lanes);
    typename Cover<Dim>::Search search;
    std::vector<double> error(lanes * C * targets);
    for (Index first = lanes * begin; first < std::min(count, lanes * end); first += lanes) {
      const Index used = std::min(lanes, count - first);
      fitter.fit(cells.data() + first, static_cast<int>(used), models, 0);
      fitter.left_out_errors(targets, error.data());
      for (Index l = 0; l < used; ++l) {
        const Box<Dim>& cell = cover.cell(cells[first + l]);
        cover.nearest(cell.center(), targets, cell.diagonal(), search);
        for (Index t = 0; t < targets; ++t) {
          const Index k = (first + l) * targets + t;
          const std::uint32_t id = search.found[t].second;
          errors.points.col(k) = cover.points().col(id);
          if (weights.size() > 0) errors.weights[k] = weights[id];
          for (Index c = 0; c < C; ++c)
            errors.squares(c, k) = errors.weights[k] * std::pow(error[(l * C + c) * targets + t], 2);
        }
      }
    }
  });
  return errors;
}

// Whether a point has another, of those that are kept, at a small share of the distances of its neighbours.
template <int Dim>
bool has_twin(const Cover<Dim>& cover, Index i, const std::vector<char>& kept, typename Cover<Dim>::Search& search) {
  constexpr Index neighbors = 2 * Dim + 2;
  cover.nearest(cover.points().col(i), std::min(neighbors, cover.points().cols()), 0, search);
  const double near2 = close * close * search.found.back().first;
  return std::any_of(search.found.begin(), search.found.end(), [&](const auto& found) {
    return found.first < near2 && static_cast<Index>(found.second) != i && kept[found.second] != 0;
  });
}

// The samples without all but one of those that are twins, where these are many: one left out is predicted by its twin,
// which says nothing of the places between. None where they are few.
template <int Dim>
std::optional<Samples<Dim>> without_twins(const Samples<Dim>& samples, const Cover<Dim>& cover) {
  constexpr Index asked = 200, few = 20;  // samples
  const Index n = cover.points().cols(), count = std::min(asked, n);
  std::vector<char> kept(static_cast<std::size_t>(n), 1);
  typename Cover<Dim>::Search search;
  Index twins = 0;
  for (Index k = 0; k < count; ++k) twins += has_twin(cover, (2 * k + 1) * n / (2 * count), kept, search) ? 1 : 0;
  if (twins * asked <= few * count) return std::nullopt;
  std::vector<Index> apart;
  for (Index i = 0; i < n; ++i) {
    kept[i] = has_twin(cover, i, kept, search) ? 0 : 1;
    if (kept[i] != 0) apart.push_back(cover.order()[i]);
  }
  return chosen_samples(samples, apart);
}

}  // namespace

template <int Dim>
std::vector<std::shared_ptr<const Field<Dim>>> local_variance(const Samples<Dim>& samples,
                                                              const PartitionOfUnityFit<Dim>& fit) {
  const auto errors_of = [&](const Samples<Dim>& used) {
    const auto apart = without_twins(used, fit.data->cover);
    if (!apart) return left_out_errors<Dim>(fit.data->cover, used, fit.report.local);
    LocalOptions local = fit.report.local;
    local.samples = std::min(local.samples, apart->size());
    local.centers = std::min(local.centers, local.samples);
    return left_out_errors<Dim>(Cover<Dim>(apart->points, pooled, cover_growth<Dim>), *apart, local);
  };
  const Errors<Dim> errors = samples.weights.size() == 0 ? errors_of(samples) : errors_of(normalize_weights(samples));
  return local_means<Dim>(errors.points, errors.squares, errors.weights, errors.squares.rowwise().mean() / pooled);
}

template <int Dim>
std::vector<std::shared_ptr<const Field<Dim>>> local_means(const Points<Dim>& points, const Eigen::MatrixXd& squares,
                                                           const Eigen::VectorXd& weights,
                                                           const Eigen::VectorXd& least) {
  Cover<Dim> cover(points, pooled, cover_growth<Dim>);
  Eigen::MatrixXd means = Eigen::MatrixXd::Zero(squares.rows(), cover.size());
  typename Cover<Dim>::Search search;
  for (Index i = 0; i < cover.size(); ++i) {
    const Box<Dim>& cell = cover.cell(i);
    cover.nearest(cell.center(), pooled, cell.diagonal(), search);
    double weight = 0;
    for (const auto& [distance2, id] : search.found) {
      means.col(i) += squares.col(cover.order()[id]);
      weight += weights.size() == 0 ? 1 : weights[cover.order()[id]];
    }
    if (weight > 0) means.col(i) /= weight;
    if (least.size() > 0) means.col(i) = (means.col(i).array() > nothing * least.array()).select(means.col(i), least);
  }
  return cell_constants<Dim>(std::move(cover), means);
}

#define CSRBF_INSTANTIATE(Dim)                                                                                  \
  template std::vector<std::shared_ptr<const Field<Dim>>> local_variance<Dim>(const Samples<Dim>&,              \
                                                                              const PartitionOfUnityFit<Dim>&); \
  template std::vector<std::shared_ptr<const Field<Dim>>> local_means<Dim>(                                     \
      const Points<Dim>&, const Eigen::MatrixXd&, const Eigen::VectorXd&, const Eigen::VectorXd&);
CSRBF_FOR_EACH_DIM(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
