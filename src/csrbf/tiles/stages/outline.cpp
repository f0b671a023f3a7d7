#include "csrbf/tiles/stages/outline.hpp"

#include "csrbf/io/models/archive.hpp"
#include "csrbf/spatial/kd_tree.hpp"
#include "csrbf/surface/prepare/prepare.hpp"
#include "csrbf/tiles/folder/tile_files.hpp"

namespace csrbf {
namespace {

constexpr Index outline_points = 60'000;  // at most; chosen by hand

}  // namespace

void make_outline(const TileWork& work, const TileFolder& folder, const ReconstructOptions& options) {
  const double times = static_cast<double>(work.points) / static_cast<double>(outline_points);
  int level = std::max(0, static_cast<int>(std::ceil(std::log2(std::max(times, 1.0)) / 2)));  // a fourth per level
  GatheredPoints found;
  const auto all = [](const auto&) { return true; };
  for (bool fits = false; !fits; ++level) {
    found = {};
    for (Index t = 0; t < work.plan.size(); ++t) read_tile_points(folder.file("points", t), level, all, all, found);
    fits = found.size() <= outline_points || level + 1 >= work.grid.levels();
  }
  PointCloud cloud;
  cloud.points = Eigen::Map<const Points<3>>(found.points.data(), 3, found.size());
  if (work.normals) cloud.normals = Eigen::Map<const Points<3>>(found.normals.data(), 3, found.size());
  const PreparedCloud prepared = prepare(cloud, options.normals, options.progress);
  Archive archive;
  archive.kind = "outline";
  archive.set("points", cloud.points(Eigen::all, prepared.source));
  archive.set("normals", prepared.cloud.normals);
  write_archive(folder.file("outline"), archive);
}

PointCloud read_outline(const TileFolder& folder) {
  const Archive archive = read_archive(folder.file("outline"));
  PointCloud outline;
  outline.points = archive.numbers("points", 3);
  outline.normals = archive.numbers("normals", 3, outline.points.cols());
  return outline;
}

bool is_turned(const PointCloud& outline, const Box<3>& box, const PointsRef<3>& points, const PointsRef<3>& normals) {
  const KdTree<3> tree(points);
  Index agree = 0, disagree = 0;
  for (Index i = 0; i < outline.size(); ++i) {
    if (!box.contains(outline.points.col(i))) continue;
    Index nearest = 0;
    double squared = 0;
    tree.nearest(outline.points.col(i), 1, &nearest, &squared);
    (normals.col(nearest).dot(outline.normals.col(i)) < 0 ? disagree : agree) += 1;
  }
  return disagree > agree;
}

}  // namespace csrbf
