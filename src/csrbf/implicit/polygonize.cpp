#include "csrbf/implicit/polygonize.hpp"

#include "csrbf/implicit/polygonize/cell_tetrahedra.hpp"
#include "csrbf/implicit/polygonize/cell_tracer.hpp"
#include "csrbf/implicit/polygonize/cell_triangles.hpp"
#include "csrbf/implicit/polygonize/center_vertices.hpp"
#include "csrbf/implicit/polygonize/dual_triangles.hpp"
#include "csrbf/implicit/polygonize/edge_collapse.hpp"
#include "csrbf/implicit/polygonize/edge_vertices.hpp"
#include "csrbf/implicit/polygonize/merge_cells.hpp"
#include "csrbf/implicit/polygonize/start_cells.hpp"

#include <Eigen/Geometry>

namespace csrbf {
namespace {

using namespace polygonization;

constexpr int largest_resolution = 4096;  // cells along the longest side: bounds memory
// Chosen by hand.
constexpr int default_margin = 4;  // cells around the field's bounds, which may be those of samples beside the surface
constexpr double rounding = 1e-9;  // cells: a side that exceeds a whole number of cells by less is not enlarged
constexpr double default_tolerance = 0.1;  // of a cell; larger: fewer triangles

constexpr std::array<std::string_view, 4> method_names{"marching-cubes", "marching-tetrahedra", "dual-contouring",
                                                       "adaptive"};

bool usable(const Box<3>& box) {
  return !box.empty() && box.extent().allFinite() && box.extent().maxCoeff() > 0;
}

bool is_default(const Box<3>& box) {
  const Box<3> none;
  return box.lo == none.lo && box.hi == none.hi;
}

void validate(const PolygonizeOptions& options) {
  require(options.resolution >= 0 && options.resolution <= largest_resolution, "polygonize", "resolution",
          options.resolution, "must be between 1 and 4096 cells along the longest side, or 0 for automatic");
  require(static_cast<std::size_t>(options.method) < method_names.size(), "polygonize", "method",
          static_cast<int>(options.method), "must be one of PolygonizeMethod");
  require(options.tolerance >= 0 && std::isfinite(options.tolerance), "polygonize", "tolerance", options.tolerance,
          "must be a fraction of the diagonal above 0, or 0 for a tenth of a cell");
  require(std::isfinite(options.level), "polygonize", "level", options.level, "must be finite");
  require(options.seeds.allFinite(), "polygonize", "seeds", "(not finite)", "every seed must be finite");
  const bool has_volume = usable(options.bounds) && options.bounds.extent().minCoeff() > 0;
  require(is_default(options.bounds) || has_volume, "polygonize", "bounds",
          options.bounds.extent().transpose().format(Eigen::IOFormat(Eigen::StreamPrecision, 0, " x ")),
          "must have positive, finite extent along every axis; leave them out for those of the field");
}

// The box that resolution and tolerance refer to.
Box<3> measured_box(const Field<3>& field, const PolygonizeOptions& options) {
  const Box<3> natural = field.bounds();
  return usable(natural) ? natural : options.bounds;
}

// Inner cells fill the bounds; another layer on every side holds the caps.
CellLattice make_lattice(const Field<3>& field, const PolygonizeOptions& options) {
  const Box<3> natural = field.bounds();
  const bool own_bounds = is_default(options.bounds);
  require(usable(natural) || !own_bounds, "polygonize", "field.bounds()", natural.diagonal(),
          "must be finite and not empty; give bounds in the options");
  const int resolution = options.resolution > 0 ? options.resolution : automatic_resolution(field);
  const double size = measured_box(field, options).extent().maxCoeff() / resolution;
  const Eigen::Array3d cells = (own_bounds ? natural : options.bounds).extent().array() / size;
  require(cells.maxCoeff() < max_cells - 10, "polygonize", "bounds / cell size", cells.maxCoeff(),
          "must be below 2^20 cells; shrink the bounds or lower the resolution");

  CellLattice lattice;
  if (own_bounds) {
    lattice.cells = (cells - rounding).ceil().cast<int>() + 2 * default_margin + 2;
    lattice.spacing.setConstant(size);
    lattice.origin = natural.center() - 0.5 * size * lattice.cells.matrix().cast<double>();
  } else {
    const Cell inner = cells.round().cast<int>().max(1);
    lattice.cells = inner + 2;
    lattice.spacing = options.bounds.extent().array() / inner.cast<double>();
    lattice.origin = options.bounds.lo - lattice.spacing;
  }
  return lattice;
}

void add_neighbours(const CellLattice& lattice, const Cell& cell, CellTracer& tracer) {
  for (int k = 0; k < 27; ++k) {
    const Cell neighbour = cell + Cell(k % 3, k / 3 % 3, k / 9) - 1;
    if ((neighbour >= 0).all() && (neighbour < lattice.cells).all()) tracer.add(neighbour);
  }
}

void trace_from(const CellLattice& lattice, const std::vector<Cell>& starts, CellTracer& tracer,
                const Progress& progress) {
  for (const Cell& cell : starts) tracer.add(cell);
  tracer.run(progress);
  for (const Cell& cell : starts)
    if (!tracer.active(cell)) add_neighbours(lattice, cell, tracer);
  tracer.run(progress);
}

// From the seeds; if there are none, or the field's own do not lead to the surface, from all crossings of a coarse
// scan.
void trace(const Field<3>& field, const CellLattice& lattice, LevelSampler& sampler, CellTracer& tracer,
           const PolygonizeOptions& options) {
  const bool given = options.seeds.cols() > 0;
  const Points<3> seeds = given ? options.seeds : field.seeds();
  require(seeds.allFinite(), "polygonize", "field.seeds()", "(not finite)", "every seed must be finite");
  if (seeds.cols() > 0) trace_from(lattice, cells_near_seeds(lattice, sampler, seeds), tracer, options.progress);
  if (tracer.active_cells() == 0 && !given)
    trace_from(lattice, cells_by_scan(lattice, sampler, options.progress), tracer, options.progress);
  if (tracer.active_cells() > 0) return;
  constexpr int coarse = 16;  // cells; fewer may miss surfaces that are not thin. Chosen by hand
  std::ostringstream message;
  message << "polygonize: no zero crossing of f - level, level = " << options.level << ", ";
  given ? message << "near any of " << seeds.cols() << " seeds" : message << "in the scanned box";
  if (options.resolution > 0 && options.resolution < coarse)
    message << "; resolution = " << options.resolution << " is too coarse to find a surface; raise it";
  else
    message << "; check the level, the bounds and the seeds, or raise the resolution";
  throw SolverFailure(message.str());
}

// Normals where the gradient is undefined: the mean of the surrounding triangles.
void complete_normals(Mesh& mesh) {
  const Eigen::Array<bool, 1, Eigen::Dynamic> missing = (mesh.normals.array() == 0).colwise().all();
  if (!missing.any()) return;
  for (Index t = 0; t < mesh.triangles.cols(); ++t) {
    const Eigen::Vector3i v = mesh.triangles.col(t);
    if (!missing[v[0]] && !missing[v[1]] && !missing[v[2]]) continue;
    const Point<3> origin = mesh.vertices.col(v[0]);
    const Point<3> area = (mesh.vertices.col(v[1]) - origin).cross(mesh.vertices.col(v[2]) - origin);
    for (int i = 0; i < 3; ++i)
      if (missing[v[i]]) mesh.normals.col(v[i]) += area;
  }
  for (Index i = 0; i < mesh.normals.cols(); ++i)
    if (missing[i]) mesh.normals.col(i).stableNormalize();
}

void resize_vertices(Index n, bool normals, Mesh& mesh) {
  if (n > std::numeric_limits<std::int32_t>::max())
    throw SolverFailure("polygonize: more than 2^31 vertices; lower the resolution");
  mesh.vertices.resize(3, n);
  if (normals) mesh.normals.resize(3, n);
}

// Input of the methods, which return the number of vertices that are not on edges.
struct Extraction {
  const CellLattice& lattice;
  LevelSampler& sampler;
  CellTracer& tracer;
  const PolygonizeOptions& options;
  double tolerance;  // a length
};

Index marching_cubes(const Extraction& e, Mesh& mesh) {
  const std::vector<Brick*> bricks = e.tracer.finish(axis_directions);
  const Index edge_vertices = number_edge_vertices(bricks);
  const TriangleOffsets offsets = count_triangles(bricks);
  resize_vertices(edge_vertices + offsets.centers.back(), e.options.normals, mesh);
  mesh.triangles.resize(3, offsets.triangles.back());
  place_edge_vertices(e.lattice, bricks, e.sampler, {e.options.refine, e.options.normals}, mesh, e.options.progress);
  report(e.options.progress, "polygonize", 0.95);
  fill_triangles(bricks, offsets, edge_vertices, mesh);
  mesh.normals.rightCols(e.options.normals ? offsets.centers.back() : 0).setZero();
  place_center_vertices(e.lattice, e.sampler, edge_vertices, e.options.refine, mesh);
  return offsets.centers.back();
}

Index marching_tetrahedra(const Extraction& e, Mesh& mesh) {
  const std::vector<Brick*> bricks = e.tracer.finish(all_directions);
  resize_vertices(number_edge_vertices(bricks), e.options.normals, mesh);
  place_edge_vertices(e.lattice, bricks, e.sampler, {e.options.refine, e.options.normals}, mesh, e.options.progress);
  report(e.options.progress, "polygonize", 0.95);
  march_tetrahedra(bricks, mesh);
  return 0;
}

// Also of an octree: the method `adaptive`.
Index dual_contouring(const Extraction& e, Mesh& mesh) {
  const bool adaptive = e.options.method == PolygonizeMethod::adaptive;
  const std::vector<Brick*> bricks = e.tracer.finish(axis_directions);
  Mesh crossings;
  resize_vertices(number_edge_vertices(bricks), true, crossings);
  place_edge_vertices(e.lattice, bricks, e.sampler, {.refine = e.options.refine}, crossings, e.options.progress);
  report(e.options.progress, "polygonize", 0.95);
  std::vector<CellPlanes> planes;
  const DualSurface surface = make_dual_surface(e.lattice, bricks, crossings, mesh, adaptive ? &planes : nullptr);
  const Index side_vertices = mesh.vertices.cols() - surface.loop_vertices;
  unfold_quads(surface, crossings, mesh);
  if (!e.options.normals) mesh.normals.resize(3, 0);
  if (adaptive) {
    triangulate_quads(surface, crossings, mesh);
    merge_cells(e.lattice, e.tolerance, std::move(planes), mesh, e.options.progress);
    place_center_vertices(e.lattice, e.sampler, 0, e.options.refine, mesh);
  } else {
    place_center_vertices(e.lattice, e.sampler, 0, e.options.refine, mesh);
    triangulate_quads(surface, crossings, mesh);
  }
  collapse_short_edges(edge_margin * e.lattice.spacing.minCoeff(), mesh);
  return side_vertices;
}

}  // namespace

std::string_view name_of(PolygonizeMethod method) {
  return method_names[static_cast<std::size_t>(method)];
}

std::optional<PolygonizeMethod> polygonize_method_named(std::string_view name) {
  const auto found = std::find(method_names.begin(), method_names.end(), name);
  if (found == method_names.end()) return std::nullopt;
  return static_cast<PolygonizeMethod>(found - method_names.begin());
}

int automatic_resolution(const Field<3>& field) {
  constexpr double fewest = 32, most = 1024;  // enough for any shape, at most a few seconds; chosen by hand
  constexpr int unknown = 128;                // a compromise
  const double cells = field.bounds().extent().maxCoeff() / field.feature_size();
  return std::isfinite(cells) && cells > 0 ? static_cast<int>(std::clamp(std::ceil(cells), fewest, most)) : unknown;
}

Mesh polygonize(const Field<3>& field, const PolygonizeOptions& options) {
  validate(options);
  const CellLattice lattice = make_lattice(field, options);
  report(options.progress, "polygonize", 0.0);

  LevelSampler sampler(field, options.level);
  CellTracer tracer(lattice, sampler);
  trace(field, lattice, sampler, tracer, options);
  Mesh mesh;
  constexpr std::array extract{marching_cubes, marching_tetrahedra, dual_contouring, dual_contouring};
  const double tolerance = options.tolerance > 0 ? options.tolerance * measured_box(field, options).diagonal()
                                                 : default_tolerance * lattice.spacing.minCoeff();
  const Index center_vertices =
      extract[static_cast<std::size_t>(options.method)]({lattice, sampler, tracer, options, tolerance}, mesh);
  if (options.normals) complete_normals(mesh);

  if (options.statistics != nullptr)
    *options.statistics = {tracer.active_cells(), sampler.value_count(), sampler.gradient_count(), tracer.waves(),
                           center_vertices};
  report(options.progress, "polygonize", 1.0);
  return mesh;
}

}  // namespace csrbf
