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

void write_part(const MeshPart& part, const std::vector<DataSupport>& supports, const std::string& path) {
  Archive archive;
  archive.kind = "part of a mesh";
  archive.set("vertices", part.mesh.vertices);
  archive.set("normals", part.mesh.normals.cast<float>());
  archive.set("triangles", part.mesh.triangles);
  Eigen::Matrix<std::int32_t, Eigen::Dynamic, 1> vertex(std::ssize(part.shared));
  Eigen::Matrix<std::int64_t, Eigen::Dynamic, 1> key(vertex.size());
  for (Index i = 0; i < vertex.size(); ++i) {
    vertex[i] = part.shared[i].vertex;
    key[i] = part.shared[i].key;
  }
  archive.set("shared", vertex);
  archive.set("keys", key);
  Eigen::Matrix<double, 3, Eigen::Dynamic> data(3, std::ssize(supports));
  for (Index c = 0; c < data.cols(); ++c) data.col(c) << supports[c].area, supports[c].samples, supports[c].sample_area;
  archive.set("supports", data);
  write_archive(path, archive);
}

void write_border(const MeshPart& part, const std::vector<Cell>& starts, const std::string& path) {
  Archive archive;
  archive.kind = "border of a tile";
  set_cells(archive, "starts", starts);
  set_cells(archive, "border", part.border);
  set_cells(archive, "beyond", part.beyond);
  write_archive(path, archive);
}

// The data of each component, by the points of the tile.
std::vector<DataSupport> find_supports(const Mesh& mesh, const TileWork<3>& work, const TileFolder& folder,
                                       Index tile) {
  if (mesh.triangles.cols() == 0) return {};
  Index count = 0;
  const std::vector<Index> label = component_labels(mesh, count);
  Records<3> points;
  points.each = work.payload;
  const auto all = [](const auto&) { return true; };
  read_tile<3>(folder.file("points", tile), 0, all, all, points);
  return data_support(mesh, label, count, points.matrix());
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
  write_part(part, find_supports(part.mesh, work, folder, tile), folder.file(part_kind(round), tile));
  write_border(part, starts, folder.file(border_kind(round), tile));
}

std::string part_kind(int round) {
  return "part" + std::to_string(round);
}

std::string border_kind(int round) {
  return "border" + std::to_string(round);
}

TileBorder read_border(const TileFolder& folder, Index tile, int round) {
  const Archive archive = read_archive(folder.file(border_kind(round), tile));
  return {cells_from(archive, "starts"), cells_from(archive, "border"), cells_from(archive, "beyond")};
}

TilePart read_part(const TileFolder& folder, Index tile, int round) {
  const Archive archive = read_archive(folder.file(part_kind(round), tile));
  TilePart part;
  part.mesh.vertices = archive.numbers("vertices", 3);
  part.mesh.normals = archive.array<float>("normals", 3).cast<double>();
  part.mesh.triangles = archive.array<std::int32_t>("triangles", 3);
  const auto& vertex = archive.array<std::int32_t>("shared", -1, 1);
  const auto& key = archive.array<std::int64_t>("keys", vertex.rows(), 1);
  for (Index i = 0; i < vertex.rows(); ++i) part.shared.push_back({vertex(i, 0), key(i, 0)});
  const auto& data = archive.numbers("supports", 3);
  for (Index c = 0; c < data.cols(); ++c) part.supports.push_back({data(0, c), data(1, c), data(2, c)});
  return part;
}

std::vector<std::vector<Cell>> missing_starts(const MeshWork& mesh, const TilePlan<3>& plan,
                                              const std::vector<TileBorder>& borders) {
  std::set<std::tuple<int, int, int>> known;
  for (const TileBorder& border : borders)
    for (const Cell& cell : border.border) known.insert(sortable(cell));
  std::vector<std::vector<Cell>> missing(borders.size());
  for (const TileBorder& border : borders)
    for (const Cell& cell : border.beyond) {
      if (!known.insert(sortable(cell)).second) continue;
      const Box<3> box{mesh.lattice.position(cell), mesh.lattice.position(cell + 1)};
      for (const Index tile : plan.tiles_in(box))
        if (cells_of_tile(mesh, plan, tile).contains(cell)) missing[tile].push_back(cell);
    }
  return missing;
}

}  // namespace csrbf
