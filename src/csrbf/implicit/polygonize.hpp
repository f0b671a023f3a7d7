#pragma once

#include "csrbf/core/field.hpp"
#include "csrbf/core/mesh.hpp"
#include "csrbf/core/progress.hpp"

#include <optional>

namespace csrbf {

/// How cells become triangles.
enum class PolygonizeMethod {
  marching_cubes,  ///< vertices on the edges of cells; how a face of a cell is cut depends on its four corner values
                   ///< only (asymptotic decider, Nielson and Hamann 1991)
  marching_tetrahedra,  ///< vertices on the edges and diagonals of cells, divided into six tetrahedra each: no
                        ///< ambiguous cases, about three times the triangles, and thinner ones (Doi and Koide 1991)
  dual_contouring,  ///< one vertex in a cell for each piece of surface in it (Nielson 2004), where the tangent planes
                    ///< at the crossings of its edges meet (Ju, Losasso, Schaefer, Warren 2002): keeps sharp edges and
                    ///< corners
  adaptive,         ///< dual contouring on an octree: cells are merged where the surface is flat up to `tolerance`
};

/// marching-cubes, marching-tetrahedra, dual-contouring, adaptive.
std::string_view name_of(PolygonizeMethod method);
/// The method with this name, if there is one.
std::optional<PolygonizeMethod> polygonize_method_named(std::string_view name);

/// What polygonize() did.
struct PolygonizeStatistics {
  Index cells = 0;            ///< cells crossed by the surface
  Index values = 0;           ///< points evaluated without gradient
  Index gradients = 0;        ///< points evaluated with gradient
  Index waves = 0;            ///< batches in which the surface was followed
  Index center_vertices = 0;  ///< added inside cells (dual contouring: on faces) to keep the mesh manifold
  Index weak_features = 0;    ///< bridges cut and holes filled, see PolygonizeOptions::persistence
};

struct PolygonizeOptions {
  /// Cells along the longest side of the bounds of the field, or of `bounds` if the field has none; 1 to 4096. 0:
  /// automatic_resolution(field).
  int resolution = 0;
  PolygonizeMethod method = PolygonizeMethod::marching_cubes;
  /// For the method `adaptive`: approximate bound of the distance between mesh and surface where cells are merged, as a
  /// fraction of the diagonal of the bounds of the field, or of `bounds` if the field has none. 0: a tenth of a cell.
  double tolerance = 0;
  /// The surface f = level is extracted.
  double level = 0;
  /// Bridges are cut and holes filled if they vanish when the level moves by less than this: their persistence, in the
  /// unit of the field. 0: none. Unset: Field::least_persistence(). Only what the cells show is found; where a bridge
  /// was cut or a hole filled, the mesh lies within about a cell of the surface, not on it.
  std::optional<double> persistence{};
  /// The solid is cut off at this box and closed by flat caps. Each side is divided into equal parts, so that cells are
  /// nearly cubes. Default (an empty box): the bounds of the field plus at least four cells on every side, with cubic
  /// cells.
  Box<3> bounds{};

  /// Points from which to follow the surface (Bloomenthal 1988), 3 x n; default: the seeds of the field. A component is
  /// found if a seed lies within a cell of it after at most three Newton steps along the gradient, of at most two cells
  /// each. If there are no seeds, or none leads to the surface, the whole box is scanned: every cell up to 256 cells
  /// along its longest side, else in steps of 1/266 of that side, which miss smaller components.
  Points<3> seeds{3, 0};

  /// Whether to place vertices on the surface to about 1e-6 of a cell, instead of O(cell^2).
  bool refine = true;

  /// Whether the mesh gets outward unit normals, from the gradient of the field.
  bool normals = true;

  Progress progress{};                         ///< stage "polygonize"
  PolygonizeStatistics* statistics = nullptr;  ///< filled if not null
};

/// Number of cells along the longest side that resolves the field: cells as long as its feature size, but 32 to 1024 of
/// them; 128 if the feature size is unknown.
int automatic_resolution(const Field<3>& field);

/// Makes a triangle mesh of the surface f = level. With every method it is closed, manifold and oriented by
/// construction. Pieces of surface that share a cell stay separate or merge, but never touch in an edge or a vertex.
///
/// Points with f >= level are inside. Features thinner than a cell may be lost. Marching cubes and tetrahedra cut sharp
/// edges off by up to half a cell; dual contouring and `adaptive` do so only where the solid is thinner than a cell.
/// The surface is followed from the seeds: time and memory are proportional to the number of cell edges that it
/// crosses, whatever the size of the box, with about two values and one gradient for each (dual contouring: up to
/// four). Vertices and triangles are numbered along a Morton curve; the mesh is the same, bit for bit, for any number
/// of threads.
///
/// Throws InvalidInput for options out of range; SolverFailure if there is no zero crossing near any seed or in the
/// scan, if the field is not finite where it is evaluated (with the position), and for more than 2^31 vertices (with
/// `adaptive`: corners of triangles); Cancelled.
Mesh polygonize(const Field<3>& field, const PolygonizeOptions& options = {});

}  // namespace csrbf
