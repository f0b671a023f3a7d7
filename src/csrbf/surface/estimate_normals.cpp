#include "csrbf/surface/estimate_normals.hpp"

#include "csrbf/core/percentile.hpp"
#include "csrbf/core/shared_work.hpp"
#include "csrbf/spatial/kd_tree.hpp"
#include "csrbf/spatial/morton_order.hpp"
#include "csrbf/surface/normals/local_normal.hpp"
#include "csrbf/surface/normals/neighbor_table.hpp"

#include <Eigen/Eigenvalues>

namespace csrbf {
namespace {

constexpr std::string_view stage = "estimate normals", where = "estimate_normals";
// Chosen by hand.
constexpr Index choices[] = {16, 24, 32, 48, 64, 96, 128, 192, 256, 384, 512};  // numbers of neighbours tried
constexpr Index sampled_points = 300;  // that the choice is made with; more: slower, less random
constexpr double stop_ratio = 1.15;    // a criterion this much larger than the least ends the search
constexpr double flat = 0.4;           // largest thickness, (l0 / l1)^(1/2), of a neighbourhood that shows a surface
constexpr double thinnest = 0.01;      // floor of the thickness: less is rounding
constexpr Index shared_from = 33;      // neighbourhoods of at least this many points are shared ...
constexpr Index share = 16;            // ... by up to a sixteenth of their points
constexpr Index max_neighbors = 256;   // at which doubling for neighbours on a line ends
constexpr Index graph_neighbors = 12;  // of orient_normals(), its default
constexpr double line = 1e-14;         // of the largest variance: the cloud lies on a line

// The different points in unit coordinates and Morton order.
struct Cloud {
  Points<3> points;
  std::vector<Index> unique_of;  // of each input point
};

Cloud sort_unique(const PointsRef<3>& input) {
  const Box<3> box = bounding_box<3>(input);
  const Point<3> center = 0.5 * box.lo + 0.5 * box.hi;
  const double size = (0.5 * box.hi - 0.5 * box.lo).maxCoeff(), scale = size > 0 ? size : 1;
  const std::vector<Index> order = morton_order<3>(input);
  Cloud cloud{Points<3>(3, input.cols()), std::vector<Index>(order.size())};
  Index count = 0;
  for (const Index i : order) {
    const Point<3> p = (input.col(i) - center) / scale;
    if (count == 0 || p != cloud.points.col(count - 1)) cloud.points.col(count++) = p;
    cloud.unique_of[i] = count - 1;
  }
  cloud.points.conservativeResize(3, count);
  return cloud;
}

void check(const PointsRef<3>& points, const NormalOptions& options) {
  require(options.neighbors == 0 || options.neighbors >= 3, where, "neighbors", options.neighbors,
          "must be 0 (automatic) or at least 3");
  require(points.allFinite(), where, "points", "NaN or infinity", "must be finite; remove such points");
  require(points.cols() < (Index{1} << 31), where, "points.cols()", points.cols(), "must be below 2^31");
  if (options.orient == Orient::viewpoint)
    require(options.viewpoint.allFinite(), where, "viewpoint", options.viewpoint.transpose(), "must be finite");
}

void check_spread(const Points<3>& points) {
  require(points.cols() >= 3, where, "number of different points", points.cols(),
          "a surface needs points in 3 dimensions, at least 3 of them");
  const Points<3> centered = points.colwise() - points.rowwise().mean();
  const Eigen::Matrix3d covariance = centered * centered.transpose();
  const Eigen::Vector3d variance = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(covariance).eigenvalues();
  require(variance[1] > line * variance[2], where, "points", "all on one line",
          "a surface needs points that spread in at least two directions");
}

// Nearest points of a location; the spans of a query are valid until the next.
class Neighborhood {
 public:
  Neighborhood(const Points<3>& points, const KdTree<3>& tree) : points_(points), tree_(tree) {}

  void query(const Point<3>& center, Index count) {
    count = std::min(count, points_.cols());
    ids_.resize(std::max(std::ssize(ids_), count));
    d2_.resize(ids_.size());
    count_ = static_cast<std::size_t>(tree_.nearest(center, count, ids_.data(), d2_.data()));
    frame_ = local_frame(points_, ids(), d2(), center);
  }
  // Doubles the number of neighbours until they do not lie on a line.
  void query_surface(const Point<3>& center, Index count) {
    query(center, count);
    while (!frame_.is_surface() && static_cast<Index>(count_) < std::min(max_neighbors, points_.cols()))
      query(center, count *= 2);
  }
  [[nodiscard]] std::span<const Index> ids() const { return {ids_.data(), count_}; }
  [[nodiscard]] std::span<const double> d2() const { return {d2_.data(), count_}; }
  [[nodiscard]] const LocalFrame& frame() const { return frame_; }
  [[nodiscard]] LocalQuadric quadric() const { return fit_quadric(points_, ids(), d2(), frame_); }

 private:
  const Points<3>& points_;
  const KdTree<3>& tree_;
  std::vector<Index> ids_;
  std::vector<double> d2_;
  std::size_t count_ = 0;
  LocalFrame frame_;
};

// Median of (l0 / l1)^(1/2) over a sample of the points.
double thickness(const Points<3>& points, const KdTree<3>& tree, Index neighbors) {
  const Index count = std::min(sampled_points, points.cols());
  std::vector<double> ratio(count);
  const auto compute = [&](Index begin, Index end) {
    Neighborhood near(points, tree);
    for (Index s = begin; s < end; ++s) {
      near.query(points.col((2 * s + 1) * points.cols() / (2 * count)), neighbors);
      const Eigen::Vector3d& l = near.frame().eigenvalues;
      ratio[s] = l[1] > 0 ? std::sqrt(std::max(0.0, l[0]) / l[1]) : 1.0;
    }
  };
  share_arrays(stage, count, 32, compute, {ResultArray::of(ratio.data())});
  return median(ratio);
}

Index choose_neighbors(const Points<3>& points, const KdTree<3>& tree) {
  Index best = choices[0];
  double least = std::numeric_limits<double>::infinity();
  for (const Index choice : choices) {
    if (choice > choices[0] && 16 * choice > points.cols()) break;
    const double thick = std::max(thinnest, thickness(points, tree, choice));
    const double criterion = thick * std::cbrt(static_cast<double>(choice));
    if (std::isinf(least) && thick >= flat) {
      best = choice;
    } else if (criterion < least) {
      least = criterion;
      best = choice;
    } else if (criterion > stop_ratio * least) {
      break;
    }
  }
  return best;
}

// Normals, and a neighbour table where it comes as a by-product.
struct Fit {
  Points<3> normals;
  NeighborTable table;
};

// One quadric for the points [begin, end) if they lie within half the radius of their neighbourhood; else for each half
// of them.
void fit_range(const Points<3>& points, Index begin, Index end, Index neighbors, Neighborhood& near, Fit& fit) {
  const Index count = end - begin;
  const Point<3> center =
      count > 1 ? Point<3>(points.middleCols(begin, count).rowwise().mean()) : Point<3>(points.col(begin));
  near.query_surface(center, neighbors);
  if (count == 1 && fit.table.k > 0) fit.table.set(begin, near.ids(), near.d2().data());
  if (count > 1) {
    const double radius2 = (points.middleCols(begin, count).colwise() - center).colwise().squaredNorm().maxCoeff();
    if (!(radius2 < 0.25 * near.d2().back())) {
      const Index middle = begin + count / 2;
      fit_range(points, begin, middle, neighbors, near, fit);
      fit_range(points, middle, end, neighbors, near, fit);
      return;
    }
  }
  if (near.frame().is_line()) {
    fit.normals.middleCols(begin, count).setZero();
    return;
  }
  const LocalQuadric quadric = near.quadric();
  for (Index i = begin; i < end; ++i) fit.normals.col(i) = quadric.normal(points.col(i));
}

// The table gets `graph` neighbours per point, or stays empty if the fits do not provide them.
Fit fit_all(const Points<3>& points, const KdTree<3>& tree, Index neighbors, Index graph, const Progress& progress) {
  const Index n = points.cols(), per_fit = neighbors >= shared_from ? neighbors / share : 1;
  Fit fit{Points<3>(3, n), {}};
  graph = std::min(graph, n - 1);
  if (per_fit == 1 && neighbors > graph) {
    fit.table.k = graph;
    fit.table.index.resize(n * graph);
    fit.table.reach.resize(n);
  }
  const Index slice = std::max<Index>(n / 16, 1 << 16) / per_fit * per_fit;
  for (Index first = 0; first < n; first += slice) {
    report(progress, stage, 0.1 + 0.5 * static_cast<double>(first) / static_cast<double>(n));
    const Index last = std::min(n, first + slice), grain = std::max<Index>(1, 512 / per_fit) * per_fit;
    const auto compute = [&](Index begin, Index end) {
      Neighborhood near(points, tree);
      for (Index i = first + begin; i < first + end; i += per_fit)
        fit_range(points, i, std::min(first + end, i + per_fit), neighbors, near, fit);
    };
    share_arrays(stage, last - first, grain, compute,
                 {ResultArray::of(fit.normals.col(first).data(), 3),
                  ResultArray::of(fit.table.index.data() + first * fit.table.k, fit.table.k),
                  ResultArray::of(fit.table.reach.data() + (fit.table.k > 0 ? first : 0), fit.table.k > 0 ? 1 : 0)});
  }
  return fit;
}

}  // namespace

Points<3> estimate_normals(const PointsRef<3>& points, const NormalOptions& options, NormalReport* details) {
  check(points, options);
  report(options.progress, stage, 0);
  const Cloud cloud = sort_unique(points);
  check_spread(cloud.points);
  const KdTree<3> tree(cloud.points);
  NormalReport result;
  result.duplicates = points.cols() - cloud.points.cols();
  result.neighbors = options.neighbors > 0 ? options.neighbors : choose_neighbors(cloud.points, tree);
  const bool consistent = options.orient == Orient::consistent;
  Fit fit = fit_all(cloud.points, tree, result.neighbors, consistent ? graph_neighbors : 0, options.progress);
  Points<3>& normals = fit.normals;
  if (consistent) {
    if (fit.table.k == 0) fit.table = make_neighbor_table(cloud.points, tree, graph_neighbors);
    result.orientation = orient_normals(cloud.points, fit.table, normals, [&](std::string_view, double fraction) {
      return !options.progress || options.progress(stage, 0.7 + 0.3 * fraction);
    });
  }
  Points<3> output(3, points.cols());
  for (Index i = 0; i < points.cols(); ++i) {
    output.col(i) = normals.col(cloud.unique_of[i]);
    if (options.orient == Orient::viewpoint && output.col(i).dot(options.viewpoint - points.col(i)) < 0)
      output.col(i) = -output.col(i).eval();
    result.undetermined += output.col(i).squaredNorm() > 0 ? 0 : 1;
  }
  report(options.progress, stage, 1);
  if (details != nullptr) *details = result;
  return output;
}

}  // namespace csrbf
