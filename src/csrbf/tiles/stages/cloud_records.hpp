#pragma once

#include "csrbf/io/point_stream.hpp"
#include "csrbf/tiles/stages/deal_records.hpp"

namespace csrbf {

/// Points of a cloud with their normals, if any, in single precision.
Records<3> records_of(const PointCloud& cloud);
PointCloud cloud_of(const Records<3>& records);

/// The points of a file. `stream` must outlive it.
RecordSource<3> cloud_source(PointStream& stream);

/// Decides on tiles of up to `tile_points` for a mesh of that resolution (0: automatic). See plan_work().
TileWork<3> plan_surface(PointStream& stream, Index tile_points, int resolution, const std::string& fingerprint,
                         const Progress& progress);

/// Names of properties of the points, such as colours, which tiles leave out.
std::string left_out(const TileWork<3>& work);

}  // namespace csrbf
