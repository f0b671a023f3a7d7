#include "csrbf/tiles/stages/cloud_records.hpp"

#include "csrbf/core/joined.hpp"

#include <cstring>

namespace csrbf {
namespace {

// In spacings, chosen by hand: tiles blend over the width of a few patches, and see the samples of all patches there.
constexpr double narrowest_blend = 4;
constexpr double cells_in_blend = 3;  // cells of the mesh: vertices beside a face move by less than two
constexpr double patch_reach = 10;
constexpr double finest_cells = 1024;  // along the longest side, where the data decide: see automatic_resolution()
constexpr double coarsest_cell = 1.25;

constexpr std::size_t normal_bytes = 3 * sizeof(float);

}  // namespace

Records<3> records_of(const PointCloud& cloud) {
  Records<3> records;
  records.points.assign(cloud.points.data(), cloud.points.data() + cloud.points.size());
  if (!cloud.has_normals()) return records;
  records.each = normal_bytes;
  const Eigen::Matrix3Xf normals = cloud.normals.cast<float>();
  records.payload.resize(normal_bytes * static_cast<std::size_t>(normals.cols()));
  std::memcpy(records.payload.data(), normals.data(), records.payload.size());
  return records;
}

PointCloud cloud_of(const Records<3>& records) {
  PointCloud cloud;
  cloud.points = records.matrix();
  if (records.each == 0) return cloud;
  Eigen::Matrix3Xf normals(3, records.size());
  if (!records.payload.empty()) std::memcpy(normals.data(), records.payload.data(), records.payload.size());
  cloud.normals = normals.cast<double>();
  return cloud;
}

RecordSource<3> cloud_source(PointStream& stream) {
  RecordSource<3> source;
  source.size = stream.size();
  source.payload = stream.read(0, std::min<Index>(1, stream.size())).has_normals() ? normal_bytes : 0;
  source.read = [&stream](Index begin, Index end) { return records_of(stream.read(begin, end)); };
  return source;
}

TileRules surface_rules(Index tile_points, int resolution) {
  return {
      .tile_points = tile_points,
      .dimension = 2,
      .blend =
          [resolution](double spacing, double extent) {
            const double cell =
                resolution > 0 ? extent / resolution : std::max(coarsest_cell * spacing, extent / finest_cells);
            return std::max(narrowest_blend * spacing, cells_in_blend * cell);
          },
      .reach = patch_reach,
  };
}

Archive surface_notes(PointStream& stream) {
  std::vector<std::string> names;
  for (const Property& p : stream.read(0, std::min<Index>(1, stream.size())).properties) names.push_back(p.name);
  Archive notes;
  notes.kind = "surface";
  notes.set("left_out", joined(names));
  return notes;
}

std::string left_out(const TileWork<3>& work) {
  return work.notes.text("left_out");
}

}  // namespace csrbf
