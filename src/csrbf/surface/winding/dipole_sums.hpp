#pragma once

#include "csrbf/core/types.hpp"

#include <cstdint>
#include <vector>

namespace csrbf::winding {

/// Sums over all pairs of points of a fixed cloud, with the kernel of the winding number softened by eps_ij^2, the mean
/// of eps_i^2 and eps_j^2, which is symmetric. Distant groups of points act as one at their centre (Barnes and Hut
/// 1986): error of w about 0.03. Which groups these are is found once, so that sums with other strengths or smoothing
/// are cheap, as iterations need them. Single precision; O(n log n); on all threads.
class DipoleSums {
 public:
  using Vectors = Eigen::Matrix<float, 3, Eigen::Dynamic>;

  /// Points that are finite and do not all coincide.
  explicit DipoleSums(const PointsRef<3>& points);

  /// Indices of the points in the order in which strengths and results are; the following functions use it.
  [[nodiscard]] const std::vector<Index>& order() const { return order_; }
  void set_smoothing(const Eigen::VectorXd& eps);

  /// The winding number at the points: w_i = sum_j m_j . (p_j - p_i) / (4 pi D_ij^(3/2)), D_ij = |p_j - p_i|^2 +
  /// eps_ij^2, where m are normals times areas.
  [[nodiscard]] Eigen::VectorXf winding(const Vectors& m) const;
  /// The adjoint of winding().
  [[nodiscard]] Vectors adjoint(const Eigen::VectorXf& r) const;
  /// Minus the gradient of the winding number at the points: it points outward.
  [[nodiscard]] Vectors outward(const Vectors& m) const;

 private:
  static constexpr Index block = 16;  // points of a leaf of the tree, which are summed at a time

  struct Node {
    std::int32_t begin, end, right;  // right: index of the right child, the left one follows its parent; 0 for a leaf
    float center[3], radius;
  };
  struct Range {
    std::int32_t begin, end;
  };

  std::int32_t build(const Points<3>& points, Index begin, Index end);
  void find_sources();
  template <class Term, class Strengths>
  auto sum(const Strengths& strengths) const;

  std::vector<Index> order_;
  std::vector<Node> nodes_;
  // Positions and half the squared smoothing lengths, of the nodes first and then of the points.
  std::vector<float> x_[3], half_eps2_;
  // Sources of each block: ranges of nodes and points.
  std::vector<std::int32_t> first_source_;
  std::vector<Range> sources_;
};

}  // namespace csrbf::winding
