#pragma once

#include "csrbf/core/mesh.hpp"
#include "csrbf/core/progress.hpp"

namespace csrbf {

/// What the colour of a surface shows.
enum class RenderColor {
  plain,               ///< the material, or the vertex colours of a mesh (properties red, green, blue)
  normal,              ///< the outward normal as (n + 1) / 2 in red, green and blue, without light
  mean_curvature,      ///< blue - white - red for concave - flat - convex
  gaussian_curvature,  ///< blue - white - red for saddle - parabolic - elliptic
  error,               ///< distance to the mesh `reference`: dark blue (none) to yellow
};

/// How the triangles of a mesh are shaded.
enum class MeshShading {
  smooth,  ///< with the vertex normals of the mesh, or else normals averaged over edges flatter than 40 degrees
  flat,    ///< with the normals of the triangles
};

/// What the surface stands on.
enum class Ground {
  none,
  shadow,  ///< a plane below the lowest point, visible only where the surface casts a shadow
};

enum class UpAxis { x, y, z };

/// Red, green and blue in sRGB, each in [0, 1].
using Rgb = std::array<float, 3>;

struct RenderOptions {
  int width = 800;   ///< pixels, at most 32768
  int height = 600;  ///< pixels, at most 32768

  std::array<double, 2> view{30, 20};  ///< where the camera stands, degrees: azimuth about the up axis (about z from x
                                       ///< towards y), elevation from the horizontal plane upwards, in [-90, 90]
  UpAxis up = UpAxis::z;
  double field_of_view = 20;  ///< degrees across the shorter side of the picture, in [0, 150]; 0 = orthographic
  double margin = 0.06;       ///< empty border on each side, fraction of the picture, in [0, 0.5)
  Box<3> frame = {};          ///< what the camera frames; empty: the surface

  RenderColor color = RenderColor::plain;
  const Mesh* reference = nullptr;  ///< for RenderColor::error
  double color_limit = 0;  ///< value at the ends of the colour scale, in units of the diagonal D of the surface's box:
                           ///< mean curvature times D, Gaussian curvature times D^2, error / (diagonal of the
                           ///< reference); 0 = chosen so that 95 % of the visible surface lies within (error: 99 %)
  Rgb material{0.80F, 0.76F, 0.71F};
  Rgb background{1, 1, 1};
  MeshShading shading = MeshShading::smooth;
  Ground ground = Ground::shadow;

  int samples = 2;             ///< antialiasing: samples x samples rays per pixel, in [1, 8]
  int occlusion_rays = 16;     ///< rays per pixel for ambient occlusion and soft shadows, in [0, 1024]; 0 = none
  int field_resolution = 256;  ///< cells along the longest side of a field's bounds, in [4, 1024]: see render(field)

  Progress progress = {};  ///< stage "render"
};

}  // namespace csrbf
