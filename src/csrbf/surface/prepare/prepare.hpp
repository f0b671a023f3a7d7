#pragma once

#include "csrbf/core/mesh.hpp"
#include "csrbf/spatial/kd_tree.hpp"
#include "csrbf/surface/composite/composite.hpp"

namespace csrbf {

/// A cloud ready to be fitted.
struct PreparedCloud {
  /// In unit coordinates y = (x - origin) / scale (bounding-box diagonal 1): the points used in Morton order, then
  /// samples of flat ends (see flat_ends()), which are not in the input.
  OrientedPoints cloud;
  std::unique_ptr<const KdTree<3>> tree;  ///< of the points of the cloud
  Point<3> origin = Point<3>::Zero();
  double scale = 1;
  Box<3> bounds;              ///< of the points used, in the user's coordinates
  std::vector<Index> source;  ///< index in the input of every point used
  /// Indices in the input of some points of the cloud.
  [[nodiscard]] std::vector<Index> sources_of(const std::vector<Index>& points) const;

  /// Parts of the cloud, indices ascending, that gaps wider than a few spacings separate from the largest part.
  std::vector<std::vector<Index>> components;
  NormalSource normals = NormalSource::file;
  std::vector<std::string> warnings;
};

/// Cleans a cloud: drops non-finite points, merges coincident points, leaves out clutter around the surface (see
/// all_but_clutter()) and drops stray points (small isolated clusters much sparser than the rest), finds normals,
/// corrects given ones that have errors (see correct_normals()), and finds the local spacing. Every change is reported
/// in `warnings`. If there is a region, only points in it are counted there, and given normals outside of it are left
/// as they are. Throws InvalidInput for fewer than four distinct points, and for collinear points. O(n log n).
PreparedCloud prepare(const PointCloud& input, Normals normals, const Progress& progress = {},
                      const std::optional<Box<3>>& region = {});

}  // namespace csrbf
