#pragma once

#include "csrbf/io/point_stream.hpp"
#include "csrbf/tiles/stages/deal_records.hpp"

namespace csrbf {

/// Points of a cloud with their normals, if any, in single precision.
Records<3> records_of(const PointCloud& cloud);
PointCloud cloud_of(const Records<3>& records);

/// The points of a file. `stream` must outlive it.
RecordSource<3> cloud_source(PointStream& stream);

/// Tiles of up to `tile_points` for a mesh of that resolution (0: automatic).
TileRules surface_rules(Index tile_points, int resolution);

/// What work on a surface adds to the notes.
Archive surface_notes(PointStream& stream);

/// Names of properties of the points, such as colours, which tiles leave out.
std::string left_out(const TileWork<3>& work);

}  // namespace csrbf
