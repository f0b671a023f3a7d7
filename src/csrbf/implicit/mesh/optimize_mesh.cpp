#include "csrbf/implicit/mesh/optimize_mesh.hpp"

#include "csrbf/implicit/mesh/triangle_geometry.hpp"

#include <numbers>

namespace csrbf {
namespace {

// Chosen by hand.
constexpr double largest_tilt = 0.7;   // cosine of 45 degrees: with a triangle tilted further, vertices are on edges
constexpr double longest_step = 0.25;  // Newton step onto the surface, in mean distances to the neighbours

double signed_roundness(const Point<3>& a, const Point<3>& b, const Point<3>& c, const Point<3>& normal) {
  const double longest = std::max({(a - b).squaredNorm(), (b - c).squaredNorm(), (c - a).squaredNorm()});
  return longest > 0 ? area_vector(a, b, c).dot(normal) / longest : 0.0;
}

class Optimizer {
 public:
  Optimizer(const Field<3>& field, double level, Mesh& mesh)
      : field_(field), level_(level), mesh_(mesh), first_(mesh.vertices.cols() + 1) {
    for (Index i = 0; i < mesh.triangles.size(); ++i) ++first_[mesh.triangles(i) + Index{1}];
    for (std::size_t v = 1; v < first_.size(); ++v) first_[v] += first_[v - 1];
    corner_.resize(mesh.triangles.size());
    std::vector<Index> next(first_.begin(), first_.end() - 1);
    for (Index i = 0; i < mesh.triangles.size(); ++i) corner_[next[mesh.triangles(i)]++] = i;
    take_normals(field.evaluate(mesh.vertices, Derivatives::gradient));
    fix_sharp_vertices();
  }

  void relax() {
    for (Index v = 0; v < mesh_.vertices.cols(); ++v)
      if (!fixed_[v]) relax(v);
  }

  // A Newton step of every vertex, and the normals there.
  void project() {
    const Jet<3> jet = field_.evaluate(mesh_.vertices, Derivatives::gradient);
    take_normals(jet);
    for (Index v = 0; v < mesh_.vertices.cols(); ++v) {
      const Point<3> gradient = jet.gradient.col(v);
      const double slope = gradient.norm(), step = (level_ - jet.value[v]) / slope;
      if (fixed_[v] || !(std::abs(step) <= longest_step * reach(v))) continue;
      mesh_.vertices.col(v) += step * gradient / slope;
    }
    if (mesh_.normals.cols() > 0) mesh_.normals = normals_;
  }

 private:
  // Calls visit(b, c) for the triangles (v, b, c) around a vertex.
  template <class Visit>
  void for_each_triangle(Index v, const Visit& visit) const {
    for (Index i = first_[v]; i < first_[v + 1]; ++i) {
      const Index corner = corner_[i], t = corner / 3;
      visit(mesh_.triangles((corner + 1) % 3, t), mesh_.triangles((corner + 2) % 3, t));
    }
  }

  void take_normals(const Jet<3>& jet) {
    normals_.resize(3, mesh_.vertices.cols());
    for (Index v = 0; v < normals_.cols(); ++v) {
      const double slope = jet.gradient.col(v).norm();
      const bool known = slope > 0 && std::isfinite(slope);
      normals_.col(v).setZero();
      if (known) normals_.col(v) = -jet.gradient.col(v) / slope;
    }
  }

  void fix_sharp_vertices() {
    fixed_.assign(mesh_.vertices.cols(), 0);
    for (Index v = 0; v < mesh_.vertices.cols(); ++v)
      for_each_triangle(v, [&](int b, int c) {
        const Point<3> area = area_vector(mesh_.vertices.col(v), mesh_.vertices.col(b), mesh_.vertices.col(c));
        if (!(area.dot(normals_.col(v)) >= largest_tilt * area.norm())) fixed_[v] = 1;
      });
  }

  [[nodiscard]] double least_roundness(Index v, const Point<3>& p) const {
    double least = std::numeric_limits<double>::infinity();
    for_each_triangle(v, [&](int b, int c) {
      least = std::min(least, signed_roundness(p, mesh_.vertices.col(b), mesh_.vertices.col(c), normals_.col(v)));
    });
    return least;
  }

  // Mean distance to the neighbours.
  [[nodiscard]] double reach(Index v) const {
    double sum = 0, count = 0;
    for_each_triangle(v, [&](int b, int /*c*/) {
      sum += (mesh_.vertices.col(b) - mesh_.vertices.col(v)).norm();
      count += 1;
    });
    return sum / count;
  }

  void relax(Index v) {
    Point<3> mean = Point<3>::Zero();
    double count = 0;
    for_each_triangle(v, [&](int b, int /*c*/) {
      mean += mesh_.vertices.col(b);
      count += 1;
    });
    const Point<3> p = mesh_.vertices.col(v), n = normals_.col(v), shift = mean / count - p;
    const double now = least_roundness(v, p);
    for (const double share : {1.0, 0.5, 0.25}) {
      const Point<3> target = p + share * (shift - n.dot(shift) * n);
      if (!(least_roundness(v, target) > now)) continue;
      mesh_.vertices.col(v) = target;
      return;
    }
  }

  const Field<3>& field_;
  double level_;
  Mesh& mesh_;
  std::vector<Index> first_, corner_;  // corners (entries of the triangles) of each vertex
  Points<3> normals_;
  std::vector<char> fixed_;
};

}  // namespace

Mesh optimize_mesh(const Field<3>& field, Mesh mesh, const OptimizeMeshOptions& options) {
  require(options.iterations >= 1, "optimize_mesh", "iterations", options.iterations, "must be at least 1");
  require(std::isfinite(options.level), "optimize_mesh", "level", options.level, "must be finite");
  require(mesh.vertices.allFinite(), "optimize_mesh", "mesh", "(not finite)", "every vertex must be finite");
  const Topology found = topology(mesh);
  require(found.watertight() && found.manifold() && found.vertices == mesh.vertices.cols(), "optimize_mesh", "mesh",
          "(not a closed manifold)", "must be a closed manifold without unused vertices, as from polygonize()");
  Optimizer optimizer(field, options.level, mesh);
  for (int i = 0; i < options.iterations; ++i) {
    report(options.progress, "optimize", static_cast<double>(i) / options.iterations);
    optimizer.relax();
    optimizer.project();
  }
  optimizer.project();
  report(options.progress, "optimize", 1);
  return mesh;
}

double smallest_angle(const Mesh& mesh) {
  double smallest = std::numbers::pi;
  for (Index t = 0; t < mesh.triangles.cols(); ++t)
    for (int c = 0; c < 3; ++c) {
      const Point<3> apex = mesh.vertices.col(mesh.triangles(c, t));
      const Point<3> u = mesh.vertices.col(mesh.triangles((c + 1) % 3, t)) - apex;
      const Point<3> v = mesh.vertices.col(mesh.triangles((c + 2) % 3, t)) - apex;
      smallest = std::min(smallest, std::atan2(u.cross(v).norm(), u.dot(v)));
    }
  return smallest * 180 / std::numbers::pi;
}

}  // namespace csrbf
