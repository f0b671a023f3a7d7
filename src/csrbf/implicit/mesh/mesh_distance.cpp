#include "csrbf/implicit/mesh/mesh_distance.hpp"

#include "csrbf/core/disjoint_sets.hpp"
#include "csrbf/core/error.hpp"
#include "csrbf/implicit/mesh/triangle_geometry.hpp"
#include "csrbf/implicit/mesh/triangle_tree.hpp"

#include <map>

namespace csrbf {
namespace {

// Above the rounding of doubles by three orders of magnitude.
constexpr double rounding = 1e-12;   // of the diagonal: points this close lie on the surface
constexpr double on_border = 1e-12;  // barycentric weight: closest points with less lie on an edge or at a vertex

double angle_at(const Point<3>& apex, const Point<3>& a, const Point<3>& b) {
  const Point<3> u = a - apex, v = b - apex;
  return std::atan2(u.cross(v).norm(), u.dot(v));
}

// The triangle across the edge from each corner to the next, of a closed mesh.
Triangles find_neighbours(const Triangles& triangles) {
  struct Side {
    std::int32_t from, to;
    Index triangle;
    int corner;
  };
  std::vector<Side> sides;
  for (Index t = 0; t < triangles.cols(); ++t)
    for (int c = 0; c < 3; ++c) sides.push_back({triangles(c, t), triangles((c + 1) % 3, t), t, c});
  const auto by_ends = [](const Side& a, const Side& b) { return std::tie(a.from, a.to) < std::tie(b.from, b.to); };
  std::sort(sides.begin(), sides.end(), by_ends);
  Triangles neighbours(3, triangles.cols());
  for (const Side& side : sides) {
    const auto opposite = std::lower_bound(sides.begin(), sides.end(), Side{side.to, side.from, 0, 0}, by_ends);
    neighbours(side.corner, side.triangle) = static_cast<std::int32_t>(opposite->triangle);
  }
  return neighbours;
}

Points<3> largest_triangles(const Mesh& mesh) {
  DisjointSets sets(mesh.vertices.cols());
  for (Index t = 0; t < mesh.triangles.cols(); ++t)
    for (int c = 0; c < 2; ++c) sets.unite(mesh.triangles(c, t), mesh.triangles(c + 1, t));
  std::map<Index, std::pair<double, Point<3>>> largest;
  for (Index t = 0; t < mesh.triangles.cols(); ++t) {
    const Eigen::Vector3i v = mesh.triangles.col(t);
    const Point<3> a = mesh.vertices.col(v[0]), b = mesh.vertices.col(v[1]), c = mesh.vertices.col(v[2]);
    const double area = area_vector(a, b, c).norm();
    auto& best = largest.try_emplace(sets.find(v[0]), -1.0, a).first->second;
    if (area > best.first) best = {area, (a + b + c) / 3};
  }
  Points<3> seeds(3, std::ssize(largest));
  Index i = 0;
  for (const auto& [component, best] : largest) seeds.col(i++) = best.second;
  return seeds;
}

}  // namespace

MeshDistance::MeshDistance(const Mesh& mesh)
    : tree_(std::make_shared<const TriangleTree>(mesh)),
      vertices_(mesh.vertices),
      triangles_(mesh.triangles),
      touching_(rounding * tree_->bounds().diagonal()) {
  const Topology found = topology(mesh);
  require(found.watertight(), "MeshDistance", "open or inconsistent edges",
          found.boundary_edges + found.nonmanifold_edges + found.inconsistent_edges,
          "must be none: only a closed surface has an inside and an outside; close its holes");
  neighbours_ = find_neighbours(triangles_);
  face_normals_.resize(3, triangles_.cols());
  vertex_normals_.setZero(3, vertices_.cols());
  for (Index t = 0; t < triangles_.cols(); ++t) {
    const Eigen::Vector3i v = triangles_.col(t);
    face_normals_.col(t) =
        area_vector(vertices_.col(v[0]), vertices_.col(v[1]), vertices_.col(v[2])).stableNormalized();
    for (int c = 0; c < 3; ++c)
      vertex_normals_.col(v[c]) +=
          angle_at(vertices_.col(v[c]), vertices_.col(v[(c + 1) % 3]), vertices_.col(v[(c + 2) % 3])) *
          face_normals_.col(t);
  }
  seeds_ = largest_triangles(mesh);
}

MeshDistance::Place MeshDistance::place_of(Index triangle, const Point<3>& p) const {
  const Eigen::Vector3i v = triangles_.col(triangle);
  std::array<Point<3>, 3> corner;
  for (int c = 0; c < 3; ++c) corner[c] = vertices_.col(v[c]);
  const Point<3> normal = area_vector(corner[0], corner[1], corner[2]);
  std::array<bool, 3> off{};  // weight of the corner is not zero
  for (int c = 0; c < 3; ++c) {
    const double weight = area_vector(p, corner[(c + 1) % 3], corner[(c + 2) % 3]).dot(normal);
    off[c] = weight > on_border * normal.squaredNorm();
  }
  const auto count = std::count(off.begin(), off.end(), true);
  if (count == 3) return {face_normals_.col(triangle), Point<3>::Zero(), true};
  for (int c = 0; c < 3 && count == 2; ++c) {
    if (!off[c] || !off[(c + 1) % 3]) continue;
    return {face_normals_.col(triangle) + face_normals_.col(neighbours_(c, triangle)),
            (corner[(c + 1) % 3] - corner[c]).stableNormalized()};
  }
  int nearest = 0;
  for (int c = 1; c < 3; ++c)
    if ((p - corner[c]).squaredNorm() < (p - corner[nearest]).squaredNorm()) nearest = c;
  return {vertex_normals_.col(v[nearest])};
}

double MeshDistance::signed_distance(const Point<3>& x, Point<3>& gradient, Eigen::Matrix3d* hessian) const {
  const TriangleTree::Closest closest = tree_->closest(x);
  if (closest.triangle < 0) {  // x is not finite
    gradient.setConstant(std::numeric_limits<double>::quiet_NaN());
    if (hessian != nullptr) hessian->setConstant(gradient[0]);
    return gradient[0];
  }
  const Place place = place_of(closest.triangle, closest.point);
  const Point<3> from = x - closest.point;
  const double sign = from.dot(place.normal) < 0 ? 1 : -1;
  const bool touching = closest.distance <= touching_;
  gradient = touching ? -place.normal.stableNormalized() : Point<3>(sign * from / closest.distance);
  if (hessian != nullptr) {
    hessian->setZero();
    if (!place.on_face && !touching)
      *hessian =
          sign / closest.distance *
          (Eigen::Matrix3d::Identity() - gradient * gradient.transpose() - place.along * place.along.transpose());
  }
  return sign * closest.distance;
}

void MeshDistance::evaluate_block(const PointsRef<3>& x, const JetBlock& out) const {
  Eigen::Matrix3d hessian;
  Point<3> gradient;
  for (Index i = 0; i < x.cols(); ++i) {
    out.value[i] = signed_distance(x.col(i), gradient, out.hessian != nullptr ? &hessian : nullptr);
    if (out.gradient != nullptr) Eigen::Map<Point<3>>(out.gradient + 3 * i) = gradient;
    if (out.hessian == nullptr) continue;
    for (int a = 0, entry = 0; a < 3; ++a)
      for (int b = a; b < 3; ++b, ++entry) out.hessian[symmetric_size<3> * i + entry] = hessian(a, b);
  }
}

Box<3> MeshDistance::bounds() const {
  return tree_->bounds();
}

}  // namespace csrbf
