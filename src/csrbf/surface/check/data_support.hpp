#pragma once

#include "csrbf/core/mesh.hpp"
#include "csrbf/spatial/kd_tree.hpp"

namespace csrbf {

/// Index of the nearest point for every query.
std::vector<Index> nearest_points(const KdTree<3>& tree, const PointsRef<3>& queries);

/// Mean distance of point i of the tree to its nearest neighbours.
double spacing_at(const KdTree<3>& tree, const PointsRef<3>& points, Index i);

/// Connected component of every vertex, numbered from 0 in the order of their first vertices.
std::vector<Index> component_labels(const Mesh& mesh, Index& count);

/// The data of a component of a mesh.
struct DataSupport {
  double area = 0;     ///< of the component
  double samples = 0;  ///< points to which it is nearest
  // Of components with few or sparse samples only:
  double sample_area = 0;    ///< surface that they usually represent
  double beside_others = 0;  ///< samples with one of another component within 1.25 spacings

  void add(const DataSupport& other);
};

/// That of each component; O((v + n) log v) unless most points are far from all components but the largest.
std::vector<DataSupport> data_support(const Mesh& mesh, const std::vector<Index>& label, Index count,
                                      const PointsRef<3>& points);

/// Which components have data: not those with far fewer points than expected for their area, by the density of all or,
/// from 64 points on, by their own spacing; with fewer than 8; or with points that stand for a much larger area, which
/// belong to the sheets between which the component is a bubble. At least one.
std::vector<char> components_with_data(const std::vector<DataSupport>& supports);

/// How many of the components kept are shards: they have fewer than 64 samples, and another component is so near that
/// one surface may go through both. Bodies that are well sampled, or stand apart, are none.
Index count_shards(const std::vector<DataSupport>& supports, const std::vector<char>& keep);

}  // namespace csrbf
