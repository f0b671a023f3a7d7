#pragma once

#include "csrbf/core/field.hpp"
#include "csrbf/core/mesh.hpp"
#include "csrbf/core/progress.hpp"

#include <optional>

namespace csrbf {

/// How cells become triangles.
enum class PolygonizeMethod {
  marching_cubes,  ///< vertices on the edges of cells; each face of a cell is cut by its own four corner values only
                   ///< (asymptotic decider, Nielson and Hamann 1991)
  marching_tetrahedra,  ///< vertices on the edges and diagonals of cells, divided into six tetrahedra each: no
                        ///< ambiguous cases, about three times the triangles, and thinner ones (Doi and Koide 1991)
  dual_contouring,      ///< a vertex in every cell, for each surface that crosses it (Nielson 2004), where the tangent
                        ///< planes at the crossings of its edges meet (Ju, Losasso, Schaefer, Warren 2002): keeps sharp
                        ///< edges and corners of the field
  adaptive,             ///< the same on an octree: cells are merged where the surface is flat up to `tolerance`
};

/// marching-cubes, marching-tetrahedra, dual-contouring, adaptive.
std::string_view name_of(PolygonizeMethod method);
/// The method of that name, if any.
std::optional<PolygonizeMethod> polygonize_method_named(std::string_view name);

/// What polygonize did.
struct PolygonizeStatistics {
  Index cells = 0;            ///< cells crossed by the surface
  Index values = 0;           ///< points evaluated without gradient
  Index gradients = 0;        ///< points evaluated with gradient
  Index waves = 0;            ///< batches in which the surface was followed
  Index center_vertices = 0;  ///< vertices added inside cells or, by dual contouring, on their faces, to keep the mesh
                              ///< manifold
  Index weak_features = 0;    ///< bridges cut and holes filled
};

struct PolygonizeOptions {
  /// Cells along the longest side of the field's bounds (of `bounds` where the field has none), 1 ... 4096;
  /// 0 = automatic_resolution(field).
  int resolution = 0;
  PolygonizeMethod method = PolygonizeMethod::marching_cubes;
  /// Approximate bound of the distance between mesh and surface where the method `adaptive` merges cells, as a fraction
  /// of the diagonal of the field's bounds (of `bounds` where the field has none). Default (0): a tenth of a cell.
  double tolerance = 0;
  /// The surface f = level is extracted.
  double level = 0;
  /// Bridges are cut and holes filled where they are gone once the level moves by less than this (their persistence, in
  /// values of the field); 0 leaves all. Default: what the field says (Field::least_persistence). Only what the cells
  /// of the mesh show is found; there the mesh is not on the surface, but within about a cell.
  std::optional<double> persistence{};
  /// The solid is cut off at this box and closed by flat caps there. Each side is then divided into equal parts so that
  /// cells are as close to cubes as possible. Default (an empty box): the field's bounds plus at least four cells on
  /// every side, with exactly cubic cells.
  Box<3> bounds{};

  /// Where to start following the surface (Bloomenthal 1988), 3 x n; default: the field's seeds. A component is found
  /// if a seed, moved by at most three Newton steps of at most two cells along the gradient, lies within a cell of it.
  /// If the field has no seeds, or none leads to the surface, the whole box is scanned: every cell at up to 256 cells
  /// along its longest side, else steps of 1/266 of that side, which miss smaller components.
  Points<3> seeds{3, 0};

  /// Places vertices on the surface to about 1e-6 of a cell instead of O(cell^2).
  bool refine = true;

  /// Outward unit normals at the vertices, from the gradient of the field.
  bool normals = true;

  Progress progress{};                         ///< stage "polygonize"
  PolygonizeStatistics* statistics = nullptr;  ///< filled if not null
};

/// Cells along the longest side that resolve the field: cells as long as its feature size, between 32 and 1024
/// of them; 128 if the field does not know it.
int automatic_resolution(const Field<3>& field);

/// Triangle mesh of the surface f = level, closed, manifold and oriented by construction with every method. Surfaces
/// that share a cell stay separate or merge, but never touch in an edge or a vertex.
///
/// Corners with f >= level are inside. Features thinner than a cell may be lost; sharp edges are cut off by up to half
/// a cell, but by dual contouring and `adaptive` only where the solid is thinner than a cell. Follows the surface from
/// the seeds: time and memory are proportional to the number of crossed edges of cells, about two values and one
/// gradient for each (dual contouring: up to four), independent of the size of the box. Vertices and triangles are
/// numbered along a Morton curve; the mesh is bit-identical for any number of threads.
///
/// Throws InvalidInput for a resolution, method, tolerance, level, bounds or seeds outside the above; SolverFailure if
/// there is no zero crossing near any seed (or in the scan), if the field is not finite where it is evaluated (with the
/// position), and if there are more than 2^31 vertices (to merge: corners of triangles); Cancelled.
Mesh polygonize(const Field<3>& field, const PolygonizeOptions& options = {});

}  // namespace csrbf
