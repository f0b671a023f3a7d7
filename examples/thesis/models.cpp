#include "models.hpp"

#include "csrbf/implicit/mesh/sample_surface.hpp"
#include "csrbf/implicit/polygonize.hpp"
#include "csrbf/io/files/deflate.hpp"
#include "csrbf/io/files/read_file.hpp"
#include "csrbf/io/geometry/formats.hpp"
#include "csrbf/surface/reconstruct.hpp"

#include <Eigen/Geometry>
#include <Eigen/QR>

#include <array>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <random>

namespace csrbf::thesis {
namespace {

constexpr Index enough_vertices = 20000;

const std::map<std::string, std::string> paths = {{"bunny", "data/meshes/bunny00.off"},
                                                  {"dragon", "data/meshes/ChineseDragon-10kv.off"},
                                                  {"kitten", "data/points_3/kitten.xyz"},
                                                  {"knot", "data/meshes/knot1.off"}};

// The files of a tar archive that are models, by path.
std::map<std::string, std::string> read_models() {
  std::map<std::string, std::string> found;
  if (!std::filesystem::exists(models_file)) return found;
  constexpr std::size_t all = std::size_t{1} << 31, block = 512, name_length = 100, size_at = 124, size_length = 12;
  const std::string tar = inflate_head(read_file(models_file), all, models_file);
  for (std::size_t at = 0; at + block <= tar.size();) {
    const std::string name = std::string(tar, at, name_length).c_str();
    const std::size_t size = std::strtoull(std::string(tar, at + size_at, size_length).c_str(), nullptr, 8);
    for (const auto& [model, path] : paths)
      if (name == path) found[model] = tar.substr(at + block, size);
    at += block * (1 + (size + block - 1) / block);
  }
  return found;
}

// Mean normals of the triangles around the vertices, by their areas.
Points<3> vertex_normals(const Mesh& mesh) {
  Points<3> normals = Points<3>::Zero(3, mesh.vertices.cols());
  for (const auto& t : mesh.triangles.colwise()) {
    const Point<3> a = mesh.vertices.col(t[0]), b = mesh.vertices.col(t[1]), c = mesh.vertices.col(t[2]);
    const Point<3> normal = (b - a).cross(c - a);
    for (const int corner : t) normals.col(corner) += normal;
  }
  return normals.colwise().normalized();
}

PointCloud sampled(const Mesh& mesh, Index samples) {
  SurfaceSamples drawn = sample_surface(mesh, samples);
  const Points<3> normals = vertex_normals(mesh);
  for (Index i = 0; i < samples; ++i) {
    const auto t = mesh.triangles.col(drawn.triangle[i]);
    Eigen::Matrix3d corners, corner_normals;
    for (int k = 0; k < 3; ++k) {
      corners.col(k) = mesh.vertices.col(t[k]);
      corner_normals.col(k) = normals.col(t[k]);
    }
    // Barycentric coordinates; the third equation makes them sum to one.
    Eigen::Matrix<double, 4, 3> equations;
    equations << corners, Eigen::RowVector3d::Constant(corners.cwiseAbs().maxCoeff());
    const Eigen::Vector4d right = (Eigen::Vector4d() << drawn.points.col(i), equations(3, 0)).finished();
    const Point<3> weights = equations.colPivHouseholderQr().solve(right);
    drawn.normals.col(i) = (corner_normals * weights).normalized();
  }
  return {std::move(drawn.points), std::move(drawn.normals), {}};
}

struct Vessel {
  Point<3> from, to;
  double radius;
};

// A trunk that divides three times, and a ball at a side: the aneurysm.
const std::array<Vessel, 10> vessels{{{{0, 0, -2}, {0, 0, 0}, 0.32},
                                      {{0, 0, 0}, {-0.9, 0.1, 1}, 0.25},
                                      {{0, 0, 0}, {0.8, -0.2, 1.1}, 0.24},
                                      {{-0.9, 0.1, 1}, {-1.6, 0.5, 1.9}, 0.17},
                                      {{-0.9, 0.1, 1}, {-0.75, -0.3, 2.1}, 0.17},
                                      {{0.8, -0.2, 1.1}, {0.5, 0.3, 2.2}, 0.16},
                                      {{0.8, -0.2, 1.1}, {1.6, -0.5, 1.9}, 0.17},
                                      {{1.6, -0.5, 1.9}, {1.7, -0.2, 2.7}, 0.12},
                                      {{1.6, -0.5, 1.9}, {2.3, -0.8, 2.3}, 0.12},
                                      {{0.42, 0.15, -0.9}, {0.46, 0.17, -0.9}, 0.42}}};

class VesselTree final : public Field<3> {
 public:
  void evaluate_block(const PointsRef<3>& x, const JetBlock& out) const override {
    constexpr double sharpness = 30;  // of the logarithm of a sum of exponentials: a smooth union
    for (Index i = 0; i < x.cols(); ++i) {
      double sum = 0;
      Point<3> gradient = Point<3>::Zero();
      for (const Vessel& v : vessels) {
        const Point<3> along = v.to - v.from, to_point = x.col(i) - v.from;
        const double t = std::clamp(along.dot(to_point) / along.squaredNorm(), 0.0, 1.0);
        const Point<3> away = to_point - t * along;
        const double weight = std::exp(sharpness * (v.radius - away.norm()));
        sum += weight;
        if (away.norm() > 0) gradient -= weight * away.normalized();
      }
      out.value[i] = std::log(std::max(sum, 1e-300)) / sharpness;
      if (out.gradient != nullptr) Eigen::Map<Point<3>>(out.gradient + 3 * i) = gradient / std::max(sum, 1e-300);
    }
  }
  [[nodiscard]] Box<3> bounds() const override { return {{-2.2, -1.5, -2.6}, {2.8, 1.2, 3.1}}; }
};

}  // namespace

const std::string models_file = "/usr/share/doc/libcgal-demo/data.tar.gz";

std::optional<PointCloud> model(const std::string& name, Index samples) {
  static const std::map<std::string, std::string> texts = read_models();
  const auto text = texts.find(name);
  if (text == texts.end()) return std::nullopt;
  if (paths.at(name).ends_with(".xyz")) {
    const PointCloud points = parse_point_table(text->second, name);
    return sampled(polygonize(*reconstruct(points, {.normals = Normals::file}).field, {.resolution = 160}), samples);
  }
  Mesh mesh = parse_off(text->second, name);
  if (mesh.vertices.cols() < enough_vertices) return sampled(mesh, samples);
  Points<3> normals = vertex_normals(mesh);
  return PointCloud{std::move(mesh.vertices), std::move(normals), {}};
}

Figure without_models(Figure figure) {
  figure.missing = models_file + " is not there: install the package libcgal-demo.";
  return figure;
}

PointCloud vessel_tree(Index samples) {
  return sampled(polygonize(VesselTree(), {.resolution = 160}), samples);
}

PointCloud shaken(PointCloud cloud, double deviation) {
  std::mt19937_64 random(1);
  std::normal_distribution<double> noise(0, deviation * bounding_box<3>(cloud.points).diagonal());
  cloud.points += Points<3>::NullaryExpr(3, cloud.size(), [&] { return noise(random); });
  return cloud;
}

}  // namespace csrbf::thesis
