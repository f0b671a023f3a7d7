#pragma once

#include "csrbf/implicit/polygonize.hpp"
#include "csrbf/surface/reconstruct.hpp"
#include "csrbf/tiles/tile_share.hpp"

#include <string>

namespace csrbf {

/// How reconstruct_tiles() works. What is not said here is chosen from the data.
struct TileOptions {
  /// Points per tile at most, about; memory grows with it: 0.9 to 1.8 kB for each point of a tile.
  Index tile_points = 1'000'000;
  double memory = 0;  ///< bytes for each process, from which the size of tiles follows; 0: `tile_points` is the size
  /// Where finished steps are kept. A folder with steps of the same work is continued, to the same result.
  std::string folder;
  /// Method composite; `tolerance`, `centers` and `region` are refused.
  ReconstructOptions surface = {};
  /// Cells along the longest side; 0: from the data, as automatic_resolution().
  int resolution = 0;
  /// Edges and corners of the mesh: not set: dual contouring for clean samples, marching cubes for noisy ones.
  std::optional<PolygonizeMethod> mesh_method = {};
  /// File for the model of the surface, which is read tile by tile; empty: none.
  std::string model = {};
  TileShare share = {};
  /// Called at the start when the disk may be too small; not set: the report says so.
  std::function<void(const std::string&)> warn = {};
};

/// What reconstruct_tiles() found, chose and measured.
struct TileReport {
  /// Over all tiles; `smoothing`, `leaf_size` and other settings are chosen in each of them and not told.
  ReconstructReport surface;
  Index tiles = 0;
  Index tile_points = 0;   ///< points per tile at most, about
  Index continued = 0;     ///< tiles that an earlier run, or another process, had fitted
  Index meshed_again = 0;  ///< tiles meshed once more, as the surface enters them from beside only
  int resolution = 0;
  PolygonizeMethod mesh_method = PolygonizeMethod::marching_cubes;
  Topology topology;        ///< of the mesh
  Index weak_features = 0;  ///< bridges cut and holes filled, but for those where tiles meet
};

/// reconstruct() and polygonize() for more points than memory: from a file of points to a file of a mesh, tile by tile;
/// or, where `mesh` ends with a slash, to a folder of files tile_NNNN.ply, which meet in vertices of the same bits.
///
/// Space is cut into tiles with about as many points each. A tile is reconstructed from all points in it and around it,
/// and from ever fewer farther away, which tell it what it is part of; so it chooses its own settings. Where tiles
/// meet, their functions blend, as patches do within them (TiledField). The mesh is made tile by tile too and fits
/// together vertex by vertex. With one tile the result is that of reconstruct() and polygonize().
///
/// Every finished step is a file in `options.folder`. An interrupted run goes on from there when it is called again,
/// and several processes (`options.share`) that see the folder divide the work, on one machine or many; the mesh is the
/// same, byte for byte, for any number of processes and threads. The folder is emptied at the end. Time O(n log n);
/// memory proportional to the points of a tile, and to the triangles at the faces of tiles; disk about 250 bytes per
/// point, with `model` about 700.
///
/// Throws as reconstruct(), IoError for files, InvalidInput when the folder has steps of other work, SolverFailure when
/// another process failed.
TileReport reconstruct_tiles(const std::string& points, const std::string& mesh, const TileOptions& options);

}  // namespace csrbf
