#pragma once

#include "csrbf/io/vtk/vtk.hpp"

#include <vector>

namespace csrbf {

/// Reads a VTK image (.vti): the point array declared as its scalars, else the first one; without any, the cell arrays,
/// as voxels around the centres of the cells. Positions are taken as they are, in no patient space.
/// Throws IoError.
RawVolume parse_vti(std::string bytes, const std::string& path);

/// A VTK image whose points are the voxels, with one array `values`. Positions are written as they are.
FileParts format_vti(const VolumeLayout& layout, std::string samples);

/// The same with several arrays, whose bytes are in the order of the voxels. The first is the active one.
FileParts format_vti(const Grid& grid, std::vector<VtkArray> arrays);

/// Writes several named arrays over a grid to .vti, complete or not at all (AtomicFile). Throws IoError; InvalidInput
/// when there is no array or one does not match the grid.
void write_vti(const std::string& path, const Grid& grid, std::vector<VtkArray> arrays);

}  // namespace csrbf
