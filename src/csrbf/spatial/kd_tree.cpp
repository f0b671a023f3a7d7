#include "csrbf/spatial/kd_tree.hpp"

#include <nanoflann.hpp>

#include <algorithm>
#include <limits>
#include <utility>

namespace csrbf {
namespace {

// The adaptor that nanoflann requires.
template <int Dim>
struct Columns {
  const double* data;
  Index count;

  [[nodiscard]] std::size_t kdtree_get_point_count() const { return static_cast<std::size_t>(count); }
  [[nodiscard]] double kdtree_get_pt(std::size_t i, std::size_t axis) const { return data[Dim * i + axis]; }
  template <class BoundingBox>
  bool kdtree_get_bbox(BoundingBox& /*box*/) const {
    return false;
  }
};

template <int Dim>
using Search =
    nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, Columns<Dim>, double, std::uint32_t>,
                                        Columns<Dim>, Dim, std::uint32_t>;

// Calls use(index) for the points within a radius, in no order and without their distances, until it returns false.
template <class Use>
struct WithinRadius {
  double squared_radius;
  Use use;

  WithinRadius(double radius, const Use& use_index) : squared_radius(radius * radius), use(use_index) {}
  bool addPoint(double squared_distance, std::uint32_t index) {
    return !(squared_distance < squared_radius) || use(index);
  }
  [[nodiscard]] double worstDist() const { return squared_radius; }
  [[nodiscard]] bool full() const { return true; }
};

// The nearest ones of all points: up to twice as many, of which the farther half is dropped when there is no room. A
// point takes O(1), in the sorted list of nanoflann O(k).
class NearestBuffer {
 public:
  explicit NearestBuffer(Index k) : most_(static_cast<std::size_t>(k)) { found_.reserve(2 * most_); }
  bool addPoint(double squared_distance, std::uint32_t index) {
    if (!(squared_distance < worst_)) return true;
    found_.emplace_back(squared_distance, index);
    if (found_.size() == 2 * most_) drop_half();
    return true;
  }
  [[nodiscard]] double worstDist() const { return worst_; }
  [[nodiscard]] bool full() const { return found_.size() >= most_; }

  // By distance, equal ones by index.
  Index write(Index* indices, double* squared_distances) {
    if (found_.size() > most_) drop_half();
    std::sort(found_.begin(), found_.end());
    for (std::size_t i = 0; i < found_.size(); ++i) {
      indices[i] = found_[i].second;
      squared_distances[i] = found_[i].first;
    }
    return std::ssize(found_);
  }

 private:
  void drop_half() {
    const auto last = found_.begin() + static_cast<std::ptrdiff_t>(most_) - 1;
    std::nth_element(found_.begin(), last, found_.end());
    worst_ = last->first;
    found_.resize(most_);
  }

  std::size_t most_;
  double worst_ = std::numeric_limits<double>::infinity();
  std::vector<std::pair<double, std::uint32_t>> found_;
};

constexpr Index many = 32;             // neighbours from which on a buffer is faster; chosen by hand
constexpr std::size_t leaf_size = 16;  // points; nanoflann recommends 10 to 50 where queries dominate the cost

}  // namespace

template <int Dim>
struct KdTree<Dim>::Impl {
  Columns<Dim> columns;
  Search<Dim> search;

  explicit Impl(const PointsRef<Dim>& points)
      : columns{points.data(), points.cols()},
        search(Dim, columns, nanoflann::KDTreeSingleIndexAdaptorParams(leaf_size)) {
    search.buildIndex();
  }
};

template <int Dim>
KdTree<Dim>::KdTree(const PointsRef<Dim>& points) : impl_(std::make_unique<Impl>(points)) {}
template <int Dim>
KdTree<Dim>::KdTree(KdTree&&) noexcept = default;
template <int Dim>
KdTree<Dim>& KdTree<Dim>::operator=(KdTree&&) noexcept = default;
template <int Dim>
KdTree<Dim>::~KdTree() = default;

template <int Dim>
Index KdTree<Dim>::size() const {
  return impl_->columns.count;
}

template <int Dim>
Index KdTree<Dim>::nearest(const Point<Dim>& x, Index k, Index* indices, double* squared_distances) const {
  if (size() == 0 || k <= 0) return 0;
  if (k >= many) {
    NearestBuffer nearest(std::min(k, size()));
    impl_->search.findNeighbors(nearest, x.data(), nanoflann::SearchParams());
    return nearest.write(indices, squared_distances);
  }
  nanoflann::KNNResultSet<double, Index, Index> result(k);
  result.init(indices, squared_distances);
  impl_->search.findNeighbors(result, x.data(), nanoflann::SearchParams());
  return result.size();
}

template <int Dim>
void KdTree<Dim>::within(const Point<Dim>& x, double radius, std::vector<Index>& indices) const {
  indices.clear();
  if (size() == 0) return;
  WithinRadius within(radius, [&](Index index) {
    indices.push_back(index);
    return true;
  });
  impl_->search.findNeighbors(within, x.data(), nanoflann::SearchParams());
  std::sort(indices.begin(), indices.end());
}

template <int Dim>
bool KdTree<Dim>::any_within(const Point<Dim>& x, double radius) const {
  if (size() == 0) return false;
  bool found = false;
  WithinRadius within(radius, [&](Index) {
    found = true;
    return false;
  });
  impl_->search.findNeighbors(within, x.data(), nanoflann::SearchParams());
  return found;
}

std::vector<Index> points_apart(const Points<3>& points, const KdTree<3>& tree, double distance) {
  std::vector<char> covered(static_cast<std::size_t>(points.cols()), 0);
  std::vector<Index> result, near;
  for (Index i = 0; i < points.cols(); ++i) {
    if (covered[static_cast<std::size_t>(i)] != 0) continue;
    result.push_back(i);
    tree.within(points.col(i), distance, near);
    for (const Index j : near) covered[static_cast<std::size_t>(j)] = 1;
  }
  return result;
}

#define CSRBF_INSTANTIATE(Dim) template class KdTree<Dim>;
CSRBF_FOR_MANY_DIMS(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
