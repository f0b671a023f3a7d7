#pragma once

#include "csrbf/implicit/polygonize.hpp"
#include "csrbf/surface/reconstruct.hpp"
#include "csrbf/tiles/tile_share.hpp"

#include <string>

namespace csrbf {

/// How reconstruct_tiles() works. Options not given are chosen from the data.
struct TileOptions {
  /// About the largest number of points per tile. Memory grows with it: 0.9 to 1.8 kB for each point of a tile.
  Index tile_points = 1'000'000;
  /// Memory for each process, in bytes, which determines the size of the tiles; 0: `tile_points` does.
  double memory = 0;
  /// Folder for finished steps. If it has steps of the same work, they are continued, with the same result.
  std::string folder;
  /// Must have the method composite or auto; `tolerance`, `centers` and `region` are refused.
  ReconstructOptions surface = {};
  /// Cells along the longest side; 0: chosen from the data, as by automatic_resolution().
  int resolution = 0;
  /// Unset: dual contouring, which keeps edges and corners, for clean points; marching cubes for noisy ones.
  std::optional<PolygonizeMethod> mesh_method = {};
  /// File for the model of the surface, which is later read tile by tile; empty: none.
  std::string model = {};
  TileShare share = {};
  /// Called at the start if the disk may be too small; if unset, a warning of the report says so.
  std::function<void(const std::string&)> warn = {};
};

/// What reconstruct_tiles() found, chose and measured.
struct TileReport {
  /// Over all tiles; `smoothing`, `leaf_size` and other settings are chosen in each tile and not reported.
  ReconstructReport surface;
  Index tiles = 0;
  Index tile_points = 0;   ///< about the largest number of points per tile
  Index continued = 0;     ///< tiles that an earlier run or another process had fitted
  Index meshed_again = 0;  ///< tiles meshed a second time because the surface enters them from a neighbour only
  int resolution = 0;
  PolygonizeMethod mesh_method = PolygonizeMethod::marching_cubes;
  Topology topology;        ///< of the mesh
  Index weak_features = 0;  ///< bridges cut and holes filled, except where tiles meet
};

/// reconstruct() and polygonize() for more points than fit in memory: makes a mesh file from a file of points, tile by
/// tile. If `mesh` ends with a slash, it is a folder for one file per tile, tile_NNNN.ply; their common vertices agree
/// bit for bit.
///
/// Space is cut into tiles with about the same number of points. Each tile is reconstructed on its own, with its own
/// settings, from all points in it and around it and from ever fewer points farther away, which tell what it is part
/// of. Where tiles meet, their functions are blended, as patches are within a tile. The mesh is made tile by tile, too,
/// and fits together vertex by vertex. With one tile the result is that of reconstruct() and polygonize().
///
/// Every finished step is a file in `options.folder`. Called again after an interruption, the function continues from
/// there. Several processes (`options.share`) that see the folder divide the work, on one machine or many. The mesh is
/// the same, byte for byte, for any number of processes and threads. The folder is emptied at the end. Time O(n log n);
/// memory proportional to the points of a tile and to the triangles where tiles meet; disk about 250 bytes per point,
/// with `model` about 700.
///
/// Throws as reconstruct(); IoError for files; InvalidInput for options that are refused and if the folder has steps of
/// other work; SolverFailure if another process failed.
TileReport reconstruct_tiles(const std::string& points, const std::string& mesh, const TileOptions& options);

}  // namespace csrbf
