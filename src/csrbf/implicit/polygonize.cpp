#include "csrbf/implicit/polygonize.hpp"

#include "csrbf/implicit/polygonize/extraction.hpp"
#include "csrbf/implicit/polygonize/start_cells.hpp"

namespace csrbf {
namespace {

using namespace polygonization;

constexpr int largest_resolution = 4096;  // cells along the longest side: bounds memory
// Chosen by hand.
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
  require(!options.persistence || (*options.persistence >= 0 && std::isfinite(*options.persistence)), "polygonize",
          "persistence", options.persistence.value_or(0), "must be a value of the field of at least 0");
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

// From the seeds; if there are none, or the field's own do not lead to the surface, from all crossings of a coarse
// scan.
void trace(const Field<3>& field, const CellLattice& lattice, LevelSampler& sampler, CellTracer& tracer,
           const PolygonizeOptions& options) {
  const bool given = options.seeds.cols() > 0;
  const Points<3> seeds = given ? options.seeds : field.seeds();
  require(seeds.allFinite(), "polygonize", "field.seeds()", "(not finite)", "every seed must be finite");
  if (seeds.cols() > 0) tracer.run_from(cells_near_seeds(lattice, sampler, seeds), options.progress);
  if (tracer.active_cells() == 0 && !given)
    tracer.run_from(cells_by_scan(lattice, sampler, options.progress), options.progress);
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

Mesh polygonize(const Field<3>& field, const PolygonizeOptions& options) {
  validate(options);
  const Box<3> natural = field.bounds();
  require(usable(natural) || !is_default(options.bounds), "polygonize", "field.bounds()", natural.diagonal(),
          "must be finite and not empty; give bounds in the options");
  const int resolution = options.resolution > 0 ? options.resolution : automatic_resolution(field);
  const double size = measured_box(field, options).extent().maxCoeff() / resolution;
  const CellLattice lattice =
      is_default(options.bounds) ? lattice_around(natural, size) : lattice_in(options.bounds, size);
  report(options.progress, "polygonize", 0.0);

  LevelSampler sampler(field, options.level);
  CellTracer tracer(lattice, sampler);
  trace(field, lattice, sampler, tracer, options);
  const double persistence = options.persistence.value_or(field.least_persistence());
  const Index weak_features = persistence > 0 ? tracer.remove_weak_features(persistence, options.progress) : 0;
  const double tolerance = options.tolerance > 0 ? options.tolerance * measured_box(field, options).diagonal()
                                                 : default_tolerance * lattice.spacing.minCoeff();
  Mesh mesh;
  const Extraction extraction{lattice, sampler, tracer, options.refine, options.normals, options.progress};
  Index center_vertices = 0;
  switch (options.method) {
    case PolygonizeMethod::marching_cubes:
      center_vertices = marching_cubes(extraction, mesh);
      break;
    case PolygonizeMethod::marching_tetrahedra:
      center_vertices = marching_tetrahedra(extraction, mesh);
      break;
    case PolygonizeMethod::dual_contouring:
      center_vertices = dual_contouring(extraction, mesh);
      break;
    case PolygonizeMethod::adaptive:
      center_vertices = adaptive_contouring(extraction, tolerance, mesh);
      break;
  }
  if (options.statistics != nullptr)
    *options.statistics = {tracer.active_cells(), sampler.value_count(), sampler.gradient_count(),
                           tracer.waves(),        center_vertices,       weak_features};
  report(options.progress, "polygonize", 1.0);
  return mesh;
}

}  // namespace csrbf
