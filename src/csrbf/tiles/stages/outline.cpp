#include "csrbf/tiles/stages/outline.hpp"

#include "csrbf/io/models/archive.hpp"
#include "csrbf/spatial/kd_tree.hpp"
#include "csrbf/surface/prepare/prepare.hpp"
#include "csrbf/tiles/stages/cloud_records.hpp"
#include "csrbf/tiles/stages/gather_records.hpp"

namespace csrbf {
namespace {

constexpr Index outline_points = 60'000;  // at most; chosen by hand

}  // namespace

void make_outline(const TileWork<3>& work, const TileFolder& folder, const ReconstructOptions& options) {
  const PointCloud cloud = cloud_of(thinned_records(work, folder, outline_points));
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
