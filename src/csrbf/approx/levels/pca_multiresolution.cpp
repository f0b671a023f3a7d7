#include "csrbf/approx/levels/pca_multiresolution.hpp"

#include "csrbf/approx/levels/error_bounded.hpp"
#include "csrbf/approx/levels/level_builder.hpp"
#include "csrbf/approx/samples/spacing.hpp"
#include "csrbf/core/small_matrices.hpp"

#include <algorithm>
#include <numeric>

namespace csrbf {
namespace {

constexpr const char* pca_function = "pca_multiresolution";

// Clusters are ranges of a permutation of the samples.
template <int Dim>
class Clusters {
 public:
  struct Range {
    Index begin;
    Index end;
    [[nodiscard]] Index size() const { return end - begin; }
  };

  Clusters(const Points<Dim>& points, Index most) : points_(points), order_(static_cast<std::size_t>(points.cols())) {
    std::iota(order_.begin(), order_.end(), Index{0});
    leaves_ = {{0, points.cols()}};
    for (std::size_t i = 0; i < leaves_.size();) {
      if (leaves_[i].size() > most)
        split_leaf(i);
      else
        ++i;
    }
  }

  [[nodiscard]] Points<Dim> centroids(const std::vector<Range>& ranges) const {
    Points<Dim> centers(Dim, static_cast<Index>(ranges.size()));
    for (std::size_t i = 0; i < ranges.size(); ++i) centers.col(static_cast<Index>(i)) = centroid(ranges[i]);
    return centers;
  }

  [[nodiscard]] const std::vector<Range>& leaves() const { return leaves_; }

  // Splits the leaves with a sample that is `bad` and returns their parts (thesis Algorithm 1, lines 7 to 10). Leaves
  // of a single sample are returned unsplit.
  template <class Bad>
  std::vector<Range> refine(const Bad& bad) {
    std::vector<Range> active;
    const std::size_t before = leaves_.size();
    for (std::size_t i = 0; i < before; ++i) {
      const Range leaf = leaves_[i];
      if (!std::any_of(order_.begin() + leaf.begin, order_.begin() + leaf.end, bad)) continue;
      if (leaf.size() > 1) {
        split_leaf(i);
        active.push_back(leaves_.back());
      }
      active.push_back(leaves_[i]);
    }
    return active;
  }

 private:
  [[nodiscard]] Point<Dim> centroid(const Range& range) const {
    const Point<Dim> first = points_.col(order_[range.begin]);
    Point<Dim> sum = Point<Dim>::Zero();
    for (Index k = range.begin; k < range.end; ++k) sum += points_.col(order_[k]) - first;
    return first + sum / static_cast<double>(range.size());
  }

  // Across the principal axis through the centroid; by rank where rounding leaves one side empty.
  void split_leaf(std::size_t i) {
    const Range range = leaves_[i];
    const Point<Dim> c = centroid(range);
    const auto begin = order_.begin() + range.begin;
    const auto end = order_.begin() + range.end;
    double radius = 0;
    for (auto k = begin; k != end; ++k) radius = std::max(radius, (points_.col(*k) - c).cwiseAbs().maxCoeff());
    Eigen::Matrix<double, Dim, Dim> moments = Eigen::Matrix<double, Dim, Dim>::Zero();
    for (auto k = begin; k != end && radius > 0; ++k) {
      const Point<Dim> x = (points_.col(*k) - c) / radius;
      moments += x * x.transpose();
    }
    const Point<Dim> normal = symmetric_eigen(moments).vectors.col(Dim - 1);
    const auto height = [&](Index k) { return normal.dot(points_.col(k) - c); };
    auto middle = std::stable_partition(begin, end, [&](Index k) { return height(k) < 0; });
    if (middle == begin || middle == end) {
      middle = begin + range.size() / 2;
      std::nth_element(begin, middle, end,
                       [&](Index a, Index b) { return height(a) != height(b) ? height(a) < height(b) : a < b; });
    }
    const Index cut = middle - order_.begin();
    leaves_[i] = {range.begin, cut};
    leaves_.push_back({cut, range.end});
  }

  const Points<Dim>& points_;
  std::vector<Index> order_;
  std::vector<Range> leaves_;
};

void check_pca(const PcaMultiresolutionOptions& options) {
  require(options.cluster_size >= 0, pca_function, "cluster_size", options.cluster_size,
          "must not be negative; 0 chooses it");
  require(options.support > 1 && std::isfinite(options.support), pca_function, "support", options.support,
          "must be above 1, or the supports leave gaps; 2 to 4 is usual");
  require(options.max_levels >= 1, pca_function, "max_levels", options.max_levels, "must be at least 1");
}

}  // namespace

template <int Dim>
LevelFit<Dim> pca_multiresolution(const Samples<Dim>& samples, const PcaMultiresolutionOptions& options) {
  check_pca(options);
  LevelBuilder<Dim> builder(samples, pca_function, options.progress, DuplicateValue::midrange);
  const double tolerance = checked_tolerance(builder, options.tolerance, pca_function);
  const Kernel kernel(options.kernel, Dim);
  const Points<Dim>& points = builder.samples().points;
  const Index most = options.cluster_size > 0 ? options.cluster_size : std::max<Index>(1, points.cols() / 30);

  Clusters<Dim> clusters(points, most);
  Points<Dim> centers = clusters.centroids(clusters.leaves());
  double support = options.support * center_spacing<Dim>(points, centers);
  while (centers.cols() > 0 && builder.levels() < options.max_levels) {
    report(options.progress, "levels", static_cast<double>(builder.levels()) / static_cast<double>(options.max_levels));
    builder.add(kernel, centers, Eigen::VectorXd::Constant(1, support), LevelSolve::ridge, options.lambda0);
    const Index before = std::ssize(clusters.leaves());
    const auto active = clusters.refine([&](Index i) { return builder.error(i) > tolerance; });
    if (std::ssize(clusters.leaves()) == before) break;
    centers = clusters.centroids(active);
    support *= std::pow(0.5, 1.0 / Dim);
  }
  const std::vector<Index> rest = builder.violations(tolerance);
  if (!rest.empty()) builder.add_diagonal(kernel, rest);
  return builder.finish(tolerance);
}

#define CSRBF_INSTANTIATE(Dim) \
  template LevelFit<Dim> pca_multiresolution<Dim>(const Samples<Dim>&, const PcaMultiresolutionOptions&);
CSRBF_FOR_EACH_DIM(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
