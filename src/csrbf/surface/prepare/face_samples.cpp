#include "csrbf/surface/prepare/face_samples.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/implicit/mesh/sample_surface.hpp"
#include "csrbf/spatial/kd_tree.hpp"
#include "csrbf/surface/prepare/transfer_properties.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace csrbf {
namespace {

// Chosen by hand.
constexpr Index fewest_samples = 20'000;
constexpr Index places_asked = 4000;    // on the faces
constexpr Index vertices_asked = 12;    // that are nearest to each
constexpr double same_direction = 0.7;  // cosine between their normals and that of the face
constexpr double most_of_them = 0.75;
constexpr double contradictory = 0.05;    // length of a mean of normals
constexpr double usual_exceptions = 0.1;  // share of the places; along the edges of finely meshed bodies

// The faces whose corners are finite and span an area.
Mesh with_area(const Mesh& mesh) {
  Mesh result;
  result.vertices = mesh.vertices;
  result.triangles.resize(3, mesh.triangles.cols());
  Index count = 0;
  for (Index t = 0; t < mesh.triangles.cols(); ++t) {
    const auto corner = [&](int k) -> Point<3> { return mesh.vertices.col(mesh.triangles(k, t)); };
    const double area = (corner(1) - corner(0)).cross(corner(2) - corner(0)).norm();
    if (area > 0 && std::isfinite(area)) result.triangles.col(count++) = mesh.triangles.col(t);
  }
  result.triangles.conservativeResize(3, count);
  return result;
}

// Mean normals of the faces around each vertex, weighted by their angles (Thuermer and Wuethrich 1998): zero without,
// and where the faces contradict each other, such as the two of each place of a mesh with two sides.
Points<3> vertex_normals(const Mesh& mesh) {
  Points<3> normals = Points<3>::Zero(3, mesh.vertices.cols());
  Eigen::VectorXd angles = Eigen::VectorXd::Zero(mesh.vertices.cols());
  for (Index t = 0; t < mesh.triangles.cols(); ++t)
    for (int k = 0; k < 3; ++k) {
      const auto corner = [&](int i) -> Point<3> { return mesh.vertices.col(mesh.triangles((k + i) % 3, t)); };
      const Point<3> a = corner(1) - corner(0), b = corner(2) - corner(0), normal = a.cross(b);
      const double angle = std::atan2(normal.norm(), a.dot(b));
      normals.col(mesh.triangles(k, t)) += angle * normal.normalized();
      angles[mesh.triangles(k, t)] += angle;
    }
  for (Index i = 0; i < normals.cols(); ++i) {
    const double sum = normals.col(i).norm();
    normals.col(i) *= sum > contradictory * angles[i] ? 1 / sum : 0;
  }
  return normals;
}

// Whether the vertices near most places on the faces have the normals of these places, or the faces tell none.
bool vertices_suffice(const Mesh& mesh, const std::vector<Index>& used) {
  const Points<3> vertices = mesh.vertices(Eigen::all, used), normals = vertex_normals(mesh)(Eigen::all, used);
  const auto without = (normals.array() == 0).colwise().all().count();
  if (static_cast<double>(without) > usual_exceptions * static_cast<double>(normals.cols())) return true;
  const KdTree<3> tree(vertices);
  const SurfaceSamples places = sample_surface(mesh, places_asked);
  std::array<Index, vertices_asked> ids;
  std::array<double, vertices_asked> squared;
  Index exceptions = 0;
  for (Index i = 0; i < places_asked; ++i) {
    const Index found = tree.nearest(places.points.col(i), vertices_asked, ids.data(), squared.data());
    const auto like = std::count_if(ids.begin(), ids.begin() + found, [&](Index v) {
      return normals.col(v).dot(places.normals.col(i)) > same_direction;
    });
    if (static_cast<double>(like) < most_of_them * static_cast<double>(found)) ++exceptions;
  }
  return static_cast<double>(exceptions) <= usual_exceptions * places_asked;
}

}  // namespace

std::optional<PointCloud> samples_of_coarse_faces(const Mesh& mesh) {
  const Index count = mesh.vertices.cols();
  require(mesh.triangles.size() == 0 || (mesh.triangles.minCoeff() >= 0 && mesh.triangles.maxCoeff() < count),
          "samples_of_coarse_faces", "vertex index", "out of range", "indices must be in [0, number of vertices)");
  const Mesh faces = with_area(mesh);
  if (faces.triangles.cols() == 0) return std::nullopt;
  std::vector<char> on_face(count, 0);
  for (const std::int32_t v : faces.triangles.reshaped()) on_face[v] = 1;
  std::vector<Index> used, others;
  for (Index i = 0; i < count; ++i) (on_face[i] != 0 ? used : others).push_back(i);
  if (vertices_suffice(faces, used)) return std::nullopt;

  const Index n = std::max(fewest_samples, std::ssize(used));
  const SurfaceSamples samples = sample_surface(faces, n);
  PointCloud cloud{Points<3>(3, n + std::ssize(others)), Points<3>::Zero(3, n + std::ssize(others)), {}};
  cloud.points << samples.points, mesh.vertices(Eigen::all, others);
  cloud.normals.leftCols(n) = samples.normals;
  if (mesh.normals.cols() == count) cloud.normals.rightCols(std::ssize(others)) = mesh.normals(Eigen::all, others);
  cloud.properties = transfer_properties(mesh.vertices, mesh.properties, cloud.points);
  return cloud;
}

}  // namespace csrbf
