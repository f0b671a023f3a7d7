#include "csrbf/surface/normals/tangent_areas.hpp"

#include "csrbf/core/parallel.hpp"
#include "csrbf/spatial/kd_tree.hpp"

#include <Eigen/Geometry>

namespace csrbf {
namespace {

using Corner = Eigen::Vector2d;

// A convex polygon about the origin.
class Cell {
 public:
  void start(double reach) { corners_ = {{-reach, -reach}, {reach, -reach}, {reach, reach}, {-reach, reach}}; }

  // Keeps the part where direction . x <= limit; limit > 0.
  void cut(const Corner& direction, double limit) {
    kept_.clear();
    for (std::size_t i = 0; i < corners_.size(); ++i) {
      const Corner &a = corners_[i], &b = corners_[(i + 1) % corners_.size()];
      const double over_a = direction.dot(a) - limit, over_b = direction.dot(b) - limit;
      if (over_a <= 0) kept_.push_back(a);
      if ((over_a < 0 && over_b > 0) || (over_a > 0 && over_b < 0))
        kept_.push_back(a + over_a / (over_a - over_b) * (b - a));
    }
    corners_.swap(kept_);
  }

  [[nodiscard]] double squared_radius() const {
    double squared = 0;
    for (const Corner& c : corners_) squared = std::max(squared, c.squaredNorm());
    return squared;
  }

  [[nodiscard]] double area() const {
    double twice = 0;
    for (std::size_t i = 0; i < corners_.size(); ++i) {
      const Corner &a = corners_[i], &b = corners_[(i + 1) % corners_.size()];
      twice += a[0] * b[1] - a[1] * b[0];
    }
    return 0.5 * twice;
  }

 private:
  std::vector<Corner> corners_, kept_;
};

// The neighbours of a point by distance, fetched on demand.
class Neighbors {
 public:
  Neighbors(const KdTree<3>& tree, const Point<3>& x) : tree_(tree), x_(x) { fetch(first_fetch); }

  // The n-th neighbour, itself first; false beyond the last.
  bool get(Index n, Index& j, double& squared) {
    while (n >= found_) {
      if (found_ == tree_.size()) return false;
      fetch(4 * found_);
    }
    j = ids_[n];
    squared = squared_[n];
    return true;
  }

 private:
  static constexpr Index first_fetch = 24;  // enough for most cells of evenly spread points; chosen by hand

  void fetch(Index n) {
    n = std::min(n, tree_.size());
    ids_.resize(n);
    squared_.resize(ids_.size());
    found_ = tree_.nearest(x_, n, ids_.data(), squared_.data());
  }

  const KdTree<3>& tree_;
  Point<3> x_;
  std::vector<Index> ids_;
  std::vector<double> squared_;
  Index found_ = 0;
};

}  // namespace

Eigen::VectorXd tangent_areas(const PointsRef<3>& points, const PointsRef<3>& normals, const Eigen::VectorXd& reach) {
  const KdTree<3> tree(points);
  Eigen::VectorXd areas(points.cols());
  const auto compute = [&](Index begin, Index end) {
    Cell cell;
    for (Index i = begin; i < end; ++i) {
      const Point<3> p = points.col(i), n = normals.col(i), u = n.unitOrthogonal(), v = n.cross(u);
      Neighbors neighbors(tree, p);
      cell.start(reach[i]);
      Index j = 0;
      double squared = 0;
      // A bisector cuts the cell only when its site is nearer than twice the farthest corner.
      for (Index k = 0; neighbors.get(k, j, squared) && squared < 4 * cell.squared_radius(); ++k) {
        const Point<3> d = points.col(j) - p;
        if (squared > 0) cell.cut({d.dot(u), d.dot(v)}, 0.5 * squared);
      }
      areas[i] = cell.area();
    }
  };
  parallel_for(points.cols(), 64, compute);
  return areas;
}

}  // namespace csrbf
