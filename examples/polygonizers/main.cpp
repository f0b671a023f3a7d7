#include "shapes.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/implicit/mesh/mesh_distance.hpp"
#include "csrbf/implicit/mesh/optimize_mesh.hpp"
#include "csrbf/implicit/polygonize.hpp"
#include "csrbf/implicit/sample_particles.hpp"
#include "csrbf/io/mesh.hpp"

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>

namespace {

constexpr const char* usage =
    "usage: csrbf-polygonizers [--resolution N] [--mesh FILE]\n\n"
    "Polygonizes five solids, and the distance to a closed mesh if one is given, with every method of the library, "
    "and\n"
    "prints a table: triangles, connected components, Euler characteristic, whether the mesh is closed and manifold,\n"
    "mean and largest distance of the triangles' centroids from the surface (|f| / |grad f|, in cells), the smallest\n"
    "angle in degrees and seconds. The exit status is 1 if a mesh is not closed, not manifold or has the wrong "
    "topology.\n";

using csrbf::Index;
using csrbf::Mesh;
using csrbf::Points;
using csrbf::PolygonizeMethod;

class Table {
 public:
  explicit Table(int resolution) : resolution_(resolution) {
    std::puts(
        "| shape          | method              | triangles | comp. | euler | closed |    mean |     max | angle | "
        "seconds |\n|---|---|---|---|---|---|---|---|---|---|");
  }

  void add(const Shape& shape) {
    for (const PolygonizeMethod method : {PolygonizeMethod::marching_cubes, PolygonizeMethod::marching_tetrahedra,
                                          PolygonizeMethod::dual_contouring, PolygonizeMethod::adaptive}) {
      add_mesh(shape, std::string(name_of(method)), shape.euler,
               [&] { return polygonize(*shape.field, {.resolution = resolution_, .method = method}); });
    }
    // Surface tracking (Bloomenthal 1988) is how polygonize() finds the cells: from one seed, one component.
    const Points<3> seed = shape.field->seeds().leftCols(1);
    add_mesh(shape, "tracked from a seed", std::nullopt,
             [&] { return polygonize(*shape.field, {.resolution = resolution_, .seeds = seed}); });
    add_mesh(shape, "cubes, optimized", shape.euler,
             [&] { return optimize_mesh(*shape.field, polygonize(*shape.field, {.resolution = resolution_})); });
    add_particles(shape);
  }

  [[nodiscard]] bool all_right() const { return all_right_; }

 private:
  using Clock = std::chrono::steady_clock;

  static double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
  }

  // |f| / |grad f| in cells.
  [[nodiscard]] Eigen::ArrayXd distances(const Shape& shape, const Points<3>& points) const {
    const csrbf::Jet<3> jet = shape.field->evaluate(points, csrbf::Derivatives::gradient);
    const double cell = shape.field->bounds().extent().maxCoeff() / resolution_;
    return jet.value.array().abs() / (jet.gradient.colwise().norm().transpose().array() * cell);
  }

  template <class Make>
  void add_mesh(const Shape& shape, const std::string& method, std::optional<Index> euler, const Make& make) {
    const Clock::time_point start = Clock::now();
    const Mesh mesh = make();
    const double seconds = seconds_since(start);
    Points<3> centroids(3, mesh.triangles.cols());
    for (Index t = 0; t < centroids.cols(); ++t)
      centroids.col(t) = mesh.vertices(Eigen::all, mesh.triangles.col(t)).rowwise().mean();
    const Eigen::ArrayXd distance = distances(shape, centroids);
    const csrbf::Topology found = topology(mesh);
    const bool closed = found.watertight() && found.manifold();
    all_right_ = all_right_ && closed && (!euler.has_value() || found.euler == *euler);
    std::printf("| %-14s | %-19s | %9lld | %5lld | %5lld | %-6s | %7.5f | %7.5f | %5.1f | %7.3f |\n",
                shape.name.c_str(), method.c_str(), static_cast<long long>(found.triangles),
                static_cast<long long>(found.components), static_cast<long long>(found.euler), closed ? "yes" : "no",
                distance.mean(), distance.maxCoeff(), smallest_angle(mesh), seconds);
  }

  void add_particles(const Shape& shape) {
    const Clock::time_point start = Clock::now();
    constexpr double cells = 3;  // between neighbours
    const csrbf::Box<3> box = shape.field->bounds();
    const double spacing = cells * box.extent().maxCoeff() / (resolution_ * box.diagonal());
    const csrbf::Particles particles = sample_particles(*shape.field, {.spacing = std::min(spacing, 0.1)});
    const double seconds = seconds_since(start);
    const Eigen::ArrayXd distance = distances(shape, particles.points);
    std::printf("| %-14s | %-19s | %9s | %5s | %5s | %-6s | %7.5f | %7.5f | %5s | %7.3f |\n", shape.name.c_str(),
                (std::to_string(particles.points.cols()) + " particles").c_str(), "-", "-", "-", "-", distance.mean(),
                distance.maxCoeff(), "-", seconds);
  }

  int resolution_;
  bool all_right_ = true;
};

}  // namespace

int main(int argc, char** argv) {
  int resolution = 64;
  std::string mesh_file;
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    if (argument == "--help" || argument == "-h") {
      std::fputs(usage, stdout);
      return 0;
    }
    const bool has_value = i + 1 < argc;
    if (argument == "--resolution" && has_value) {
      resolution = std::atoi(argv[++i]);
    } else if (argument == "--mesh" && has_value) {
      mesh_file = argv[++i];
    } else {
      std::fputs(usage, stderr);
      return 2;
    }
  }
  try {
    std::vector<Shape> shapes = make_shapes(std::max(resolution, 1));
    if (!mesh_file.empty()) {
      const auto field = std::make_shared<csrbf::MeshDistance>(csrbf::read_mesh(mesh_file));
      shapes.push_back({"mesh", field, std::nullopt});
    }
    Table table(resolution);
    for (const Shape& shape : shapes) table.add(shape);
    return table.all_right() ? 0 : 1;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "csrbf-polygonizers: %s\n", error.what());
    return 1;
  }
}
