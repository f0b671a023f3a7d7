#include "csrbf/implicit/polygonize.hpp"

#include "csrbf/implicit/polygonize/start_cells.hpp"
#include "csrbf/implicit/polygonize_part.hpp"

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

void add_neighbours(const CellRange& range, const Cell& cell, CellTracer& tracer) {
  for (int k = 0; k < 27; ++k) {
    const Cell neighbour = cell + Cell(k % 3, k / 3 % 3, k / 9) - 1;
    if (range.contains(neighbour)) tracer.add(neighbour);
  }
}

// Starts and their neighbours must be in the range.
void trace_from(const CellRange& range, const std::vector<Cell>& starts, CellTracer& tracer, const Progress& progress) {
  for (const Cell& cell : starts) tracer.add(cell);
  tracer.run(progress);
  for (const Cell& cell : starts)
    if (!tracer.active(cell)) add_neighbours(range, cell, tracer);
  tracer.run(progress);
}

// From the seeds; if there are none, or the field's own do not lead to the surface, from all crossings of a coarse
// scan.
void trace(const Field<3>& field, const CellLattice& lattice, LevelSampler& sampler, CellTracer& tracer,
           const PolygonizeOptions& options) {
  const bool given = options.seeds.cols() > 0;
  const Points<3> seeds = given ? options.seeds : field.seeds();
  require(seeds.allFinite(), "polygonize", "field.seeds()", "(not finite)", "every seed must be finite");
  const CellRange all{Cell::Zero(), lattice.cells};
  if (seeds.cols() > 0) trace_from(all, cells_near_seeds(lattice, sampler, seeds), tracer, options.progress);
  if (tracer.active_cells() == 0 && !given)
    trace_from(all, cells_by_scan(lattice, sampler, options.progress), tracer, options.progress);
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

// Inner cells fill the bounds; another layer on every side holds the caps.
CellLattice polygonize_lattice(const Field<3>& field, const PolygonizeOptions& options) {
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

Mesh polygonize(const Field<3>& field, const PolygonizeOptions& options) {
  validate(options);
  const CellLattice lattice = polygonize_lattice(field, options);
  report(options.progress, "polygonize", 0.0);

  LevelSampler sampler(field, options.level);
  CellTracer tracer(lattice, sampler);
  trace(field, lattice, sampler, tracer, options);
  const double tolerance = options.tolerance > 0 ? options.tolerance * measured_box(field, options).diagonal()
                                                 : default_tolerance * lattice.spacing.minCoeff();
  Mesh mesh;
  const Index center_vertices = extract({lattice, sampler, tracer, options, tolerance}, mesh);
  if (options.statistics != nullptr)
    *options.statistics = {tracer.active_cells(), sampler.value_count(), sampler.gradient_count(), tracer.waves(),
                           center_vertices};
  report(options.progress, "polygonize", 1.0);
  return mesh;
}

MeshPart polygonize_part(const Field<3>& field, const CellLattice& lattice, const CellRange& range,
                         const std::vector<Cell>& starts, const PolygonizeOptions& options) {
  validate(options);
  const bool cubes = options.method == PolygonizeMethod::marching_cubes;
  require(cubes || options.method == PolygonizeMethod::dual_contouring, "polygonize_part", "method",
          name_of(options.method), "must be marching-cubes or dual-contouring");
  report(options.progress, "polygonize", 0.0);
  // The quads of dual contouring reach into the cells below.
  const CellRange visited{cubes ? range.first : Cell((range.first - 1).max(0)), range.last};
  LevelSampler sampler(field, options.level);
  CellTracer tracer(lattice, visited, sampler);
  std::vector<Cell> from;
  for (const Cell& cell : cells_near_seeds(lattice, sampler, field.seeds()))
    if (range.contains(cell)) from.push_back(cell);
  from.insert(from.end(), starts.begin(), starts.end());
  trace_from(visited, from, tracer, options.progress);

  MeshPart part;
  const CellRange around{range.first - 1, range.last + 1};
  for (const Cell& cell : tracer.beyond())
    if (around.contains(cell)) part.beyond.push_back(cell);
  tracer.for_each_active([&](const Cell& cell) {
    if (!range.contains(cell))
      part.beyond.push_back(cell);
    else if ((cell == range.first).any() || (cell == range.last - 1).any())
      part.border.push_back(cell);
  });
  if (tracer.active_cells() > 0) part.shared = extract_part({lattice, sampler, tracer, options, 0}, range, part.mesh);
  report(options.progress, "polygonize", 1.0);
  return part;
}

}  // namespace csrbf
