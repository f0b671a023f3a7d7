#include "csrbf/approx/kriging/fill_gaps.hpp"

#include "csrbf/approx/basis/expansion.hpp"
#include "csrbf/approx/global/interpolate.hpp"
#include "csrbf/approx/kriging/cell_parts.hpp"
#include "csrbf/approx/kriging/distance_growth.hpp"
#include "csrbf/approx/kriging/find_gaps.hpp"
#include "csrbf/approx/kriging/local_kriging.hpp"
#include "csrbf/approx/samples/blended_field.hpp"
#include "csrbf/approx/unity/cell_constants.hpp"
#include "csrbf/approx/unity/partition_of_unity_field.hpp"
#include "csrbf/core/parallel.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace csrbf {
namespace {

// Half diagonal of a cell in a gap over the distance to the nearest sample: in one dimension its support ends there.
template <int Dim>
constexpr double shrink = std::min(0.7, 1 / cover_growth<Dim>);
constexpr double finest = 1.5;           // the smallest half diagonal, in distances of samples; both chosen by hand
constexpr double finest_of_patch = 0.5;  // the same, in distances of samples in the patch
constexpr double doubt = 2;            // times that of kriging: the error of patches of rough values in gaps, at least
constexpr double strain = 16;          // growth of the squared error of a patch, from which on it is compared
constexpr Index largest_dense = 1000;  // system
constexpr int deepest = 40;            // halvings of a cell; never reached unless samples are extremely uneven
constexpr double least_variance = 1e-300;  // of a quotient

// By one system for some of the samples with a linear variogram, see Covariance; none if it cannot be solved.
template <int Dim>
std::vector<std::shared_ptr<const Field<Dim>>> linear_interpolant(const Samples<Dim>& samples,
                                                                  const std::vector<Index>& used,
                                                                  const Covariance& covariance) {
  Samples<Dim> some = chosen_samples(samples, used);
  InterpolateOptions options;
  options.kernel = "linear";
  options.support = covariance.length;
  options.smoothing = covariance.nugget;
  options.keep_weights = true;
  options.dense_limit = largest_dense;
  try {
    return interpolate(some, options).model();
  } catch (const SolverFailure&) {
    return {};
  }
}

template <int Dim>
class GapFiller {
 public:
  GapFiller(const Samples<Dim>& samples, const PartitionOfUnityFit<Dim>& fit,
            const std::vector<std::shared_ptr<const Field<Dim>>>& variances, bool tracks)
      : samples_(samples),
        fit_(fit),
        variances_(variances),
        tracks_(tracks),
        cover_(fit.data->cover),
        patches_(fit),
        finder_(fit, patches_),
        growth_(samples, fit, variances),
        noticeable_(noticeable_error(samples)) {}

  std::optional<FilledGaps<Dim>> fill() const {
    Points<Dim> centers(Dim, cover_.size());
    for (Index i = 0; i < cover_.size(); ++i) centers.col(i) = cover_.cell(i).center();
    Eigen::MatrixXd errors(std::ssize(variances_), centers.cols());
    for (Index c = 0; c < errors.rows(); ++c) errors.row(c) = variances_[c]->evaluate(centers).value.transpose();
    CellParts<Dim> parts(static_cast<std::size_t>(cover_.size()));
    std::optional<FilledGaps<Dim>> filled = with_other_functions(errors, parts);
    auto grown = growth_.grown(patches_, variances_);
    if (grown.empty()) return filled;
    if (!filled) return FilledGaps<Dim>{.fit = fit_, .variances = std::move(grown)};
    Eigen::MatrixXd has_gap(1, cover_.size());
    for (Index i = 0; i < cover_.size(); ++i) has_gap(0, i) = parts[i].size() > 1 || parts[i].front().is_wide ? 1 : 0;
    const auto share = cell_constants<Dim>(Cover<Dim>(cover_.tree()), has_gap).front();
    for (std::size_t c = 0; c < grown.size(); ++c)
      filled->variances[c] = std::make_shared<const BlendedField<Dim>>(filled->variances[c], grown[c], share);
    return filled;
  }

 private:
  // Where there are gaps; sets the parts of all cells.
  std::optional<FilledGaps<Dim>> with_other_functions(const Eigen::MatrixXd& errors, CellParts<Dim>& parts) const {
    for (Index i = 0; i < cover_.size(); ++i) parts[i].emplace_back().variance = errors.col(i);
    std::vector<Index> cells = finder_.cells_with_gaps();
    if (!cells.empty()) cells = finder_.doubtful(cells, samples_, errors);
    if (cells.empty()) return std::nullopt;
    const LocalKriging<Dim> kriging(samples_, finder_.points_in_gaps(cells, errors));
    parallel_for(std::ssize(cells), 4, [&](Index first, Index last) {
      typename PatchErrors<Dim>::Patch work;
      for (Index k = first; k < last; ++k) {
        const Index cell = cells[static_cast<std::size_t>(k)];
        parts[cell].clear();
        patches_.enter(cell, errors.col(cell), work);
        patches_.prepare(work);
        split(kriging, cover_.cell(cell), 0, work, parts[cell]);
      }
    });
    std::vector<PlacedPart<Dim>> leaves;
    const Cover<Dim> cover(tree_of_parts<Dim>(cover_.tree(), parts, leaves));
    const Index wide =
        std::count_if(leaves.begin(), leaves.end(), [](const auto& leaf) { return leaf.second->is_wide; });
    if (wide == 0) {
      for (const Index cell : cells) parts[cell] = std::vector<CellPart<Dim>>(1);
      return std::nullopt;
    }
    return with_cells(kriging, cover, leaves, wide);
  }

  // Of all components of local function i.
  static Eigen::VectorXd value(const LocalModels<Dim>& models, Index i, const Point<Dim>& x) {
    constexpr int lanes = LocalEvaluator<Dim>::lanes;
    LocalEvaluator<Dim> evaluator(models);
    double at[Dim * lanes], f[LocalEvaluator<Dim>::terms][lanes];
    for (int a = 0; a < Dim; ++a) std::fill_n(at + lanes * a, lanes, x[a]);
    Eigen::VectorXd values(models.components);
    for (Index c = 0; c < models.components; ++c) {
      evaluator.evaluate(i, c, at, Derivatives::none, f);
      values[c] = f[0][0];
    }
    return values;
  }

  // A part of a cell, and the work space of its patch.
  struct Part {
    const Box<Dim>& box;
    int depth;
    Points<Dim> probes;  // of it, then of its support
    Eigen::VectorXd distance;
    double spacing, limit;  // of samples; the distance to the nearest one from which on there is a gap
    Eigen::VectorXd fine;   // mean square error of the local function in the middle, by its own account

    [[nodiscard]] double half() const { return 0.5 * box.diagonal(); }
    [[nodiscard]] bool in_gap(Index probe) const { return distance[probe] > limit; }
  };
  static constexpr Index middle = probes_each<Dim> / 2;

  Part part_of(const LocalKriging<Dim>& kriging, const Box<Dim>& box, int depth,
               typename PatchErrors<Dim>::Patch& work) const {
    Part part{box, depth, Points<Dim>(Dim, 2 * probes_each<Dim>), Eigen::VectorXd(2 * probes_each<Dim>), 0, 0, {}};
    part.probes << probes(box), probes(support_of(cover_, box));
    for (Index k = 0; k < part.probes.cols(); ++k)
      part.distance[k] = patches_.nearest(part.probes.col(k), patches_.gap() * work.radius, work.search);
    part.spacing = std::max(patches_.spacing_at(box.center(), work), 1e-300);
    const bool soon = kriging.is_linear() && !tracks_;
    part.limit = soon ? part.spacing : patches_.gap() / patches_.spacing() * part.spacing;
    part.fine = patches_.error(box.center(), part.distance[middle], part.spacing, work);
    return part;
  }

  bool is_fine_enough(const Part& part, const typename PatchErrors<Dim>::Patch& work) const {
    double finer = finest_of_patch * patches_.spacing() * work.radius;
    if (Dim == 1) finer = std::min(finer, shrink<Dim> * part.distance[middle]);  // a gap has two ends, soon reached
    return part.depth >= deepest || part.half() <= std::max(finest * part.spacing, finer);
  }

  // What becomes of a part.
  enum class Choice { fine, wide, split };

  // Where values are rough: what lies in a gap is wide, whatever the local function says of its errors.
  Choice choose_rough(const LocalKriging<Dim>& kriging, const Part& part, typename PatchErrors<Dim>::Patch& work,
                      CellPart<Dim>& node) const {
    Index inside = 0;
    for (Index k = 0; k < probes_each<Dim>; ++k) inside += part.in_gap(k) ? 1 : 0;
    const bool is_inside = inside == probes_each<Dim> && part.half() <= shrink<Dim> * part.distance[middle];
    if (!is_inside && !is_fine_enough(part, work)) return Choice::split;
    const KrigingPatch<Dim> patch = kriging.patch(part.box.center());
    Eigen::VectorXd mean = Eigen::VectorXd::Zero(samples_.components());  // over the part, by Simpson's rule
    double sum = 0;                                                       // of the differences of expected errors
    for (Index k = 0; k < probes_each<Dim>; ++k) {
      const Eigen::VectorXd other = patch.variance(part.probes.col(k));
      Eigen::VectorXd own = patches_.error(part.probes.col(k), part.distance[k], part.spacing, work);
      if (part.in_gap(k)) own = own.cwiseMax(doubt * other);
      sum += (own - other).cwiseQuotient(other.cwiseMax(least_variance)).sum();
      mean += simpson_weight<Dim>(k) * other;
    }
    const bool is_wide = sum > 0;
    node.variance = is_wide ? mean : Eigen::VectorXd(mean.cwiseProduct(part.fine).cwiseSqrt());
    return is_wide ? Choice::wide : Choice::fine;
  }

  // Whether kriging from around a part that this one lies in has the smaller expected error somewhere in this one. What
  // is made of the samples around this part itself knows no less.
  bool gains_somewhere(const KrigingPatch<Dim>& patch, const Part& part, typename PatchErrors<Dim>::Patch& work) const {
    const Eigen::VectorXd scale = patch.variance(part.box.center());
    for (Index k = 0; k < part.probes.cols(); ++k) {
      const Eigen::VectorXd own = patches_.error(part.probes.col(k), part.distance[k], part.spacing, work);
      if ((own - patch.variance(part.probes.col(k))).cwiseQuotient(scale).sum() > 0) return true;
    }
    return false;
  }

  // Otherwise what has the smaller expected error, but nothing that a smooth covariance makes of a step.
  Choice choose_smooth(const KrigingPatch<Dim>& patch, const LocalKriging<Dim>& kriging, const Part& part,
                       typename PatchErrors<Dim>::Patch& work, CellPart<Dim>& node) const {
    const Eigen::VectorXd scale = patch.variance(part.box.center());
    auto model = std::make_unique<LocalModels<Dim>>(kriging.models(1));
    patch.store(*model, 0);
    bool is_wild = false;
    Index wide = 0, wide_inside = 0;
    double sum = 0;                                              // of the differences of expected errors in the part
    Eigen::VectorXd mean = Eigen::VectorXd::Zero(scale.size());  // variance of kriging in it, by Simpson's rule
    for (Index k = 0; k < part.probes.cols(); ++k) {
      const Point<Dim> x = part.probes.col(k);
      const Eigen::VectorXd other = k == middle ? scale : patch.variance(x);
      Eigen::VectorXd own = k == middle ? part.fine : patches_.error(x, part.distance[k], part.spacing, work);
      if (part.in_gap(k)) {
        const Eigen::VectorXd here = value(fit_.data->models, work.cell, x), there = value(*model, 0, x);
        is_wild = is_wild || (patch.is_plausible(here) && !patch.is_plausible(there));
        own = own.cwiseMax((here - there).cwiseAbs2() - other);
      }
      const double gain = (own - other).cwiseQuotient(scale).sum();
      if (k < probes_each<Dim>) {
        sum += gain;
        mean += simpson_weight<Dim>(k) * other;
      }
      if (!(gain > 0)) continue;
      ++wide;
      if (k < probes_each<Dim>) ++wide_inside;
    }
    node.variance = mean.cwiseProduct(part.fine).cwiseSqrt();  // both are estimates
    if (wide == 0) return Choice::fine;
    if (is_wild && !is_fine_enough(part, work)) return Choice::split;
    if (is_wild) {
      node.variance = mean.cwiseMax(part.fine);
      return Choice::fine;
    }
    const bool is_inside = wide_inside == probes_each<Dim> && part.half() <= shrink<Dim> * part.distance[middle];
    if (!is_inside && !is_fine_enough(part, work)) return Choice::split;
    if (!(sum > 0)) return Choice::fine;
    node.variance = mean;
    node.wide = std::move(model);
    return Choice::wide;
  }

  // `around`: kriging from around a larger part; may be null.
  void split(const LocalKriging<Dim>& kriging, const Box<Dim>& box, int depth, typename PatchErrors<Dim>::Patch& work,
             std::vector<CellPart<Dim>>& nodes, const KrigingPatch<Dim>* around = nullptr) const {
    const std::size_t at = nodes.size();
    nodes.emplace_back();
    const Part part = part_of(kriging, box, depth, work);
    nodes[at].variance = part.fine;
    const bool is_strained = (part.fine.array() > (strain * work.error).cwiseMax(noticeable_).array()).any();
    if (part.distance.maxCoeff() <= part.limit && !is_strained) return;
    std::optional<KrigingPatch<Dim>> patch;
    Choice choice = Choice::split;
    if (kriging.is_linear()) {
      choice = choose_rough(kriging, part, work, nodes[at]);
    } else if (around == nullptr || part.half() <= shrink<Dim> * part.distance[middle] || is_fine_enough(part, work) ||
               !gains_somewhere(*around, part, work)) {
      around = &patch.emplace(kriging.patch(box.center()));
      choice = choose_smooth(*around, kriging, part, work, nodes[at]);
    }
    nodes[at].is_wide = choice == Choice::wide;
    if (choice == Choice::fine)
      nodes[at].variance =
          nodes[at].variance.cwiseMax(growth_.factor(part.distance[middle] / part.spacing).cwiseProduct(work.error));
    if (choice != Choice::split) return;
    halve(nodes, at, box, [&](const Box<Dim>& half) { split(kriging, half, depth + 1, work, nodes, around); });
  }

  FilledGaps<Dim> with_cells(const LocalKriging<Dim>& kriging, const Cover<Dim>& cover,
                             const std::vector<PlacedPart<Dim>>& leaves, Index wide) const {
    const Index count = std::ssize(leaves);
    Eigen::MatrixXd variance(samples_.components(), count), outside(1, count);
    for (Index i = 0; i < count; ++i) {
      const CellPart<Dim>& part = *leaves[static_cast<std::size_t>(i)].second;
      variance.col(i) = part.variance;
      outside(0, i) = part.is_wide ? 0 : 1;
    }
    FilledGaps<Dim> result;
    result.fit = fit_;
    result.fit.report.patches = count;
    result.patches = wide;
    result.variances = cell_constants<Dim>(cover, variance);
    result.outside = cell_constants<Dim>(cover, outside).front();
    if (kriging.is_linear()) result.inside = one_system(kriging, cover, leaves);
    result.fit.data = with_parts(kriging, cover, leaves, result.inside.empty() ? wide : 0);
    return result;
  }

  // One system of all samples that the patches in the gaps are made of; none if it cannot be solved.
  std::vector<std::shared_ptr<const Field<Dim>>> one_system(const LocalKriging<Dim>& kriging, const Cover<Dim>& cover,
                                                            const std::vector<PlacedPart<Dim>>& leaves) const {
    std::vector<char> is_used(static_cast<std::size_t>(samples_.size()), 0);
    for (Index i = 0; i < cover.size(); ++i)
      if (leaves[static_cast<std::size_t>(i)].second->is_wide)
        for (const Index k : kriging.around(cover.cell(i).center())) is_used[static_cast<std::size_t>(k)] = 1;
    std::vector<Index> used;
    for (Index k = 0; k < samples_.size(); ++k)
      if (is_used[static_cast<std::size_t>(k)] != 0) used.push_back(k);
    return linear_interpolant(samples_, used, kriging.covariance());
  }

  // The tree with the parts in place of their cells, and other functions in gaps: `wide` of them, or none.
  std::shared_ptr<const PartitionOfUnityData<Dim>> with_parts(const LocalKriging<Dim>& kriging, const Cover<Dim>& cover,
                                                              const std::vector<PlacedPart<Dim>>& leaves,
                                                              Index wide) const {
    using Data = PartitionOfUnityData<Dim>;
    auto data = std::make_shared<Data>(Data{cover, {}});
    const LocalModels<Dim>& old = fit_.data->models;
    LocalModels<Dim>& models = data->models;
    const auto count = std::ssize(leaves);
    models.degree = old.degree;
    models.kernel = old.kernel;
    models.support = old.support;
    models.centers_each = old.centers_each;
    models.components = old.components;
    models.anisotropic = old.anisotropic;
    models.resize(count);
    if (wide > 0) data->wide = kriging.models(wide);
    if (wide > 0) data->wide_of.assign(leaves.size(), -1);
    std::int32_t next = 0;
    for (Index i = 0; i < count; ++i) {
      const auto& [cell, node] = leaves[static_cast<std::size_t>(i)];
      copy_model(old, cell, models, i);
      if (node->is_wide && wide > 0) data->wide_of[static_cast<std::size_t>(i)] = next++;
    }
    parallel_for(count, 16, [&](Index first, Index last) {
      for (Index i = first; i < last; ++i) {
        if (!data->is_wide(i)) continue;
        const auto& own = leaves[static_cast<std::size_t>(i)].second->wide;
        const Index place = data->wide_of[static_cast<std::size_t>(i)];
        if (own)
          copy_model(*own, 0, data->wide, place);
        else
          kriging.patch(cover.cell(i).center()).store(data->wide, place);
      }
    });
    return data;
  }

  static void copy_model(const LocalModels<Dim>& from, Index i, LocalModels<Dim>& to, Index j) {
    to.center.col(j) = from.center.col(i);
    to.radius[j] = from.radius[i];
    const auto part = [&](const std::vector<double>& source, std::vector<double>& target) {
      const auto each = static_cast<std::ptrdiff_t>(source.size()) / from.size();
      std::copy_n(source.begin() + each * i, each, target.begin() + each * j);
    };
    part(from.metric, to.metric);
    part(from.position, to.position);
    part(from.alpha, to.alpha);
    part(from.polynomial, to.polynomial);
  }

  const Samples<Dim>& samples_;
  const PartitionOfUnityFit<Dim>& fit_;
  const std::vector<std::shared_ptr<const Field<Dim>>>& variances_;
  bool tracks_;
  const Cover<Dim>& cover_;
  PatchErrors<Dim> patches_;
  GapFinder<Dim> finder_;
  DistanceGrowth<Dim> growth_;
  Eigen::VectorXd noticeable_;
};

}  // namespace

template <int Dim>
FilledGaps<Dim> fill_gaps(const Samples<Dim>& samples, PartitionOfUnityFit<Dim> fit,
                          std::vector<std::shared_ptr<const Field<Dim>>> variances, bool tracks) {
  if constexpr (Dim <= 3) {
    const Samples<Dim> normalized = normalize_weights(samples);
    std::optional<FilledGaps<Dim>> filled = GapFiller<Dim>(normalized, fit, variances, tracks).fill();
    if (filled) return std::move(*filled);
  }
  FilledGaps<Dim> unchanged;
  unchanged.fit = std::move(fit);
  unchanged.variances = std::move(variances);
  return unchanged;
}

template <int Dim>
std::vector<std::shared_ptr<const Field<Dim>>> FilledGaps<Dim>::fields() const {
  std::vector<std::shared_ptr<const Field<Dim>>> result = fit.fields();
  for (std::size_t c = 0; c < inside.size(); ++c)
    result[c] = std::make_shared<const BlendedField<Dim>>(result[c], inside[c], outside);
  return result;
}

#define CSRBF_INSTANTIATE(Dim)                                                             \
  template std::vector<std::shared_ptr<const Field<Dim>>> FilledGaps<Dim>::fields() const; \
  template FilledGaps<Dim> fill_gaps<Dim>(const Samples<Dim>&, PartitionOfUnityFit<Dim>,   \
                                          std::vector<std::shared_ptr<const Field<Dim>>>, bool);
CSRBF_FOR_EACH_DIM(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
