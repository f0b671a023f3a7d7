#include "csrbf/implicit/polygonize_part.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/implicit/polygonize/cell_tracer.hpp"
#include "csrbf/implicit/polygonize/start_cells.hpp"

namespace csrbf {

using namespace polygonization;

MeshPart polygonize_part(const Field<3>& field, const CellLattice& lattice, const CellRange& range,
                         const std::vector<Cell>& starts, const PolygonizeOptions& options) {
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
  tracer.run_from(from, options.progress);

  const double persistence = options.persistence.value_or(field.least_persistence());
  MeshPart part;
  if (persistence > 0) part.weak_features = tracer.remove_weak_features(persistence, options.progress);

  const CellRange around{range.first - 1, range.last + 1};
  for (const Cell& cell : tracer.beyond())
    if (around.contains(cell)) part.beyond.push_back(cell);
  tracer.for_each_active([&](const Cell& cell) {
    if (!range.contains(cell))
      part.beyond.push_back(cell);
    else if ((cell == range.first).any() || (cell == range.last - 1).any())
      part.border.push_back(cell);
  });
  if (tracer.active_cells() > 0) {
    const Extraction extraction{lattice, sampler, tracer, options.refine, options.normals, options.progress};
    part.shared =
        cubes ? marching_cubes_part(extraction, range, part.mesh) : dual_contouring_part(extraction, range, part.mesh);
  }
  report(options.progress, "polygonize", 1.0);
  return part;
}

}  // namespace csrbf
