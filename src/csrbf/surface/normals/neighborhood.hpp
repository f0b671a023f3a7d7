#pragma once

#include "csrbf/spatial/kd_tree.hpp"
#include "csrbf/surface/normals/local_normal.hpp"
#include "csrbf/surface/normals/neighbor_table.hpp"

namespace csrbf {

/// Nearest points of a location and the surface through them; the spans of a query are valid until the next.
class Neighborhood {
 public:
  Neighborhood(const Points<3>& points, const KdTree<3>& tree) : points_(points), tree_(tree) {}

  void query(const Point<3>& center, Index count);
  /// Doubles the number of neighbours until they do not lie on a line, up to 256.
  void query_surface(const Point<3>& center, Index count);
  /// Keeps those neighbours that `keep(id)` is true for.
  template <class Keep>
  void keep_if(const Keep& keep) {
    std::size_t kept = 0;
    for (std::size_t j = 0; j < count_; ++j)
      if (keep(ids_[j])) {
        ids_[kept] = ids_[j];
        d2_[kept++] = d2_[j];
      }
    count_ = kept;
    if (count_ > 0) frame_ = local_frame(points_, ids(), d2(), frame_.center);
  }
  [[nodiscard]] std::span<const Index> ids() const { return {ids_.data(), count_}; }
  [[nodiscard]] std::span<const double> d2() const { return {d2_.data(), count_}; }
  [[nodiscard]] const LocalFrame& frame() const { return frame_; }
  [[nodiscard]] LocalQuadric quadric() const { return fit_quadric(points_, ids(), d2(), frame_); }
  /// Standard deviation of the neighbours from their quadric; more than its 6 coefficients.
  [[nodiscard]] double deviation() const;

 private:
  const Points<3>& points_;
  const KdTree<3>& tree_;
  std::vector<Index> ids_;
  std::vector<double> d2_;
  std::size_t count_ = 0;
  LocalFrame frame_;
};

struct NeighborChoice {
  Index neighbors = 0;
  bool suits = false;  ///< more were tried and are worse
  bool rough = false;  ///< no number of neighbours shows a smooth surface: strong noise, or sheets close to each other
};

/// The number of neighbours per normal that suits a cloud: 16 for clean data, up to 512 under noise, fewer where
/// another sheet is in between. See estimate_normals().
NeighborChoice choose_neighbors(const Points<3>& points, const KdTree<3>& tree);

/// Fits oriented normals again to neighbours of the same sheet only, if more of these suit; returns their number.
Index refit_normals(const Points<3>& points, const KdTree<3>& tree, Points<3>& normals);

/// Normals without orientation of the points [begin, end), in Morton order; zero where the neighbours lie on a line.
/// One quadric for all of them if they lie within half the radius of their neighbourhood; else for each half of them.
/// A table with rows gets those of points with a quadric of their own.
void fit_normals(const Points<3>& points, Index begin, Index end, Index neighbors, Neighborhood& near,
                 Points<3>& normals, NeighborTable& table);

}  // namespace csrbf
