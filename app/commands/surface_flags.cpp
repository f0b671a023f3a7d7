#include "commands/command_flags.hpp"
#include "commands/formats.hpp"

#include "csrbf/surface/surface_method.hpp"

namespace csrbf::app {
namespace {

std::string points_or_input() {
  return std::string(read_point_formats) + ", or - for text on standard input";
}

}  // namespace

void declare(CommandFlags& v, ReconstructCommand& c) {
  v.argument("POINTS", c.input,
             "points to read: " + points_or_input() +
                 "; of a mesh its vertices, or points on its faces where these tell more; or contours drawn on slices: "
                 "text with columns x, y, z and contour (a number for each closed "
                 "curve), or .obj or .ply with lines and no faces");
  v.output(c.output, std::string("mesh to write: ") + written_mesh_formats);
  std::string methods =
      "auto: contours for files that hold contours, else composite; composite: partition of unity with an RBF "
      "residual; contours: triharmonic spline through closed curves on two or more planes";
  std::vector<std::string> names{"auto", "composite", "contours"};
  for (const SurfaceMethod& method : surface_methods()) {
    methods += std::string("; ") + method.name + ": " + method.what;
    names.emplace_back(method.name);
  }
  v.named_flag("method", c.method, names, "auto", methods);
  v.flag("normals", c.normals, "auto|file|estimate", "auto",
         "auto: those of the file if it has any, corrected where they have errors, and turned outwards where they "
         "contradict each other or point inward; file: as they are; estimate: always estimated")
      ->check(CLI::IsMember({"auto", "file", "estimate"}));
  v.positive_flag("centers", c.centers, "N", "from the data", "budget of RBF centres");
  v.positive_flag(
      "tolerance", c.tolerance, "E", "none",
      "largest distance from an input point to the surface, as a fraction of the bounding-box diagonal, outliers "
      "aside; for the method composite");
  v.flag("smoothing", c.smoothing, "auto|none|L", "auto", "how much noise to smooth away; larger is smoother");
  v.flag("resolution", c.resolution, "N", "from the sampling", "cells of the mesh along the longest side")
      ->check(CLI::Range(1, 4096));
  v.flag("sharp", c.sharp, "auto|on|off", "auto",
         "on: vertices on sharp edges and corners, by dual contouring; off: edges cut off, by marching cubes; auto: on "
         "for the method composite, unless the points are noisy")
      ->check(CLI::IsMember({"auto", "on", "off"}));
  v.flag("trim", c.trim, "T", "none",
         "drop surface further than T local point spacings from the data; none: watertight");
  v.flag("model", c.model, "FILE", "", "save the implicit surface: .csrbf");
  add_point_flags(v, c.points);
  add_tile_flags(v, c.tiles);
}

void declare(CommandFlags& v, EstimateNormalsCommand& c) {
  v.argument("POINTS", c.input, "points to read: " + points_or_input());
  v.output(c.output, "points to write with their normals: the same formats");
  v.flag("neighbors", c.neighbors, "K", "from the points", "points that each normal is estimated from")
      ->check(CLI::Range(3, 1000));
  v.flag("orient", c.orient, "HOW", "consistent",
         "consistent: outwards, in agreement with their neighbours; viewpoint X,Y,Z: towards the scanner; none: either "
         "way");
  add_point_flags(v, c.points);
}

void declare(CommandFlags& v, PolygonizeCommand& c) {
  v.argument("MODEL", c.input, "model to read: .csrbf");
  v.output(c.output, std::string("mesh to write: ") + written_mesh_formats);
  v.flag("resolution", c.resolution, "N", "from the model", "cells along the longest side")->check(CLI::Range(1, 4096));
  v.flag("method", c.method, "NAME", c.method,
         "auto: dual-contouring for surfaces from points without noise, else marching-cubes; marching-cubes; "
         "marching-tetrahedra; dual-contouring: preserves sharp edges of the model; adaptive: the same with larger "
         "triangles where the surface is flat")
      ->check(CLI::IsMember({"auto", "marching-cubes", "marching-tetrahedra", "dual-contouring", "adaptive"}));
  v.positive_flag("tolerance", c.tolerance, "E", "a tenth of a cell",
                  "adaptive: about how far the mesh may be from the surface, as a fraction of the diagonal");
  v.flag("level", c.level, "V", "0", "value of the model on the surface; larger values are inside");
  v.flag("persistence", c.persistence, "V", "from the model",
         "bridges are cut and holes filled that are gone once the level moves by less than this; 0: none");
  v.toggle("--refine,!--no-refine", c.refine, "move the vertices onto the surface (this is the default)");
}

void declare(CommandFlags& v, RenderCommand& c) {
  v.argument("INPUT", c.input, std::string("model (.csrbf) or mesh to read: ") + mesh_formats);
  v.output(c.output, "picture to write: .png");
  v.flag("size", c.size, "WxH", c.size, "size in pixels");
  v.flag("view", c.view, "AZIMUTH,ELEVATION", c.view, "direction to look from, degrees: about +z from +x, then up");
  v.flag("up", c.up, "x|y|z", c.up, "axis that points up")->check(CLI::IsMember({"x", "y", "z"}));
  v.flag("color", c.color, "NAME", "plain",
         "plain, normal, mean-curvature, gaussian-curvature, or error:REFERENCE (a mesh)");
}

void declare(CommandFlags& v, CurvatureCommand& c) {
  v.argument("MODEL", c.input, "model to read: .csrbf");
  v.output(
      c.output,
      "mesh to write, .ply or .vtp: vertices with normal (nx ny nz), principal curvatures (k1 >= k2, positive "
      "where the solid is convex), their directions (d1x d1y d1z d2x d2y d2z), mean_curvature and gaussian_curvature");
  v.flag("resolution", c.resolution, "N", "from the model", "cells along the longest side")->check(CLI::Range(1, 4096));
  v.flag("ridges", c.ridges, "FILE", "",
         "write ridge and valley lines, .ply or .vtp: vertices with the curvature across the line and kind, 1 ridge, "
         "-1 valley; edges");
}

void declare(CommandFlags& v, CombineCommand& c) {
  v.argument(
       "OP", c.operation,
       "union; intersection; difference: the first model minus the others; complement: the outside of a single model; "
       "blend: union with rounded edges")
      ->check(CLI::IsMember({"union", "intersection", "difference", "complement", "blend"}));
  v.argument("MODELS", c.inputs, "models to read: .csrbf");
  v.output(c.output, "model to write: .csrbf");
  v.positive_flag(
      "radius", c.radius, "R", "blend: 0.05, else none",
      "range of the blend: surfaces further apart keep their shape; as a fraction of the diagonal of the box of all "
      "models");
  v.flag("sharpness", c.sharpness, "B", "3", "how closely the blend follows the edge, 1 (a chamfer) or more")
      ->check(CLI::Range(1.0, 1e6));
  v.flag("blending", c.blending, "NAME", "super-elliptic with a radius, else sharp",
         "sharp: edges; r-function: the same edges, smooth elsewhere; super-elliptic: rounds edges within the radius; "
         "log-sum-exp: rounds edges, and swells a little everywhere")
      ->check(CLI::IsMember({"sharp", "r-function", "super-elliptic", "log-sum-exp"}));
}

void declare(CommandFlags& v, CompareCommand& c) {
  v.argument("A", c.first, std::string("mesh: ") + mesh_formats + "; or label image: " + image_formats);
  v.argument("B", c.second,
             std::string("reference: a mesh, or points, of which only the distances to the mesh are measured: ") +
                 points_or_input() + "; for a label image, another one");
}

void declare(CommandFlags& v, InfoCommand& c) {
  v.argument("FILE", c.input, "points, image, mesh or model");
}

}  // namespace csrbf::app
