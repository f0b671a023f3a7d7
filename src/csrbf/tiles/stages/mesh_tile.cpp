#include "csrbf/tiles/stages/mesh_tile.hpp"

#include "csrbf/approx/unity/tiled_field.hpp"
#include "csrbf/io/models/archive.hpp"
#include "csrbf/tiles/folder/field_file.hpp"
#include "csrbf/tiles/folder/tile_files.hpp"

#include <set>

namespace csrbf {
namespace {

using polygonization::Cell;
using polygonization::CellLattice;
using polygonization::CellRange;

constexpr double looked_at = 2;  // cells beyond a tile: vertices, and the gradients that place them
constexpr double least_cells_in_blend = 2.5;

// A field without values, for what a lattice depends on.
class Frame final : public Field<3> {
 public:
  Frame(const Box<3>& bounds, double feature_size) : bounds_(bounds), feature_size_(feature_size) {}
  void evaluate_block(const PointsRef<3>& x, const JetBlock& out) const override {
    std::fill_n(out.value, x.cols(), 0.0);
  }
  [[nodiscard]] Box<3> bounds() const override { return bounds_; }
  [[nodiscard]] double feature_size() const override { return feature_size_; }

 private:
  Box<3> bounds_;
  double feature_size_;
};

void set_cells(Archive& archive, const std::string& name, const std::vector<Cell>& cells) {
  Eigen::Matrix<std::int32_t, 3, Eigen::Dynamic> table(3, std::ssize(cells));
  for (Index i = 0; i < table.cols(); ++i) table.col(i) = cells[i].matrix();
  archive.set(name, table);
}

std::vector<Cell> cells_from(const Archive& archive, const std::string& name) {
  const auto& table = archive.array<std::int32_t>(name, 3);
  std::vector<Cell> cells;
  for (Index i = 0; i < table.cols(); ++i) cells.emplace_back(table.col(i).array());
  return cells;
}

// Where surfaces cross from tile to tile.
struct TileBorder {
  std::vector<Cell> border;  // see MeshPart
  std::vector<Cell> beyond;
};

void write_border(const MeshPart& part, const std::string& path) {
  Archive archive;
  archive.kind = "border of a tile";
  set_cells(archive, "border", part.border);
  set_cells(archive, "beyond", part.beyond);
  write_archive(path, archive);
}

TileBorder read_border(const TileFolder& folder, Index tile, int round) {
  const Archive archive = read_archive(folder.file(border_kind(round), tile));
  return {cells_from(archive, "border"), cells_from(archive, "beyond")};
}

PartSeam seam_of(const TilePart& part, const TileWork<3>& work, const TileFolder& folder, Index tile) {
  Index count = 0;
  const std::vector<Index> component = component_labels(part.mesh, count);
  PartSeam seam = make_seam(part, component);
  if (count == 0) return seam;
  Records<3> points;
  points.each = work.payload;
  const auto all = [](const auto&) { return true; };
  read_tile<3>(folder.file("points", tile), 0, all, all, points);
  seam.supports = data_support(part.mesh, component, count, points.matrix());
  return seam;
}

std::tuple<int, int, int> sortable(const Cell& cell) {
  return {cell[0], cell[1], cell[2]};
}

}  // namespace

MeshWork plan_meshes(const TileWork<3>& work, const std::vector<TileFit>& fits, int resolution,
                     std::optional<PolygonizeMethod> method) {
  MeshWork mesh;
  double points = 0, noisy = 0, area = 0;
  for (const TileFit& fit : fits) {
    const auto n = static_cast<double>(fit.points);
    if (fit.points > 0) mesh.bounds.add(fit.bounds);
    points += n;
    noisy += fit.noisy ? n : 0;
    area += n * fit.feature_size * fit.feature_size;
  }
  mesh.feature_size = std::sqrt(area / points);
  mesh.method =
      method.value_or(2 * noisy > points ? PolygonizeMethod::marching_cubes : PolygonizeMethod::dual_contouring);
  const Frame frame(mesh.bounds, mesh.feature_size);
  mesh.resolution = resolution > 0 ? resolution : automatic_resolution(frame);
  if (work.plan.size() > 1) {
    const double fewest = std::ceil(least_cells_in_blend * mesh.bounds.extent().maxCoeff() / work.plan.blend());
    mesh.resolution = std::max(mesh.resolution, static_cast<int>(fewest));
  }
  mesh.lattice = polygonization::lattice_around(mesh.bounds, mesh.bounds.extent().maxCoeff() / mesh.resolution);
  return mesh;
}

CellRange cells_of_tile(const MeshWork& mesh, const TilePlan<3>& plan, Index tile) {
  const CellLattice& lattice = mesh.lattice;
  const Box<3>& box = plan.box(tile);
  const auto cell_at = [&](double x, int axis) {
    const double cell = std::ceil((x - lattice.origin[axis]) / lattice.spacing[axis] - 0.5);
    return static_cast<int>(std::clamp(cell, 0.0, static_cast<double>(lattice.cells[axis])));
  };
  CellRange range;
  for (int axis = 0; axis < 3; ++axis) {
    range.first[axis] = cell_at(box.lo[axis], axis);
    range.last[axis] = cell_at(box.hi[axis], axis);
  }
  return range;
}

void mesh_tile(const TileWork<3>& work, const MeshWork& mesh, const TileFolder& folder, Index tile, int round,
               const std::vector<Cell>& starts, const Progress& progress) {
  const CellRange range = cells_of_tile(mesh, work.plan, tile);
  MeshPart part;
  if ((range.first < range.last).all()) {
    std::vector<TiledField<3>::Tile> tiles(work.plan.size());
    tiles[tile].inside = read_field(folder.file("inside", tile));
    const Box<3> box{mesh.lattice.position(range.first), mesh.lattice.position(range.last)};
    const double margin = work.plan.blend() + looked_at * mesh.lattice.spacing.maxCoeff();
    if (work.plan.size() > 1)
      for (const Index t : work.plan.tiles_in(box.inflated(margin))) tiles[t].rim = read_field(folder.file("rim", t));
    const TiledField<3> field(work.plan, std::move(tiles), mesh.bounds, mesh.feature_size);
    part = polygonize_part(field, mesh.lattice, range, starts, {.method = mesh.method, .progress = progress});
  }
  const TilePart own{std::move(part.mesh), std::move(part.shared), part.weak_features};
  write_part(folder.file(part_kind(round), tile), own);
  write_seam(folder.file(seam_kind(round), tile), seam_of(own, work, folder, tile));
  write_border(part, folder.file(border_kind(round), tile));
}

std::string part_kind(int round) {
  return "part" + std::to_string(round);
}

std::string border_kind(int round) {
  return "border" + std::to_string(round);
}

std::string seam_kind(int round) {
  return "seam" + std::to_string(round);
}

std::string missing_kind(int round) {
  return "missing" + std::to_string(round);
}

std::vector<Index> tiles_around(const MeshWork& mesh, const TilePlan<3>& plan, Index tile) {
  const CellRange range = cells_of_tile(mesh, plan, tile);
  const Box<3> box{mesh.lattice.position(range.first), mesh.lattice.position(range.last)};
  return plan.tiles_in(box.inflated(looked_at * mesh.lattice.spacing.maxCoeff()));
}

void find_missing(const MeshWork& mesh, const TilePlan<3>& plan, const TileFolder& folder, Index tile,
                  const std::vector<int>& rounds, int round) {
  std::set<std::tuple<int, int, int>> known;
  for (const Cell& cell : read_border(folder, tile, rounds[tile]).border) known.insert(sortable(cell));
  const CellRange range = cells_of_tile(mesh, plan, tile);
  std::vector<Cell> missing;
  for (const Index other : tiles_around(mesh, plan, tile)) {
    if (other == tile) continue;
    for (const Cell& cell : read_border(folder, other, rounds[other]).beyond)
      if (range.contains(cell) && known.insert(sortable(cell)).second) missing.push_back(cell);
  }
  Archive archive;
  archive.kind = "missing cells";
  set_cells(archive, "cells", missing);
  write_archive(folder.file(missing_kind(round), tile), archive);
}

std::vector<Cell> read_missing(const TileFolder& folder, Index tile, int round) {
  return cells_from(read_archive(folder.file(missing_kind(round), tile)), "cells");
}

}  // namespace csrbf
