#pragma once

#include "csrbf/core/mesh.hpp"
#include "figure.hpp"

#include <optional>
#include <string>

namespace csrbf::thesis {

/// The archive of models that comes with Debian's package libcgal-demo.
extern const std::string models_file;

/// A model of that archive as points with outward normals: the vertices of large meshes, else `samples` random points
/// of the surface, of the kitten of the surface through its 5,210 points. Of "bunny", "dragon", "kitten" and "knot".
/// Empty when the archive, or the model in it, is not there.
std::optional<PointCloud> model(const std::string& name, Index samples = 30000);

/// The figure with what says that the models are missing.
Figure without_models(Figure figure);

/// Points of a generated tree of vessels with an aneurysm, for the thesis' own one.
PointCloud vessel_tree(Index samples);

/// The points that `keep` says.
template <class Keep>
PointCloud part_of(const PointCloud& cloud, const Keep& keep) {
  std::vector<Index> ids;
  for (Index i = 0; i < cloud.size(); ++i)
    if (keep(Point<3>(cloud.points.col(i)))) ids.push_back(i);
  return {cloud.points(Eigen::all, ids), cloud.normals(Eigen::all, ids), {}};
}

/// Every point moved by Gaussian noise of a standard deviation in diagonals; the normals stay.
PointCloud shaken(PointCloud cloud, double deviation);

}  // namespace csrbf::thesis
