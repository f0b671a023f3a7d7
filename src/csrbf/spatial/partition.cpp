#include "csrbf/spatial/partition.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/core/parallel.hpp"
#include "csrbf/core/small_matrices.hpp"

#include <numeric>
#include <utility>

namespace csrbf {
namespace {

// All chosen by hand.
constexpr double flat = 0.8;         // length of the mean unit normal above which points are a nearly flat sheet
constexpr Index axes_sample = 512;   // points that the principal axes of a larger set are estimated from
constexpr Index enough_parts = 256;  // for the threads: more balance better, fewer need fewer passes

using Projected = std::pair<double, Index>;

template <int Dim>
Point<Dim> mean_of(const PointsRef<Dim>& columns, const Index* ids, Index n) {
  Point<Dim> mean = Point<Dim>::Zero();
  for (Index i = 0; i < n; ++i) mean += columns.col(ids[i]);
  return mean / static_cast<double>(n);
}

// Principal axes of the columns `ids` of `columns`, largest spread last; false when they all coincide. Spread along
// `normal` is ignored.
template <int Dim>
bool principal_axes(const PointsRef<Dim>& columns, const Index* ids, Index n, Eigen::Matrix<double, Dim, Dim>& axes,
                    const Point<Dim>& normal = Point<Dim>::Zero()) {
  const Point<Dim> mean = mean_of<Dim>(columns, ids, n);
  Eigen::Matrix<double, Dim, Dim> covariance = Eigen::Matrix<double, Dim, Dim>::Zero();
  for (Index i = 0; i < n; ++i) {
    Point<Dim> d = columns.col(ids[i]) - mean;
    d -= d.dot(normal) * normal;
    covariance += d * d.transpose();
  }
  const double scale = covariance.trace();
  if (!(scale > 0)) return false;
  covariance /= scale;
  axes = symmetric_eigen_direct(covariance).vectors;
  return true;
}

template <int Dim>
std::vector<Projected> project(const PointsRef<Dim>& columns, const Index* ids, Index n, const Point<Dim>& axis) {
  std::vector<Projected> keyed(n);
  for (Index i = 0; i < n; ++i) keyed[i] = {axis.dot(columns.col(ids[i])), ids[i]};
  return keyed;
}

void store(const std::vector<Projected>& keyed, Index* ids) {
  for (std::size_t i = 0; i < keyed.size(); ++i) ids[i] = keyed[i].second;
}

// The sign of an eigenvector is arbitrary: orients the axis by the skewness of the points, so that cuts rotate with the
// cloud.
void orient(std::vector<Projected>& keyed) {
  double mean = 0, third_moment = 0;
  for (const Projected& k : keyed) mean += k.first / static_cast<double>(keyed.size());
  for (const Projected& k : keyed) third_moment += (k.first - mean) * (k.first - mean) * (k.first - mean);
  if (third_moment < 0)
    for (Projected& k : keyed) k.first = -k.first;
}

// Moves the `cut` points lowest along the principal axis to the front. For a nearly flat sheet the axis lies in the
// sheet, which noise may make thicker than it is wide. Both parts keep their order: that of std::nth_element differs
// between standard libraries, and the axes of large parts are those of a sample.
template <int Dim>
void split_at(const PointsRef<Dim>& points, const PointsRef<Dim>& normals, Index* ids, Index n, Index cut) {
  std::array<Index, axes_sample> sample;
  const Index count = std::min(n, axes_sample);
  for (Index i = 0; i < count; ++i) sample[i] = ids[i * n / count];
  Point<Dim> normal = Point<Dim>::Zero();
  if (normals.cols() > 0) normal = mean_of<Dim>(normals, sample.data(), count);
  normal = normal.norm() > flat ? Point<Dim>(normal.normalized()) : Point<Dim>(Point<Dim>::Zero());
  Eigen::Matrix<double, Dim, Dim> axes;
  if (!principal_axes<Dim>(points, sample.data(), count, axes, normal) &&
      !principal_axes<Dim>(points, ids, n, axes, normal))
    return;
  std::vector<Projected> keyed = project<Dim>(points, ids, n, axes.col(Dim - 1));
  orient(keyed);
  std::vector<Projected> partitioned = keyed;
  std::nth_element(partitioned.begin(), partitioned.begin() + cut, partitioned.end());
  const Projected first_above = partitioned[cut];
  Index* low = ids;
  Index* high = ids + cut;
  for (const Projected& k : keyed) *(k < first_above ? low++ : high++) = k.second;
}

template <int Dim>
class Splitter {
 public:
  using Matrix = Eigen::Matrix<double, Dim, Dim>;

  Splitter(const PointsRef<Dim>& points, const PointsRef<Dim>& normals,
           const Eigen::Ref<const Eigen::VectorXd>& spacing, const PointPartitionOptions& options)
      : points_(points), normals_(normals), spacing_(spacing), options_(options) {}

  // Cuts [begin, end) of `order` in two and returns where, or `end` when it is a leaf.
  // Whether a part of n points is only cut where it bridges two sheets.
  [[nodiscard]] bool bridges(Index n) const { return n <= options_.leaf_size; }
  Index split(std::vector<Index>& order, Index begin, Index end) const {
    const Index n = end - begin;
    if (n <= 1) return end;
    Index* ids = order.data() + begin;
    if (n > options_.leaf_size) return begin + split_evenly(ids, n);
    Index cut = cut_by_normals(ids, n);
    if (cut == n) cut = cut_at_gap(ids, n);
    return begin + cut;
  }

 private:
  // Halves the number of leaves, so that all leaves end up with nearly the same number of points.
  Index split_evenly(Index* ids, Index n) const {
    const Index leaves = (n + options_.leaf_size - 1) / options_.leaf_size;
    const Index cut = n * (leaves / 2) / leaves;
    split_at<Dim>(points_, normals_, ids, n, cut);
    return cut;
  }

  Index cut_by_normals(Index* ids, Index n) const {
    if (normals_.cols() == 0) return n;
    if (mean_of<Dim>(normals_, ids, n).norm() >= options_.min_mean_normal) return n;
    Matrix axes;
    if (!principal_axes<Dim>(normals_, ids, n, axes)) return n;
    return cut_widest(project<Dim>(normals_, ids, n, axes.col(Dim - 1)), ids, 0.0);
  }

  Index cut_at_gap(Index* ids, Index n) const {
    if (spacing_.size() == 0) return n;
    double spacing = 0;
    for (Index i = 0; i < n; ++i) spacing += spacing_[ids[i]];
    spacing /= static_cast<double>(n);
    if (normals_.cols() > 0) {
      // The principal axes of a small leaf need not be those of the sheets.
      const Index cut = cut_widest(project<Dim>(points_, ids, n, mean_of<Dim>(normals_, ids, n).normalized()), ids,
                                   options_.max_gap * spacing);
      if (cut < n) return cut;
    }
    Matrix axes;
    if (!principal_axes<Dim>(points_, ids, n, axes)) return n;
    for (int a = Dim - 1; a >= 0; --a) {
      const Index cut = cut_widest(project<Dim>(points_, ids, n, axes.col(a)), ids, options_.max_gap * spacing);
      if (cut < n) return cut;
    }
    return n;
  }

  // Cuts at the widest gap between consecutive keys if it is wider than `least`.
  static Index cut_widest(std::vector<Projected> keyed, Index* ids, double least) {
    std::sort(keyed.begin(), keyed.end());
    const Index n = std::ssize(keyed);
    Index cut = n;
    double widest = least;
    for (Index i = 1; i < n; ++i) {
      const double gap = keyed[i].first - keyed[i - 1].first;
      if (gap > widest) {
        widest = gap;
        cut = i;
      }
    }
    if (cut < n) store(keyed, ids);
    return cut;
  }

  const PointsRef<Dim>& points_;
  const PointsRef<Dim>& normals_;
  const Eigen::Ref<const Eigen::VectorXd>& spacing_;
  const PointPartitionOptions& options_;
};

// A range of the order: a leaf, or to be cut further.
struct Part {
  Index begin = 0, end = 0;
  bool leaf = false;
  int cuts = 0;   // of parts that it is in
  int depth = 0;  // of the cut where it begins, see PointPartition
};

// Cuts a part into at most 2^levels, depth first, so that what is cut next is still in the cache.
template <int Dim>
std::vector<Part> cut(const Splitter<Dim>& splitter, const Part& whole, int levels, std::vector<Index>& order) {
  std::vector<Part> parts;
  std::vector<std::pair<Part, int>> stack = {{whole, levels}};
  while (!stack.empty()) {
    auto [part, left] = stack.back();
    stack.pop_back();
    const Index middle = part.leaf || left == 0 ? part.end : splitter.split(order, part.begin, part.end);
    if (part.begin < middle && middle < part.end) {
      const int cuts = part.cuts + 1;
      const int depth = splitter.bridges(part.end - part.begin) ? -1 : cuts;
      stack.push_back({{middle, part.end, false, cuts, depth}, left - 1});
      stack.push_back({{part.begin, middle, false, cuts, part.depth}, left - 1});
    } else {
      part.leaf = part.leaf || left > 0;
      parts.push_back(part);
    }
  }
  return parts;
}

// Cuts all parts, independently of each other: once, until there are enough of them for all threads, then down to the
// leaves.
template <int Dim>
std::vector<Part> cut_all(const Splitter<Dim>& splitter, const std::vector<Part>& parts, std::vector<Index>& order) {
  const auto count = std::ssize(parts);
  const int levels = count < enough_parts ? 1 : std::numeric_limits<int>::max();
  std::vector<std::vector<Part>> smaller(parts.size());
  const auto compute = [&](Index begin, Index end) {
    for (Index i = begin; i < end; ++i) smaller[i] = cut(splitter, parts[i], levels, order);
  };
  const Index grain = 1 + count / enough_parts;
  parallel_for(count, grain, compute);
  std::vector<Part> result;
  for (const std::vector<Part>& some : smaller) result.insert(result.end(), some.begin(), some.end());
  return result;
}

}  // namespace

template <int Dim>
PointPartition partition(const PointsRef<Dim>& points, const PointsRef<Dim>& normals,
                         const Eigen::Ref<const Eigen::VectorXd>& spacing, const PointPartitionOptions& options) {
  require(options.leaf_size >= 1, "partition", "leaf_size", options.leaf_size, "must be at least 1");
  const Index n = points.cols();
  require(std::int64_t{n} < (std::int64_t{1} << 32), "partition", "points", n, "must be fewer than 2^32");
  require(normals.cols() == 0 || normals.cols() == n, "partition", "normals", normals.cols(), "one per point or none");
  require(spacing.size() == 0 || spacing.size() == n, "partition", "spacing", spacing.size(), "one per point or none");
  PointPartition result;
  result.order.resize(n);
  std::iota(result.order.begin(), result.order.end(), Index{0});
  result.begin = {0};
  if (n == 0) return result;
  const Splitter<Dim> splitter(points, normals, spacing, options);
  std::vector<Part> parts = {{0, n}};
  while (std::any_of(parts.begin(), parts.end(), [](const Part& part) { return !part.leaf; }))
    parts = cut_all(splitter, parts, result.order);
  for (const Part& part : parts) {
    result.begin.push_back(part.end);
    result.depth.push_back(part.depth);
  }
  return result;
}

template <int Dim>
Index halve(const PointsRef<Dim>& points, const PointsRef<Dim>& normals, Index* ids, Index n) {
  split_at<Dim>(points, normals, ids, n, n / 2);
  return n / 2;
}

#define CSRBF_INSTANTIATE(Dim)                                                            \
  template Index halve<Dim>(const PointsRef<Dim>&, const PointsRef<Dim>&, Index*, Index); \
  template PointPartition partition<Dim>(const PointsRef<Dim>&, const PointsRef<Dim>&,    \
                                         const Eigen::Ref<const Eigen::VectorXd>&, const PointPartitionOptions&);
CSRBF_FOR_EACH_DIM(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
