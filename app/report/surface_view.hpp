#pragma once

#include "report/page.hpp"

#include "csrbf/core/field.hpp"
#include "csrbf/core/mesh.hpp"

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace csrbf::app {

/// A quantity that colours a surface and the points on it; NaN: no value there.
struct SurfaceColors {
  std::string name;                   ///< in the list of colours
  std::string title;                  ///< of the colour scale, with the unit
  double lo = 0, hi = 1;              ///< values at the ends of the scale
  bool diverging = false;             ///< else sequential
  Eigen::VectorXd values;             ///< one for each vertex
  Eigen::VectorXd point_values = {};  ///< one for each point, or none
};

/// Values of a function on a grid over the box of a surface, which colour what a cut lays open.
struct InsideValues {
  std::array<Index, 3> size{0, 0, 0};
  Eigen::VectorXd values = {};  ///< x fastest
  double lo = 0, hi = 1;        ///< of the scale
  double largest = 1;           ///< that is told; not less than hi
  std::string title = {};
};

/// A surface to rotate and cut.
struct SurfaceView {
  std::string title = "The surface";
  Mesh mesh = {};  ///< with normals; at most `most_vertices`
  Points<3> points{3, 0};
  Polylines lines = {};  ///< at most 65536 vertices
  std::vector<SurfaceColors> colors;
  std::optional<InsideValues> inside = {};
  std::string caption;
  std::string shown = "plain";  ///< or the number of the colours shown first
  std::string up;               ///< axis that points upwards; empty: guessed from the shape
  std::string unit;             ///< of lengths, where it is known
  std::array<std::string, 3> axes{"x", "y", "z"};
  std::optional<Box<3>> ranges = {};  ///< of the axes, where these are not those of the vertices

  static constexpr Index most_vertices = 65536;  ///< 16-bit indices
  static constexpr Index most_points = 40000;    ///< 6 bytes each in the page; more hide the surface
};

/// Does the program contain the interactive viewer, or only still pictures?
bool has_interactive_view();

/// A mesh of at most SurfaceView::most_vertices, with normals: `mesh` itself, or one whose vertices are the means of
/// those in cubes of a grid, and whose triangles the ones that are left. Good enough to be looked at, and quick. O(v
/// log v).
Mesh mesh_to_show(const Mesh& mesh);

/// "Shown with 20,000 triangles; the file has 80,000." Empty when they are as many.
std::string reduction_note(const Mesh& shown, const Mesh& mesh);

/// Values of a field over the box of a mesh, for what a cut lays open: positive inside.
InsideValues inside_values(const Field<3>& field, const Mesh& mesh, const std::string& title);

/// At most `most` indices, evenly spaced among n.
std::vector<Index> spread_indices(Index n, Index most);

/// At most `most` of the indices, evenly spaced.
std::vector<Index> spread(const std::vector<Index>& indices, Index most);

/// Values known at points (3 x n), transferred to other places (3 x m): the mean over the nearest few; NaN where the
/// points are much further away than their own spacing.
Eigen::VectorXd values_near(const PointsRef<3>& points, const Eigen::VectorXd& values, const PointsRef<3>& places);

/// The view as a figure: a ray-traced picture, and the data with which the script replaces it.
Figure surface_figure(const SurfaceView& view);

}  // namespace csrbf::app
