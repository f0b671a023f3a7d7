#include "csrbf/tiles/stages/fit_surface_tile.hpp"

#include "csrbf/approx/unity/tiled_field.hpp"
#include "csrbf/core/error.hpp"
#include "csrbf/io/model.hpp"
#include "csrbf/io/models/function_archive.hpp"
#include "csrbf/io/models/tile_store.hpp"
#include "csrbf/surface/composite/crop_field.hpp"
#include "csrbf/tiles/folder/field_file.hpp"
#include "csrbf/tiles/folder/model_places.hpp"
#include "csrbf/tiles/stages/cloud_records.hpp"
#include "csrbf/tiles/stages/gather_records.hpp"
#include "csrbf/tiles/stages/outline.hpp"

namespace csrbf {
namespace {

constexpr Index bins = 4000;
constexpr double bins_per_factor = 100;  // of ten: 2.3 % each
constexpr double smallest_bin = 1e-30;   // of the diagonal

// As reconstruct(), with the outside on the same side as in all tiles. Changes the cloud where that differs.
Reconstruction reconstruct_outward(PointCloud& cloud, const ReconstructOptions& options, const TileWork<3>& work,
                                   const TileFolder& folder, Index tile) {
  Reconstruction surface = reconstruct(cloud, options);
  const bool own_side =
      surface.report.normals == NormalSource::estimated || surface.report.normals == NormalSource::reoriented;
  if (work.plan.size() == 1 || !own_side) return surface;
  Points<3> used = cloud.points(Eigen::all, surface.source);
  if (!is_turned(read_outline(folder), work.plan.box(tile), used, surface.normals)) return surface;
  cloud.points = std::move(used);
  cloud.normals = -surface.normals;
  const ReconstructReport found = std::move(surface.report);
  ReconstructOptions turned = options;
  turned.normals = Normals::file;
  surface = reconstruct(cloud, turned);
  surface.report.normals = found.normals;
  surface.report.warnings = found.warnings;
  return surface;
}

TileFit describe(const Reconstruction& surface, const CompositeField& field, const PointCloud& cloud,
                 const TileWork<3>& work, Index tile) {
  const ReconstructReport& report = surface.report;
  TileFit fit;
  fit.feature_size = field.feature_size();
  fit.noisy = field.data().noisy;
  fit.centers = report.centers;
  fit.patches = report.composite->patches;
  fit.levels = report.composite->levels;
  fit.leaf_size = report.composite->settings.leaf_size;
  fit.cross_validation_error = report.composite->cross_validation_error;
  fit.normals = report.normals;
  fit.warnings = report.warnings;
  fit.distances.assign(bins, 0);
  for (std::size_t i = 0; i < surface.measured.size(); ++i) {
    const Point<3> p = cloud.points.col(surface.source[surface.measured[i]]);
    if (work.plan.tile_of(p) != tile) continue;
    fit.bounds.add(p);
    ++fit.points;
    const double distance = surface.distance[i];
    fit.squared_distances += distance * distance;
    fit.largest_distance = std::max(fit.largest_distance, distance);
    ++fit.distances[distance_bin(distance)];
  }
  return fit;
}

void write_fit(const TileFit& fit, const std::string& path) {
  Archive archive;
  archive.kind = "tile fit";
  archive.set("points", fit.points);
  set_box(archive, fit.bounds);
  archive.set("feature_size", fit.feature_size);
  archive.set("noisy", fit.noisy ? 1 : 0);
  archive.set("patches", fit.patches);
  archive.set("centers", fit.centers);
  archive.set("levels", fit.levels);
  archive.set("leaf_size", fit.leaf_size);
  archive.set("cross_validation_error", fit.cross_validation_error);
  archive.set("normals", fit.normals);
  archive.set("squared_distances", fit.squared_distances);
  archive.set("largest_distance", fit.largest_distance);
  archive.set("distances", fit.distances);
  set_texts(archive, "warning", fit.warnings);
  write_archive(path, archive);
}

}  // namespace

Index distance_bin(double distance) {
  const double bin = bins_per_factor * std::log10(std::max(distance, smallest_bin) / smallest_bin);
  return std::clamp<Index>(static_cast<Index>(std::ceil(bin)), 0, bins - 1);
}

double bin_distance(Index bin) {
  return smallest_bin * std::pow(10.0, static_cast<double>(bin) / bins_per_factor);
}

void fit_surface_tile(const TileWork<3>& work, const TileFolder& folder, Index tile, const ReconstructOptions& options,
                      bool with_model) {
  const Box<3>& box = work.plan.box(tile);
  const double blend = work.plan.blend();
  TileFit fit;
  std::shared_ptr<const CompositeField> field;
  {
    Records<3> records = gather_near(work, folder, tile);
    add_far(work, folder, tile, records);
    PointCloud cloud = cloud_of(records);
    records = {};
    ReconstructOptions here = options;
    here.method = "composite";
    if (work.plan.size() > 1) here.region = box.inflated(blend);
    const Reconstruction surface = reconstruct_outward(cloud, here, work, folder, tile);
    field = std::dynamic_pointer_cast<const CompositeField>(surface.field);
    fit = describe(surface, *field, cloud, work, tile);
  }
  // One tile is what all points at once are.
  const FieldNumbers numbers = work.plan.size() > 1 ? FieldNumbers::rounded : FieldNumbers::exact;
  if (work.plan.size() > 1) {
    const Box<3> hole = box.inflated(-blend);
    write_field(folder.file("rim", tile),
                crop(*field, {box.inflated(blend), hole.empty() ? std::nullopt : std::optional(hole)}, work.halo),
                numbers);
  }
  write_field(folder.file("inside", tile), *field, numbers);
  if (with_model) write_model(folder.file("model", tile), *field);
  write_fit(fit, folder.file("fit", tile));
}

void write_surface(const TileWork<3>& work, const TileFolder& folder, const Box<3>& bounds, double feature_size,
                   const std::string& path) {
  if (work.plan.size() == 1) return write_model(path, *read_model(folder.file("model", 0)));
  const auto store = std::make_shared<const TileStore<3>>(model_places(folder, work.plan.size()));
  std::vector<TiledField<3>::Tile> tiles;
  for (Index t = 0; t < work.plan.size(); ++t)
    tiles.push_back({std::make_shared<const StoredField<3>>(store, t, StoredField<3>::Part{}, 1.0), nullptr});
  write_model(path, TiledField<3>(work.plan, std::move(tiles), bounds, feature_size));
}

TileFit read_tile_fit(const TileFolder& folder, Index tile) {
  const Archive archive = read_archive(folder.file("fit", tile));
  TileFit fit;
  fit.points = archive.integer("points");
  fit.bounds = box_of<3>(archive);
  fit.feature_size = archive.number("feature_size");
  fit.noisy = archive.integer("noisy") != 0;
  fit.patches = archive.integer("patches");
  fit.centers = archive.integer("centers");
  fit.levels = archive.integer("levels");
  fit.leaf_size = archive.integer("leaf_size");
  fit.cross_validation_error = archive.number("cross_validation_error");
  fit.normals = static_cast<NormalSource>(archive.integer("normals", 0, 4));
  fit.squared_distances = archive.number("squared_distances");
  fit.largest_distance = archive.number("largest_distance");
  const auto& counts = archive.array<std::int64_t>("distances", bins, 1);
  fit.distances.assign(counts.data(), counts.data() + counts.size());
  fit.warnings = texts_of(archive, "warning");
  return fit;
}

}  // namespace csrbf
