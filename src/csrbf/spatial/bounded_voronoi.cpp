#include "csrbf/spatial/bounded_voronoi.hpp"

#include "csrbf/core/parallel.hpp"
#include "csrbf/spatial/kd_tree.hpp"

#include <utility>

namespace csrbf {
namespace {

// A convex polytope around the origin, clipped by half-spaces. It is simple: every corner lies on exactly Dim facets,
// and corners that share Dim - 1 of them are joined by an edge. Corners within rounding of a cut are kept, coincident
// ones alike, so that even where more than Dim facets meet the combinatorics are those of a polytope with slightly
// moved facets.
template <int Dim>
class Cell {
 public:
  // The box, relative to the centre.
  void start(const Point<Dim>& lo, const Point<Dim>& hi) {
    corners_.clear();
    for (int corner = 0; corner < (1 << Dim); ++corner) {
      Corner c;
      for (int axis = 0; axis < Dim; ++axis) {
        const int upper = (corner >> axis) & 1;
        c.position[axis] = upper != 0 ? hi[axis] : lo[axis];
        c.facets[axis] = 2 * axis + upper;
      }
      corners_.push_back(c);
    }
    facets_ = 2 * Dim;
  }

  // Keeps the points nearer to the origin than to `neighbour`.
  void cut(const Point<Dim>& neighbour) {
    const double distance = neighbour.norm();
    const Point<Dim> direction = neighbour / distance;
    constexpr double rounding = 1e-13;  // of heights, relative to the distance: some hundred roundings
    outside_.clear();
    inside_.clear();
    for (const Corner& corner : corners_) {
      const double height = corner.position.dot(direction) - 0.5 * distance;
      (height > rounding * distance ? outside_ : inside_).emplace_back(corner, height);
    }
    if (outside_.empty()) return;
    corners_.clear();
    for (const auto& [corner, height] : inside_) corners_.push_back(corner);
    for (const auto& [out, above] : outside_)
      for (const auto& [in, below] : inside_) add_corner(out, above, in, std::min(below, 0.0));
    ++facets_;
  }

  [[nodiscard]] double radius() const {
    double squared = 0;
    for (const Corner& corner : corners_) squared = std::max(squared, corner.position.squaredNorm());
    return std::sqrt(squared);
  }

 private:
  struct Corner {
    Point<Dim> position;
    std::array<int, Dim> facets;  // ascending
  };

  // Where the edge between two corners, if there is one, meets the new facet.
  void add_corner(const Corner& out, double above, const Corner& in, double below) {
    Corner corner;
    std::size_t shared = 0;
    for (std::size_t i = 0, j = 0; i < Dim && j < Dim;) {
      if (out.facets[i] == in.facets[j]) {
        if (shared == Dim - 1) return;
        corner.facets[shared++] = out.facets[i];
        ++i;
        ++j;
      } else {
        ++(out.facets[i] < in.facets[j] ? i : j);
      }
    }
    if (shared != Dim - 1) return;
    corner.facets[Dim - 1] = facets_;
    corner.position = in.position + below / (below - above) * (out.position - in.position);
    corners_.push_back(corner);
  }

  std::vector<Corner> corners_;
  std::vector<std::pair<Corner, double>> inside_, outside_;
  int facets_ = 0;
};

// The neighbours of a centre, nearest first, fetched as they are needed.
template <int Dim>
class Neighbours {
 public:
  explicit Neighbours(const KdTree<Dim>& tree) : tree_(tree) {}

  void start(const Point<Dim>& center) {
    center_ = center;
    constexpr Index first_guess = 4 << Dim;  // chosen by hand, doubled as needed
    fetch(std::min<Index>(first_guess, tree_.size()));
  }
  // The i-th nearest; false when there are no more.
  bool get(Index i, Index& index, double& squared_distance) {
    if (i >= tree_.size()) return false;
    if (i >= found_) fetch(std::min(2 * found_, tree_.size()));
    index = indices_[i];
    squared_distance = squared_distances_[i];
    return true;
  }

 private:
  void fetch(Index k) {
    indices_.resize(k);
    squared_distances_.resize(k);
    found_ = tree_.nearest(center_, k, indices_.data(), squared_distances_.data());
  }

  const KdTree<Dim>& tree_;
  Point<Dim> center_ = Point<Dim>::Zero();
  Index found_ = 0;
  std::vector<Index> indices_;
  std::vector<double> squared_distances_;
};

}  // namespace

template <int Dim>
Eigen::VectorXd bounded_voronoi_scales(const PointsRef<Dim>& centers, const Box<Dim>& box, const Progress& progress) {
  constexpr const char* function = "bounded_voronoi_scales";
  require(centers.allFinite(), function, "centers", "NaN or infinity", "every coordinate must be finite");
  for (Index i = 0; i < centers.cols(); ++i)
    require(box.contains(centers.col(i)), function, "centers", i, "is the index of a centre outside the box");
  // In units of the box, so that squares neither overflow nor underflow.
  const double longest = box.extent().maxCoeff();
  const double unit = longest > 0 ? 1 / longest : 1;
  const Points<Dim> scaled = unit * (centers.colwise() - box.lo);
  const Point<Dim> extent = unit * box.extent();
  const KdTree<Dim> tree(scaled);
  Eigen::VectorXd scales(centers.cols());
  constexpr Index grain = 256;          // centres per task, chosen by hand
  constexpr Index slice = 256 * grain;  // centres between progress reports
  for (Index start = 0; start < centers.cols(); start += slice) {
    report(progress, "voronoi cells", static_cast<double>(start) / static_cast<double>(centers.cols()));
    parallel_for(std::min(slice, centers.cols() - start), grain, [&](Index first, Index last) {
      Cell<Dim> cell;
      Neighbours<Dim> neighbours(tree);
      for (Index i = start + first; i < start + last; ++i) {
        const Point<Dim> c = scaled.col(i);
        cell.start(-c, extent - c);
        neighbours.start(c);
        double radius = cell.radius();
        Index j = 0;
        double squared_distance = 0;
        for (Index n = 0; neighbours.get(n, j, squared_distance) && squared_distance < 4 * radius * radius; ++n) {
          if (squared_distance == 0) continue;
          cell.cut(scaled.col(j) - c);
          radius = cell.radius();
        }
        scales[i] = radius / unit;
      }
    });
  }
  return scales;
}

template <int Dim>
Eigen::VectorXd discrete_voronoi_scales(const PointsRef<Dim>& centers, const PointsRef<Dim>& points) {
  constexpr const char* function = "discrete_voronoi_scales";
  require(centers.allFinite() && points.allFinite(), function, "points", "NaN or infinity",
          "every coordinate must be finite");
  require(centers.cols() > 0 || points.cols() == 0, function, "centers", "none", "at least one centre is needed");
  Eigen::VectorXd scales = Eigen::VectorXd::Zero(centers.cols());
  if (centers.cols() == 0) return scales;
  const KdTree<Dim> tree(centers);
  std::vector<Index> nearest(points.cols());
  std::vector<double> squared(nearest.size());
  parallel_for(points.cols(), 1024, [&](Index first, Index last) {
    for (Index i = first; i < last; ++i) tree.nearest(points.col(i), 1, &nearest[i], &squared[i]);
  });
  for (std::size_t i = 0; i < nearest.size(); ++i) scales[nearest[i]] = std::max(scales[nearest[i]], squared[i]);
  return scales.cwiseSqrt();
}

#define CSRBF_INSTANTIATE(Dim)                                                                                   \
  template Eigen::VectorXd bounded_voronoi_scales<Dim>(const PointsRef<Dim>&, const Box<Dim>&, const Progress&); \
  template Eigen::VectorXd discrete_voronoi_scales<Dim>(const PointsRef<Dim>&, const PointsRef<Dim>&);
CSRBF_FOR_EACH_DIM(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
