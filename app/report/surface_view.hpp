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

/// A surface to turn and cut.
struct SurfaceView {
  Mesh mesh = {};  ///< with normals; at most `most_vertices`
  Points<3> points{3, 0};
  std::vector<SurfaceColors> colors;
  std::string caption;
  std::string shown = "plain";  ///< or the number of the colours that come first

  static constexpr Index most_vertices = 65536;  ///< what 16 bits count
  static constexpr Index most_points = 40000;
};

/// Does the program hold the script that turns surfaces, or only still pictures?
bool has_interactive_view();

/// A mesh of at most SurfaceView::most_vertices: `mesh` itself, or what `coarser` makes of a resolution below
/// `resolution`, which `mesh` has.
Mesh mesh_to_show(const Mesh& mesh, int resolution, const std::function<Mesh(int)>& coarser);

/// At most `most` indices, evenly spaced among n.
std::vector<Index> spread_indices(Index n, Index most);

/// The view as a figure: a picture by ray tracing, and all that the script needs to take its place.
Figure surface_figure(const SurfaceView& view);

}  // namespace csrbf::app
