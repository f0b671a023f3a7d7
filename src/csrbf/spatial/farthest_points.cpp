#include "csrbf/spatial/farthest_points.hpp"

#include "csrbf/spatial/morton_order.hpp"

namespace csrbf {
namespace {

// A candidate for the next pick; the smaller index wins ties.
struct Farthest {
  double squared_distance = -1;
  Index index = 0;

  void take(const Farthest& other) {
    if (other.squared_distance > squared_distance ||
        (other.squared_distance == squared_distance && other.index < index))
      *this = other;
  }
};

// Summed axis by axis, so that it rounds monotonically in every |difference|: a box is never computed to be farther
// away than a point in it.
template <int Dim, class Difference>
double squared_length(const Difference& difference) {
  double sum = 0;
  for (int axis = 0; axis < Dim; ++axis) {
    const double x = difference(axis);
    sum += x * x;
  }
  return sum;
}

// A hierarchy of bounding boxes over runs of points in Morton order, up to a single box; each stores its point farthest
// from the picks.
template <int Dim>
class Hierarchy {
 public:
  Hierarchy(const PointsRef<Dim>& points, double scale)
      : order_(morton_order<Dim>(points)),
        points_(scale * points(Eigen::all, order_)),
        distances_(order_.size(), std::numeric_limits<double>::infinity()) {
    std::vector<Node> leaves(groups(order_.size(), leaf));
    for (std::size_t i = 0; i < order_.size(); ++i) {
      leaves[i / leaf].box.add(points_.col(i));
      leaves[i / leaf].farthest.take({distances_[i], order_[i]});
    }
    levels_.push_back(std::move(leaves));
    while (levels_.back().size() > 1) {
      const std::vector<Node>& below = levels_.back();
      std::vector<Node> level(groups(below.size(), run));
      for (std::size_t i = 0; i < below.size(); ++i) {
        level[i / run].box.add(below[i].box);
        level[i / run].farthest.take(below[i].farthest);
      }
      levels_.push_back(std::move(level));
    }
  }

  [[nodiscard]] const Farthest& farthest() const { return levels_.back()[0].farthest; }

  void insert(const Point<Dim>& pick) { update(levels_.size() - 1, 0, pick); }

 private:
  // Chosen by hand: larger ones compute more distances, smaller ones visit more boxes.
  static constexpr std::size_t leaf = 16;  // points per box of the lowest level
  static constexpr std::size_t run = 8;    // boxes per box of the next level

  struct Node {
    Box<Dim> box;
    Farthest farthest;
  };

  static std::size_t groups(std::size_t n, std::size_t size) { return (n + size - 1) / size; }

  static double squared_distance(const Box<Dim>& box, const Point<Dim>& x) {
    return squared_length<Dim>([&](int axis) {
      return std::max({box.lo[axis] - x[axis], x[axis] - box.hi[axis], 0.0});
    });
  }

  // Returns whether a distance in the node changed.
  bool update(std::size_t level, std::size_t i, const Point<Dim>& pick) {
    Node& node = levels_[level][i];
    if (squared_distance(node.box, pick) >= node.farthest.squared_distance) return false;
    if (level == 0) return update_leaf(i, node, pick);
    std::vector<Node>& below = levels_[level - 1];
    const std::size_t end = std::min(run * (i + 1), below.size());
    bool changed = false;
    for (std::size_t child = run * i; child < end; ++child) changed |= update(level - 1, child, pick);
    if (!changed) return false;
    node.farthest = {};
    for (std::size_t child = run * i; child < end; ++child) node.farthest.take(below[child].farthest);
    return true;
  }

  bool update_leaf(std::size_t i, Node& node, const Point<Dim>& pick) {
    const std::size_t begin = leaf * i;
    const std::size_t end = std::min(begin + leaf, order_.size());
    bool changed = false;
    for (std::size_t j = begin; j < end; ++j) {
      const double* x = points_.data() + Dim * j;
      const double d = squared_length<Dim>([&](int axis) { return x[axis] - pick[axis]; });
      changed |= d < distances_[j];
      distances_[j] = std::min(d, distances_[j]);
    }
    if (!changed) return false;
    node.farthest = {};
    for (std::size_t j = begin; j < end; ++j) node.farthest.take({distances_[j], order_[j]});
    return true;
  }

  std::vector<Index> order_;
  Points<Dim> points_;
  std::vector<double> distances_;  // squared, to the nearest pick
  std::vector<std::vector<Node>> levels_;
};

// A power of two that scales the largest coordinate to about one: exact, and squares neither overflow nor underflow.
template <int Dim>
double unit_scale(const PointsRef<Dim>& points) {
  int exponent = 0;
  std::frexp(points.cwiseAbs().maxCoeff(), &exponent);
  return std::ldexp(1.0, std::clamp(-exponent, -1000, 1000));
}

template <int Dim>
Index nearest_to_min_corner(const PointsRef<Dim>& points, double scale) {
  const Point<Dim> corner = points.rowwise().minCoeff();
  Index nearest = 0;
  double smallest = std::numeric_limits<double>::infinity();
  for (Index i = 0; i < points.cols(); ++i) {
    const double d = squared_length<Dim>([&](int axis) { return scale * points(axis, i) - scale * corner[axis]; });
    if (d < smallest) {
      smallest = d;
      nearest = i;
    }
  }
  return nearest;
}

}  // namespace

template <int Dim>
FarthestPoints farthest_points(const PointsRef<Dim>& points, Index count, const FarthestPointsOptions& options) {
  constexpr const char* function = "farthest_points";
  require(count >= 0, function, "count", count, "must not be negative");
  require(points.allFinite(), function, "points", "NaN or infinity",
          "every coordinate must be finite; remove the others");
  require(!options.first || (*options.first >= 0 && *options.first < points.cols()), function, "first",
          options.first.value_or(0), "must be the index of a point");
  FarthestPoints picks;
  if (points.cols() == 0 || count == 0) return picks;

  const double scale = unit_scale<Dim>(points);
  Hierarchy<Dim> hierarchy(points, scale);
  Farthest next{std::numeric_limits<double>::infinity(),
                options.first ? *options.first : nearest_to_min_corner<Dim>(points, scale)};
  constexpr Index report_every = 4096;  // picks between progress reports
  for (Index done = 0; done < count && next.squared_distance > 0; ++done) {
    if (done % report_every == 0)
      report(options.progress, "farthest points", static_cast<double>(done) / static_cast<double>(count));
    picks.indices.push_back(next.index);
    picks.radii.push_back(std::sqrt(next.squared_distance) / scale);
    hierarchy.insert(scale * points.col(next.index));
    next = hierarchy.farthest();
  }
  picks.covering_radius = std::sqrt(next.squared_distance) / scale;
  return picks;
}

#define CSRBF_INSTANTIATE(Dim) \
  template FarthestPoints farthest_points<Dim>(const PointsRef<Dim>&, Index, const FarthestPointsOptions&);
CSRBF_FOR_MANY_DIMS(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
