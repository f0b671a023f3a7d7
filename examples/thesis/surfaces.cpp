#include "surfaces.hpp"

#include "csrbf/implicit/polygonize.hpp"

#include <algorithm>
#include <cmath>

namespace csrbf::thesis {
namespace {

constexpr int pixels = 340;
constexpr double bead = 0.004;  // radius, of the diagonal
constexpr double smallest_slope = 0.1;

RenderOptions options_of(const Look& look, const Box<3>& frame) {
  RenderOptions options{.width = pixels, .height = pixels, .view = look.view, .up = look.up, .frame = frame};
  options.margin = 0.02;
  return options;
}

}  // namespace

MeasuredSurface measure(std::shared_ptr<const Field<3>> field, double centers, const PointsRef<3>& points) {
  MeasuredSurface result{std::move(field), centers};
  const double diagonal = bounding_box<3>(points).diagonal();
  const Jet<3> jet = result.field->evaluate(points, Derivatives::gradient);
  const Eigen::ArrayXd offset = jet.value.array().abs() / diagonal;
  const Eigen::ArrayXd slopes = jet.gradient.colwise().norm().transpose().array().max(smallest_slope);
  const Eigen::ArrayXd taubin = offset / slopes;
  result.mean_offset = offset.mean();
  result.rms_offset = std::sqrt(offset.square().mean());
  result.mean_taubin = taubin.mean();
  result.rms_taubin = std::sqrt(taubin.square().mean());
  return result;
}

MeasuredSurface with_budget(const PointCloud& cloud, const std::string& method, Index centers,
                            std::optional<double> smoothing) {
  const Reconstruction made =
      reconstruct(cloud, {.method = method, .normals = Normals::file, .centers = centers, .smoothing = smoothing});
  return measure(made.field, static_cast<double>(made.report.centers), cloud.points);
}

std::string MeshedSurface::words() const {
  return std::string(topology.watertight() ? "closed, " : "open, ") + std::to_string(topology.components) +
         (topology.components == 1 ? " component" : " components");
}

MeshedSurface meshed(const MeasuredSurface& surface, int resolution) {
  MeshedSurface result{polygonize(*surface.field, {.resolution = resolution}), {}};
  result.topology = topology(result.mesh);
  return result;
}

RgbImage picture(const Mesh& mesh, const Look& look, const Box<3>& frame) {
  return render(mesh, options_of(look, frame));
}

RgbImage picture(const PointCloud& cloud, const Look& look, Index most) {
  const Index stride = std::max<Index>(1, cloud.size() / most), n = (cloud.size() + stride - 1) / stride;
  const double radius = bead * bounding_box<3>(cloud.points).diagonal();
  Mesh beads;
  beads.vertices.resize(3, 6 * n);
  beads.triangles.resize(3, 8 * n);
  for (Index i = 0; i < n; ++i) {
    const auto at = static_cast<std::int32_t>(6 * i);
    for (int axis = 0; axis < 3; ++axis)
      for (int side = 0; side < 2; ++side)
        beads.vertices.col(at + 2 * axis + side) =
            cloud.points.col(i * stride) + (side == 0 ? radius : -radius) * Point<3>::Unit(axis);
    for (int octant = 0; octant < 8; ++octant) {
      const int x = octant & 1, y = (octant >> 1) & 1, z = octant >> 2;
      const bool turned = (x + y + z) % 2 == 1;
      beads.triangles.col(8 * i + octant) << at + x, at + (turned ? 4 + z : 2 + y), at + (turned ? 2 + y : 4 + z);
    }
  }
  return picture(beads, look);
}

RgbImage colored(Mesh mesh, const Eigen::VectorXd& length, double largest, const Look& look) {
  constexpr std::array<std::array<double, 3>, 3> ramp{{{30, 40, 120}, {30, 150, 140}, {250, 225, 60}}};
  for (std::size_t c = 0; c < 3; ++c) {
    Property channel{std::array{"red", "green", "blue"}[c], "uchar", Eigen::VectorXd(length.size())};
    for (Index i = 0; i < length.size(); ++i) {
      const double t = 2 * std::clamp(length[i] / largest, 0.0, 1.0);
      const auto k = static_cast<std::size_t>(std::min(1.0, std::floor(t)));
      channel.values[i] = std::round(ramp[k][c] + (t - static_cast<double>(k)) * (ramp[k + 1][c] - ramp[k][c]));
    }
    mesh.properties.push_back(std::move(channel));
  }
  return picture(mesh, look);
}

}  // namespace csrbf::thesis
