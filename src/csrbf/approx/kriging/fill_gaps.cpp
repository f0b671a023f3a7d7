#include "csrbf/approx/kriging/fill_gaps.hpp"

#include "csrbf/approx/kriging/local_kriging.hpp"
#include "csrbf/approx/kriging/patch_errors.hpp"
#include "csrbf/approx/kriging/spread_point.hpp"
#include "csrbf/approx/unity/partition_of_unity_field.hpp"
#include "csrbf/core/parallel.hpp"
#include "csrbf/core/shared_evaluate.hpp"

#include <array>
#include <cmath>
#include <optional>

namespace csrbf {
namespace {

constexpr double shrink = 0.7;           // half diagonal of a cell in a gap over the distance to the nearest sample
constexpr double finest = 1.5;           // the smallest half diagonal, in distances of samples; both chosen by hand
constexpr double finest_of_patch = 0.5;  // the same, in distances of samples in the patch
constexpr double noticeable = 1e-4;      // deviations of the values; in a gap kriging is hardly ever better
constexpr int deepest = 40;              // halvings of a cell; never reached unless samples are extremely uneven

template <int Dim>
constexpr Index probes_each = Dim == 1   ? 3
                              : Dim == 2 ? 9
                                         : 27;

// The corners of a box, the middles of its edges and faces, and its own.
template <int Dim>
Points<Dim> probes(const Box<Dim>& box) {
  Points<Dim> x(Dim, probes_each<Dim>);
  for (Index k = 0; k < x.cols(); ++k)
    for (Index a = 0, rest = k; a < Dim; ++a, rest /= 3)
      x(a, k) = box.lo[a] + 0.5 * static_cast<double>(rest % 3) * (box.hi[a] - box.lo[a]);
  return x;
}

// Of the k-th of them, for a mean over the box: 1/6, 4/6, 1/6 along each axis.
template <int Dim>
double simpson_weight(Index k) {
  double weight = 1;
  for (Index a = 0, rest = k; a < Dim; ++a, rest /= 3) weight *= rest % 3 == 1 ? 4.0 / 6 : 1.0 / 6;
  return weight;
}

// A part of a cell of the partition of unity, in preorder.
template <int Dim>
struct Node {
  std::int8_t axis = -1;
  double split = 0;
  std::size_t right = 0;  // of the nodes of this cell
  Eigen::VectorXd variance = {};
  std::unique_ptr<const LocalModels<Dim>> wide = nullptr;  // the local function, of a part in a gap
};

template <int Dim>
class GapFiller {
 public:
  GapFiller(const Samples<Dim>& samples, const PartitionOfUnityFit<Dim>& fit,
            const std::vector<std::shared_ptr<const Field<Dim>>>& variances)
      : samples_(samples), fit_(fit), variances_(variances), cover_(fit.data->cover), patches_(fit) {}

  // Cells with a gap between samples in their support.
  std::vector<Index> cells_with_gaps() const {
    std::vector<char> has_gap(static_cast<std::size_t>(cover_.size()), 0);
    if (patches_.gap() >= 1) return {};                // patches of too few samples
    std::vector<Index> end_of(has_gap.size() + 1, 0);  // samples up to each cell
    for (Index i = 0; i < cover_.size(); ++i) end_of[i + 1] = end_of[i] + cover_.count(i);
    parallel_for(cover_.size(), 256, [&](Index first, Index last) {
      typename Cover<Dim>::Search search;
      for (Index i = first; i < last; ++i) {
        const Box<Dim>& cell = cover_.cell(i);
        const double radius = std::min(fit_.data->models.radius[i], usual_radius(cell, end_of[i + 1] - end_of[i]));
        const Points<Dim> x = probes(cell);
        if (all_near(x, patches_.gap() * radius, end_of[i], end_of[i + 1])) continue;
        cover_.nearest(cell.center(), patches_.unknowns(), radius, search);
        const double reach = patches_.gap() * std::sqrt(search.found.back().first);
        for (Index k = 0; k < x.cols() && has_gap[i] == 0; ++k)
          if (patches_.nearest(x.col(k), reach, search) > reach * inside_factor(x.col(k))) has_gap[i] = 1;
      }
    });
    std::vector<char> reaches_gap = has_gap;
    for (Index i = 0; i < cover_.size(); ++i)
      if (has_gap[i] != 0)
        for (const std::uint32_t support : cover_.supports_over(i)) reaches_gap[support] = 1;
    std::vector<Index> cells;
    for (Index i = 0; i < cover_.size(); ++i)
      if (reaches_gap[i] != 0) cells.push_back(i);
    return cells;
  }

  std::optional<FilledGaps<Dim>> fill(std::vector<Index> cells) const {
    Points<Dim> centers(Dim, cover_.size());
    for (Index i = 0; i < cover_.size(); ++i) centers.col(i) = cover_.cell(i).center();
    Eigen::MatrixXd errors(std::ssize(variances_), centers.cols());
    for (Index c = 0; c < errors.rows(); ++c)
      errors.row(c) = shared_evaluate(*variances_[c], centers).value.transpose();
    cells = doubtful(cells, errors);
    if (cells.empty()) return std::nullopt;
    const LocalKriging<Dim> kriging(samples_, points_in_gaps(cells, errors));
    std::vector<std::vector<Node<Dim>>> parts(static_cast<std::size_t>(cover_.size()));
    parallel_for(std::ssize(cells), 4, [&](Index first, Index last) {
      typename PatchErrors<Dim>::Patch work;
      for (Index k = first; k < last; ++k) {
        const Index cell = cells[static_cast<std::size_t>(k)];
        patches_.enter(cell, errors.col(cell), work);
        split(kriging, cover_.cell(cell), 0, work, parts[cell]);
      }
    });
    for (Index i = 0; i < cover_.size(); ++i)
      if (parts[i].empty()) parts[i].emplace_back().variance = errors.col(i);
    return assemble(kriging, parts);
  }

  // Points spread evenly over some cells, farther from the nearest samples than these from each other.
  Points<Dim> points_in_gaps(const std::vector<Index>& cells, const Eigen::MatrixXd& errors) const {
    constexpr Index count = 1000;  // in all, about; chosen by hand
    double volume = 0, reached = 0.5;
    for (const Index cell : cells) volume += cover_.cell(cell).extent().prod();
    std::vector<Point<Dim>> found;
    typename PatchErrors<Dim>::Patch work;
    Index taken = 0;
    for (const Index cell : cells) {
      const Box<Dim>& box = cover_.cell(cell);
      reached += volume > 0 ? count * box.extent().prod() / volume : 0;
      if (static_cast<double>(taken + 1) > reached) continue;
      patches_.enter(cell, errors.col(cell), work);
      for (; static_cast<double>(taken + 1) <= reached; ++taken) {
        const Point<Dim> x = box.lo + spread_point<Dim>(taken).cwiseProduct(box.extent());
        if (patches_.nearest(x, work.radius, work.search) > patches_.spacing_at(x, work)) found.push_back(x);
      }
    }
    Points<Dim> result(Dim, std::ssize(found));
    for (Index k = 0; k < result.cols(); ++k) result.col(k) = found[static_cast<std::size_t>(k)];
    return result;
  }

  // Those of the cells where the local function may have a noticeable error.
  std::vector<Index> doubtful(const std::vector<Index>& cells, const Eigen::MatrixXd& errors) const {
    const Eigen::RowVectorXd mean = samples_.values.colwise().mean();
    const Eigen::VectorXd least =
        noticeable * noticeable * (samples_.values.rowwise() - mean).cwiseAbs2().colwise().mean().transpose();
    std::vector<char> is_doubtful(cells.size(), 0);
    parallel_for(std::ssize(cells), 16, [&](Index first, Index last) {
      typename PatchErrors<Dim>::Patch work;
      for (Index i = first; i < last; ++i) {
        const Index cell = cells[static_cast<std::size_t>(i)];
        patches_.enter(cell, errors.col(cell), work);
        const Points<Dim> x = probes(support_of(cover_.cell(cell)));
        const double spacing = std::max(patches_.spacing_at(cover_.cell(cell).center(), work), 1e-300);
        for (Index k = 0; k < x.cols() && is_doubtful[i] == 0; ++k) {
          const double distance = patches_.nearest(x.col(k), patches_.gap() * work.radius, work.search);
          if ((patches_.error(x.col(k), distance, spacing, work).array() > least.array()).any()) is_doubtful[i] = 1;
        }
      }
    });
    std::vector<Index> chosen;
    for (std::size_t i = 0; i < cells.size(); ++i)
      if (is_doubtful[i] != 0) chosen.push_back(cells[i]);
    return chosen;
  }

 private:
  // Samples lie on one side of the faces of the box only: a ball about a point there must be larger to hold as many.
  double inside_factor(const Point<Dim>& x) const {
    constexpr double at_face = 1e-6;  // of the extent of the box, far above its margin
    const Box<Dim>& box = cover_.box();
    const Point<Dim> distance = (x - box.lo).cwiseMin(box.hi - x).cwiseQuotient(box.extent());
    return std::pow(2.0, static_cast<double>((distance.array() < at_face).count()) / Dim);
  }

  // Radius of a ball with as many samples as a local function has unknowns, as dense as those of a cell.
  double usual_radius(const Box<Dim>& cell, Index count) const {
    const double volume = cell.extent().prod() * static_cast<double>(patches_.unknowns()) / static_cast<double>(count);
    return std::pow(volume / unit_ball_volume<Dim>, 1.0 / Dim);
  }

  // Whether every point of a list has one of the samples [begin, end) within `reach`.
  bool all_near(const Points<Dim>& x, double reach, Index begin, Index end) const {
    const auto samples = cover_.points().middleCols(begin, end - begin);
    for (Index k = 0; k < x.cols(); ++k) {
      bool near = false;
      for (Index i = 0; i < samples.cols() && !near; ++i)
        near = (samples.col(i) - x.col(k)).squaredNorm() <= reach * reach;
      if (!near) return false;
    }
    return true;
  }

  [[nodiscard]] Box<Dim> support_of(const Box<Dim>& cell) const {
    const Point<Dim> center = cell.center(), half = 0.5 * cover_.growth() * cell.extent();
    return {(center - half).cwiseMax(cover_.box().lo), (center + half).cwiseMin(cover_.box().hi)};
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

  void split(const LocalKriging<Dim>& kriging, const Box<Dim>& box, int depth, typename PatchErrors<Dim>::Patch& work,
             std::vector<Node<Dim>>& nodes) const {
    const std::size_t at = nodes.size();
    nodes.emplace_back();
    const Point<Dim> center = box.center();
    Points<Dim> x(Dim, 2 * probes_each<Dim>);  // of the cell, then of its support
    x << probes(box), probes(support_of(box));
    const Index middle = probes_each<Dim> / 2;
    Eigen::VectorXd distance(x.cols());
    for (Index k = 0; k < x.cols(); ++k)
      distance[k] = patches_.nearest(x.col(k), patches_.gap() * work.radius, work.search);
    const double spacing = std::max(patches_.spacing_at(center, work), 1e-300);
    const Eigen::VectorXd fine = patches_.error(center, distance[middle], spacing, work);
    nodes[at].variance = fine;
    if (distance.maxCoeff() <= patches_.gap() / patches_.spacing() * spacing) return;
    const KrigingPatch<Dim> patch = kriging.patch(center);
    const Eigen::VectorXd scale = patch.variance(center);
    LocalModels<Dim> model = kriging.models(1);
    patch.store(model, 0);
    Index wide = 0, wide_inside = 0;
    double sum = 0;                                              // of the differences of expected errors in the cell
    Eigen::VectorXd mean = Eigen::VectorXd::Zero(scale.size());  // variance of kriging in the cell, by Simpson's rule
    for (Index k = 0; k < x.cols(); ++k) {
      const Eigen::VectorXd other = k == middle ? scale : patch.variance(x.col(k));
      Eigen::VectorXd own = k == middle ? fine : patches_.error(x.col(k), distance[k], spacing, work);
      if (distance[k] > patches_.gap() / patches_.spacing() * spacing) {
        const Eigen::VectorXd difference = value(fit_.data->models, work.cell, x.col(k)) - value(model, 0, x.col(k));
        own = own.cwiseMax(difference.cwiseAbs2() - other);
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
    if (wide == 0) return;
    const double half = 0.5 * box.diagonal();
    const bool is_fine_enough =
        half <= std::max(finest * spacing, finest_of_patch * patches_.spacing() * work.radius) || depth >= deepest;
    if (is_fine_enough || (wide_inside == probes_each<Dim> && half <= shrink * distance[middle])) {
      if (!(sum > 0)) return;
      nodes[at].variance = mean;
      nodes[at].wide = std::make_unique<const LocalModels<Dim>>(std::move(model));
      return;
    }
    Index axis = 0;
    box.extent().maxCoeff(&axis);
    nodes[at].axis = static_cast<std::int8_t>(axis);
    nodes[at].split = center[axis];
    Box<Dim> lower = box, upper = box;
    lower.hi[axis] = upper.lo[axis] = center[axis];
    split(kriging, lower, depth + 1, work, nodes);
    nodes[at].right = nodes.size();
    split(kriging, upper, depth + 1, work, nodes);
  }

  // The tree with the parts in place of their cells.
  std::optional<FilledGaps<Dim>> assemble(const LocalKriging<Dim>& kriging,
                                          const std::vector<std::vector<Node<Dim>>>& parts) const {
    const typename Cover<Dim>::Tree& old = cover_.tree();
    typename Cover<Dim>::Tree tree;
    tree.box = old.box;
    tree.growth = old.growth;
    std::vector<std::pair<Index, const Node<Dim>*>> leaves;  // the cell that each is a part of
    std::vector<std::uint32_t> place(old.axis.size());       // of the old nodes
    Index wide = 0;
    for (std::size_t i = 0; i < old.axis.size(); ++i) {
      place[i] = static_cast<std::uint32_t>(tree.axis.size());
      if (old.axis[i] >= 0) {
        tree.axis.push_back(old.axis[i]);
        tree.split.push_back(old.split[i]);
        tree.right.push_back(old.right[i]);
        continue;
      }
      const std::size_t first = tree.axis.size();
      for (const Node<Dim>& node : parts[old.right[i]]) {
        tree.axis.push_back(node.axis);
        tree.split.push_back(node.split);
        tree.right.push_back(static_cast<std::uint32_t>(node.axis >= 0 ? first + node.right : leaves.size()));
        if (node.axis >= 0) continue;
        leaves.emplace_back(old.right[i], &node);
        wide += node.wide ? 1 : 0;
      }
    }
    if (wide == 0) return std::nullopt;
    for (std::size_t i = 0; i < old.axis.size(); ++i)
      if (old.axis[i] >= 0) tree.right[place[i]] = place[old.right[i]];
    return with_cells(kriging, std::move(tree), leaves, wide);
  }

  FilledGaps<Dim> with_cells(const LocalKriging<Dim>& kriging, typename Cover<Dim>::Tree tree,
                             const std::vector<std::pair<Index, const Node<Dim>*>>& leaves, Index wide) const {
    using Data = PartitionOfUnityData<Dim>;
    auto data = std::make_shared<Data>(Data{Cover<Dim>(tree), {}});
    auto variance = std::make_shared<Data>(Data{Cover<Dim>(std::move(tree)), {}});
    const LocalModels<Dim>& old = fit_.data->models;
    LocalModels<Dim>&models = data->models, &constants = variance->models;
    const auto count = std::ssize(leaves);
    models.degree = old.degree;
    models.kernel = old.kernel;
    models.support = old.support;
    models.centers_each = old.centers_each;
    models.components = constants.components = old.components;
    models.anisotropic = old.anisotropic;
    models.resize(count);
    constants.resize(count);
    data->wide = kriging.models(wide);
    data->wide_of.assign(leaves.size(), -1);
    std::int32_t next = 0;
    for (Index i = 0; i < count; ++i) {
      const auto& [cell, node] = leaves[static_cast<std::size_t>(i)];
      copy_model(old, cell, models, i);
      const Box<Dim>& box = data->cover.cell(i);
      constants.center.col(i) = box.center();
      constants.radius[i] = 0.5 * box.diagonal();
      std::copy(node->variance.begin(), node->variance.end(), constants.polynomial.begin() + i * node->variance.size());
      if (!node->wide) continue;
      copy_model(*node->wide, 0, data->wide, next);
      data->wide_of[static_cast<std::size_t>(i)] = next++;
    }
    FilledGaps<Dim> result;
    result.fit = {data, fit_.report};
    result.fit.report.patches = count;
    result.patches = wide;
    result.variances = PartitionOfUnityFit<Dim>{variance, {}}.fields();
    return result;
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
  const Cover<Dim>& cover_;
  PatchErrors<Dim> patches_;
};

}  // namespace

template <int Dim>
FilledGaps<Dim> fill_gaps(const Samples<Dim>& samples, PartitionOfUnityFit<Dim> fit,
                          std::vector<std::shared_ptr<const Field<Dim>>> variances) {
  if constexpr (Dim <= 3) {
    const Samples<Dim> normalized = normalize_weights(samples);
    const GapFiller<Dim> filler(normalized, fit, variances);
    const std::vector<Index> cells = filler.cells_with_gaps();
    std::optional<FilledGaps<Dim>> filled;
    if (!cells.empty()) filled = filler.fill(cells);
    if (filled) return std::move(*filled);
  }
  return {std::move(fit), std::move(variances), 0};
}

template <int Dim>
std::shared_ptr<const Field<Dim>> outside_gaps(const PartitionOfUnityData<Dim>& filled) {
  using Data = PartitionOfUnityData<Dim>;
  if (filled.wide_of.empty()) return nullptr;
  auto data = std::make_shared<Data>(Data{Cover<Dim>(filled.cover.tree()), {}});
  LocalModels<Dim>& models = data->models;  // a constant per cell
  models.components = 1;
  models.resize(data->cover.size());
  for (Index i = 0; i < models.size(); ++i) {
    const Box<Dim>& box = data->cover.cell(i);
    models.center.col(i) = box.center();
    models.radius[i] = 0.5 * box.diagonal();
    models.polynomial[static_cast<std::size_t>(i)] = filled.is_wide(i) ? 0 : 1;
  }
  return std::make_shared<const PartitionOfUnity<Dim>>(data);
}

#define CSRBF_INSTANTIATE(Dim)                                                                    \
  template std::shared_ptr<const Field<Dim>> outside_gaps<Dim>(const PartitionOfUnityData<Dim>&); \
  template FilledGaps<Dim> fill_gaps<Dim>(const Samples<Dim>&, PartitionOfUnityFit<Dim>,          \
                                          std::vector<std::shared_ptr<const Field<Dim>>>);
CSRBF_FOR_EACH_DIM(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
