#pragma once

#include "csrbf/spatial/farthest_points.hpp"
#include "csrbf/surface/composite/composite_field.hpp"
#include "surface/surface_testing.hpp"

namespace csrbf {

/// A composite field over samples spread evenly over `area`: levels of patches to a quarter of the samples each, and
/// the winding number of all.
inline CompositeField composite_field(const PointCloud& cloud, double area, const CompositeOptions& options = {}) {
  CompositeField::Data data;
  data.bounds = bounding_box<3>(cloud.points);
  data.origin = data.bounds.center();
  data.scale = data.bounds.diagonal();
  PointCloud unit{(cloud.points.colwise() - data.origin) / data.scale, cloud.normals, {}};
  area /= data.scale * data.scale;
  const CompositeFit finest = fit_composite(oriented(unit, area), options);
  data.winding = WindingNumber(unit.points, unit.normals, finest.areas, 0.7 * finest.areas.cwiseSqrt());
  data.feature_size = std::sqrt(finest.areas.mean());
  data.far_value = 3 * data.feature_size;
  data.levels.push_back(finest.patches);
  while (unit.size() >= 400) {
    const std::vector<Index> kept = farthest_points<3>(unit.points, unit.size() / 4).indices;
    unit = {Points<3>(unit.points(Eigen::all, kept)), Points<3>(unit.normals(Eigen::all, kept)), {}};
    data.levels.push_back(fit_composite(oriented(unit, area), options).patches);
  }
  return CompositeField(std::move(data));
}

}  // namespace csrbf
