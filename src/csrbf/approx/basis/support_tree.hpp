#pragma once

#include "csrbf/core/types.hpp"

#include <numeric>
#include <vector>

namespace csrbf {

/// Finds the balls that contain a point: the supports of radial functions. Built once for M balls, O(M log M); a query
/// costs about the logarithm of M plus the number of balls found, however different the radii are, because every octave
/// of radii has a tree of its own.
///
/// The balls are stored in slots, leaf by leaf; every leaf has `leaf_size` slots, of which the last ones may be empty.
template <int Dim>
class SupportTree {
 public:
  /// Chosen by hand, a multiple of the vector width 8: larger leaves test more balls, smaller ones visit more nodes.
  static constexpr Index leaf_size = 16;

  /// Consecutive slots, a multiple of leaf_size.
  struct Run {
    Index begin;
    Index end;
  };

  SupportTree() = default;

  /// Radii may be infinite; such balls contain every point.
  SupportTree(const PointsRef<Dim>& centers, const Eigen::VectorXd& radii) : centers_(centers), radii_(radii) {
    std::vector<Index> ids(centers.cols());
    std::iota(ids.begin(), ids.end(), Index{0});
    const auto octave = [&](Index j) { return std::isfinite(radii[j]) ? std::ilogb(radii[j]) : 1 << 20; };
    std::stable_sort(ids.begin(), ids.end(), [&](Index i, Index j) { return octave(i) < octave(j); });
    for (auto first = ids.begin(); first != ids.end();) {
      const auto last = std::find_if(first, ids.end(), [&](Index j) { return octave(j) != octave(*first); });
      build(&*first, last - first);
      first = last;
    }
  }

  /// Number of slots.
  [[nodiscard]] Index slots() const { return static_cast<Index>(slots_.size()); }

  /// The ball in slot i, or -1 for an empty slot.
  [[nodiscard]] Index ball(Index i) const { return slots_[i]; }

  /// Replaces `runs` by slots that include every ball with x strictly inside. Ascending.
  void find(const Point<Dim>& x, std::vector<Run>& runs) const { find(Box<Dim>{x, x}, runs); }

  /// The same for every ball whose interior meets the box.
  void find(const Box<Dim>& box, std::vector<Run>& runs) const {
    runs.clear();
    for (std::size_t i = 0; i < nodes_.size();) {
      const Node& node = nodes_[i];
      double squared_distance = 0;
      for (int a = 0; a < Dim; ++a) {
        const double gap = std::max(std::max(node.box.lo[a] - box.hi[a], box.lo[a] - node.box.hi[a]), 0.0);
        squared_distance += gap * gap;
      }
      if (!(squared_distance < node.squared_radius)) {
        i = node.skip;
        continue;
      }
      ++i;
      if (node.skip != i) continue;
      if (!runs.empty() && runs.back().end == node.begin)
        runs.back().end += leaf_size;
      else
        runs.push_back({node.begin, node.begin + leaf_size});
    }
  }

 private:
  // Nodes in preorder: the first child follows its parent, `skip` is the node after the subtree.
  struct Node {
    Box<Dim> box;
    double squared_radius = 0;  // largest in the box
    std::size_t skip = 0;
    Index begin = 0;  // first slot of a leaf
  };

  void build(Index* ids, Index n) {
    const std::size_t i = nodes_.size();
    nodes_.emplace_back();
    Node node;
    double radius = 0;
    for (Index k = 0; k < n; ++k) {
      node.box.add(centers_.col(ids[k]));
      radius = std::max(radius, radii_[ids[k]]);
    }
    node.squared_radius = radius * radius;
    if (n <= leaf_size) {
      node.begin = slots();
      slots_.insert(slots_.end(), ids, ids + n);
      slots_.resize(node.begin + leaf_size, -1);
    } else {
      Index axis = 0;
      node.box.extent().maxCoeff(&axis);
      const Index half = (n / leaf_size + 1) / 2 * leaf_size;  // full leaves on the left
      std::nth_element(ids, ids + half, ids + n, [&](Index a, Index b) {
        return centers_(axis, a) != centers_(axis, b) ? centers_(axis, a) < centers_(axis, b) : a < b;
      });
      build(ids, half);
      build(ids + half, n - half);
    }
    node.skip = nodes_.size();
    nodes_[i] = node;
  }

  Points<Dim> centers_;
  Eigen::VectorXd radii_;
  std::vector<Node> nodes_;
  std::vector<Index> slots_;
};

}  // namespace csrbf
