#pragma once

#include "csrbf/surface/normals/neighbor_table.hpp"
#include "csrbf/surface/prepare/prepare.hpp"

namespace csrbf {

/// Adds "`count` `text`" to the warnings, unless the count is 0.
void warn(std::vector<std::string>& warnings, Index count, const std::string& text);

/// Spacing s with s^2 = area per sample: the area of the disc out to the farthest neighbour, divided by the number of
/// neighbours on this sheet.
Eigen::VectorXd local_spacing(const Points<3>& normals, const NeighborTable& near);

/// Normalises given normals; returns how many are missing (zero or not finite).
Index normalize(Points<3>& normals);

/// Those of the points `ids`, normalised, zero where they are missing; none if none are given.
Points<3> unit_normals(const Points<3>& given, const std::vector<Index>& ids);

/// Finds the normals of the cloud, or corrects those that it has if some are given; says in its warnings what was done.
void find_normals(PreparedCloud& result, const NeighborTable& near, Normals source, bool given,
                  const std::optional<Box<3>>& region, const Progress& progress);

/// Turns given normals that consistently point inward: they are not contradictory, but would make the outside solid.
void turn_outward(PreparedCloud& result, Normals source);

/// Says so if a good part of the surface has far fewer samples than where most of them are.
void warn_of_sparse_parts(PreparedCloud& result);

}  // namespace csrbf
