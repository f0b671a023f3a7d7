#pragma once

#include "csrbf/surface/normals/orientation_graph.hpp"

namespace csrbf::orientation {

/// One sign, 1 or -1, per cluster.
using Signs = std::vector<signed char>;

/// Least mean winding number on a surface that has an inside and an outside: between 0 for a flat sheet and 1/2 for a
/// closed surface. Chosen by hand.
inline constexpr double has_inside = 0.1;

/// Energy of the signs of clusters by the winding number w. For a closed surface with outward normals w is 1 inside,
/// 0 outside and 1/2 on it. The energy of a choice of signs is the mean over sampled points of (2 w - 1)^2 on the
/// surface and of 4 min(w^2, (1 - w)^2) at several distances on both sides of it, so that clusters of every size have
/// an effect. w is linear in the signs, so that changing one is cheap.
class Energy {
 public:
  Energy(const Points<3>& points, const Points<3>& normals, const NeighborTable& table, const Graph& graph,
         const Clusters& clusters);

  /// 0 for a closed surface, around 1 where the side is undecided, up to 4 if inside out.
  [[nodiscard]] double of(const Signs& signs) const;
  /// Mean of w on the surface: 1/2 if it is closed, 0 for a flat sheet, which has no inside.
  [[nodiscard]] double mean_winding(const Signs& signs) const;
  /// How much w changes on the surface: mean of (w(p) - w(q))^2 over neighbouring sampled points. Around 0 for any
  /// sheet, closed or not, that has its sides right, for w then takes two values beside it; where one of two sheets
  /// that meet is turned, three.
  [[nodiscard]] double unevenness(const Signs& signs) const;
  /// Orients every cluster outward by its own winding number, the mean of which is at least `least`. Flatter ones do
  /// not change.
  void turn_each_outward(Signs& signs, double least = has_inside) const;
  /// Turns bodies outward whose own winding number has a mean of at least `least`: subtrees of less than half of the
  /// surface that hardly any neighbours join to the rest, as an object on the ground, if w then changes no more along
  /// the surface. Returns whether there were any.
  bool turn_bodies_outward(Signs& signs, double least) const;
  /// Flips clusters, and subtrees of clusters in the spanning tree, while that lowers the energy plus a cost of
  /// disagreeing neighbours; starts from the given signs and from their opposite.
  void descend(Signs& signs) const;
  /// The same for the unevenness, from the given signs.
  void even_out(Signs& signs) const;

 private:
  [[nodiscard]] Eigen::VectorXf winding(const Signs& signs) const;
  double descend_from(Signs& signs) const;
  template <class Measure>
  double descend_by(const Measure& measure, double weight_of_votes, Signs& signs) const;
  [[nodiscard]] double unevenness_of(const Eigen::VectorXf& w) const;
  [[nodiscard]] double of_winding(const Eigen::VectorXf& w) const;
  void sum_winding(const Points<3>& probes, const Points<3>& points, const Points<3>& normals,
                   const NeighborTable& table, const Clusters& clusters,
                   const std::vector<std::vector<Index>>& members);
  void count_votes(const Points<3>& points, const Points<3>& normals, const Graph& graph, const Clusters& clusters);

  Eigen::MatrixXf winding_;            // probe x cluster: w of the cluster alone
  Eigen::VectorXf weight_;             // of the probes, sum 1
  std::vector<std::int32_t> cluster_;  // of the probes on the surface
  Index on_surface_ = 0;               // number of probes on the surface, which come first
  NeighborTable samples_;              // of the probes on the surface
  Eigen::MatrixXd votes_;              // cluster x cluster: agreeing minus disagreeing neighbours, as a share of all
  double loose_ = 0;                   // votes over the square root of the surface that join a part loosely
  std::vector<std::vector<Index>> moves_;  // sets of clusters to flip together
};

}  // namespace csrbf::orientation
