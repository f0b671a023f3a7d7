#pragma once

#include "report/page.hpp"

#include "csrbf/core/mesh.hpp"

#include <functional>
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

/// A surface to rotate and cut.
struct SurfaceView {
  Mesh mesh = {};  ///< with normals; at most `most_vertices`
  Points<3> points{3, 0};
  std::vector<SurfaceColors> colors;
  std::string caption;
  std::string shown = "plain";  ///< or the number of the colours shown first

  static constexpr Index most_vertices = 65536;  ///< 16-bit indices
  static constexpr Index most_points = 40000;    ///< 6 bytes each in the page; more hide the surface
};

/// Does the program contain the interactive viewer, or only still pictures?
bool has_interactive_view();

/// A mesh of at most SurfaceView::most_vertices: `mesh` itself, whose resolution is `resolution`, or `coarser` of a
/// lower one.
Mesh mesh_to_show(const Mesh& mesh, int resolution, const std::function<Mesh(int)>& coarser);

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
