#include "csrbf/implicit/polygonize/extraction.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/implicit/mesh/edge_collapse.hpp"
#include "csrbf/implicit/polygonize/cell_tetrahedra.hpp"
#include "csrbf/implicit/polygonize/cell_triangles.hpp"
#include "csrbf/implicit/polygonize/center_vertices.hpp"
#include "csrbf/implicit/polygonize/dual_triangles.hpp"
#include "csrbf/implicit/polygonize/edge_vertices.hpp"
#include "csrbf/implicit/polygonize/merge_cells.hpp"

#include <Eigen/Geometry>

#include <optional>

namespace csrbf::polygonization {
namespace {

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

Index cubes_mesh(const Extraction& e, const std::vector<Brick*>& bricks, Mesh& mesh) {
  const Index edge_vertices = number_edge_vertices(bricks);
  const TriangleOffsets offsets = count_triangles(bricks);
  resize_vertices(edge_vertices + offsets.centers.back(), e.normals, mesh);
  mesh.triangles.resize(3, offsets.triangles.back());
  place_edge_vertices(e.lattice, bricks, e.sampler, {e.refine, e.normals}, mesh, e.progress);
  report(e.progress, "polygonize", 0.95);
  fill_triangles(bricks, offsets, edge_vertices, mesh);
  mesh.normals.rightCols(e.normals ? offsets.centers.back() : 0).setZero();
  place_center_vertices(e.lattice, e.sampler, edge_vertices, e.refine, mesh);
  if (e.normals) complete_normals(mesh);
  return offsets.centers.back();
}

// On an octree if there is a tolerance.
Index dual_mesh(const Extraction& e, std::optional<double> tolerance, Mesh& mesh) {
  const std::vector<Brick*> bricks = e.tracer.finish(axis_directions);
  Mesh crossings;
  resize_vertices(number_edge_vertices(bricks), true, crossings);
  place_edge_vertices(e.lattice, bricks, e.sampler, {.refine = e.refine}, crossings, e.progress);
  report(e.progress, "polygonize", 0.95);
  std::vector<CellPlanes> planes;
  const DualSurface surface = make_dual_surface(e.lattice, bricks, crossings, mesh, tolerance ? &planes : nullptr);
  const Index side_vertices = mesh.vertices.cols() - surface.loop_vertices;
  unfold_quads(surface, crossings, mesh);
  if (!e.normals) mesh.normals.resize(3, 0);
  if (tolerance) {
    triangulate_quads(surface, crossings, mesh);
    merge_cells(e.lattice, *tolerance, std::move(planes), mesh, e.progress);
    place_center_vertices(e.lattice, e.sampler, 0, e.refine, mesh);
  } else {
    place_center_vertices(e.lattice, e.sampler, 0, e.refine, mesh);
    triangulate_quads(surface, crossings, mesh);
  }
  collapse_short_edges(edge_margin * e.lattice.spacing.minCoeff(), mesh);
  if (e.normals) complete_normals(mesh);
  return side_vertices;
}

// Calls visit(e, corner, axis) for the numbered edges along the axes.
template <class Visit>
void for_each_axis_edge(const std::vector<Brick*>& bricks, const Visit& visit) {
  Index e = 0;
  for (const Brick* brick : bricks)
    for (int axis = 0; axis < 3; ++axis)
      for (Mask left = brick->edges[1 << axis]; left != 0; left &= left - 1)
        visit(e++, brick->corner(std::countr_zero(left)), axis);
}

// Tells vertices apart: those of different cells, and of one cell by their kinds.
class VertexKeys {
 public:
  VertexKeys(const CellLattice& lattice, const CellRange& range) : lattice_(lattice), range_(range) {}

  [[nodiscard]] std::int64_t of(const Cell& cell, int kind) const {
    const auto n = lattice_.cells.cast<std::int64_t>() + 2;  // cells may lie one layer below
    const auto c = cell.cast<std::int64_t>() + 1;
    return ((c[2] * n[1] + c[1]) * n[0] + c[0]) * VertexPlace::kinds + kind;
  }

  // Whether other parts may have the crossing of an edge with this lower corner.
  [[nodiscard]] bool edge_is_shared(const Cell& corner, int axis) const {
    for (int k = 1; k < 3; ++k) {
      const int other = (axis + k) % 3;
      if (corner[other] == range_.first[other] || corner[other] == range_.last[other]) return true;
    }
    return false;
  }
  // ... the vertices of dual contouring in a cell: it is in the last layer of a range.
  [[nodiscard]] bool cell_is_shared(const Cell& cell) const {
    return (cell < range_.first).any() || (cell >= range_.last - 1).any();
  }

 private:
  const CellLattice& lattice_;
  const CellRange& range_;
};

// Leaves the quads of edges of the range, whose four cells are all there.
void keep_own_quads(const std::vector<Brick*>& bricks, const CellRange& range, DualSurface& surface, Mesh& crossings) {
  std::vector<std::int32_t> number(surface.quads.cols(), -1);
  Index kept = 0;
  for_each_axis_edge(bricks, [&](Index edge, const Cell& corner, int) {
    if (!range.contains(corner)) return;
    surface.quads.col(kept) = surface.quads.col(edge);
    crossings.vertices.col(kept) = crossings.vertices.col(edge);
    crossings.normals.col(kept) = crossings.normals.col(edge);
    number[edge] = static_cast<std::int32_t>(kept++);
  });
  surface.quads.conservativeResize(4, kept);
  std::vector<SideVertex> sides;
  for (SideVertex side : surface.side_vertices) {
    side.quad = number[side.quad];
    if (side.quad >= 0) sides.push_back(side);
  }
  surface.side_vertices = std::move(sides);
}

}  // namespace

void drop_unused_vertices(Mesh& mesh, std::vector<SharedVertex>& shared) {
  std::vector<std::int32_t> number(mesh.vertices.cols(), -1);
  for (const std::int32_t v : mesh.triangles.reshaped()) number[v] = 0;
  std::vector<Index> kept;
  for (Index v = 0; v < mesh.vertices.cols(); ++v) {
    if (number[v] < 0) continue;
    number[v] = static_cast<std::int32_t>(kept.size());
    kept.push_back(v);
  }
  for (std::int32_t& v : mesh.triangles.reshaped()) v = number[v];
  mesh.vertices = Points<3>(mesh.vertices(Eigen::all, kept));
  if (mesh.normals.cols() > 0) mesh.normals = Points<3>(mesh.normals(Eigen::all, kept));
  std::vector<SharedVertex> used;
  for (const SharedVertex& s : shared)
    if (number[s.vertex] >= 0) used.push_back({number[s.vertex], s.key});
  shared = std::move(used);
}

Index marching_cubes(const Extraction& e, Mesh& mesh) {
  return cubes_mesh(e, e.tracer.finish(axis_directions), mesh);
}

Index marching_tetrahedra(const Extraction& e, Mesh& mesh) {
  const std::vector<Brick*> bricks = e.tracer.finish(all_directions);
  resize_vertices(number_edge_vertices(bricks), e.normals, mesh);
  place_edge_vertices(e.lattice, bricks, e.sampler, {e.refine, e.normals}, mesh, e.progress);
  report(e.progress, "polygonize", 0.95);
  march_tetrahedra(bricks, mesh);
  if (e.normals) complete_normals(mesh);
  return 0;
}

Index dual_contouring(const Extraction& e, Mesh& mesh) {
  return dual_mesh(e, std::nullopt, mesh);
}

Index adaptive_contouring(const Extraction& e, double tolerance, Mesh& mesh) {
  return dual_mesh(e, tolerance, mesh);
}

std::vector<SharedVertex> marching_cubes_part(const Extraction& e, const CellRange& range, Mesh& mesh) {
  const std::vector<Brick*> bricks = e.tracer.finish(axis_directions);
  cubes_mesh(e, bricks, mesh);
  std::vector<SharedVertex> shared;
  const VertexKeys keys(e.lattice, range);
  for_each_axis_edge(bricks, [&](Index edge, const Cell& corner, int axis) {
    if (keys.edge_is_shared(corner, axis)) shared.push_back({static_cast<int>(edge), keys.of(corner, axis)});
  });
  return shared;
}

// Vertices in outer cells stay where their planes put them: what is around them may belong to other parts.
std::vector<SharedVertex> dual_contouring_part(const Extraction& e, const CellRange& range, Mesh& mesh) {
  const std::vector<Brick*> bricks = e.tracer.finish(axis_directions);
  Mesh crossings;
  resize_vertices(number_edge_vertices(bricks), true, crossings);
  place_edge_vertices(e.lattice, bricks, e.sampler, {.refine = e.refine}, crossings, e.progress);
  DualSurface surface = make_dual_surface(e.lattice, bricks, crossings, mesh, nullptr);
  keep_own_quads(bricks, range, surface, crossings);

  std::vector<SharedVertex> shared;
  const VertexKeys keys(e.lattice, range);
  for (std::size_t v = 0; v < surface.places.size(); ++v) {
    const VertexPlace& place = surface.places[v];
    if (!keys.cell_is_shared(place.cell)) continue;
    if (place.face < 0) surface.loose[v] = 0;
    shared.push_back({static_cast<std::int32_t>(v), keys.of(place.cell, place.kind())});
  }
  unfold_quads(surface, crossings, mesh);
  place_center_vertices(e.lattice, e.sampler, 0, e.refine, mesh);
  triangulate_quads(surface, crossings, mesh);
  drop_unused_vertices(mesh, shared);
  std::vector<char> pinned(mesh.vertices.cols());
  for (const SharedVertex& s : shared) pinned[s.vertex] = 1;
  const std::vector<int> old_number = collapse_short_edges(edge_margin * e.lattice.spacing.minCoeff(), mesh, pinned);
  for (std::size_t v = 0, s = 0; v < old_number.size(); ++v)
    if (s < shared.size() && shared[s].vertex == old_number[v]) shared[s++].vertex = static_cast<std::int32_t>(v);
  if (!e.normals) mesh.normals.resize(3, 0);
  if (e.normals) complete_normals(mesh);
  return shared;
}

}  // namespace csrbf::polygonization
