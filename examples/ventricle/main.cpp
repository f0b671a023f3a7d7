#include "csrbf/core/error.hpp"
#include "csrbf/implicit/polygonize.hpp"
#include "csrbf/implicit/render.hpp"
#include "csrbf/io/image.hpp"
#include "csrbf/io/mesh.hpp"
#include "csrbf/io/model.hpp"
#include "csrbf/io/points.hpp"
#include "csrbf/io/polylines.hpp"
#include "csrbf/surface/reconstruct_contours.hpp"

#include <Eigen/Geometry>

#include <cmath>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <numbers>
#include <string>
#include <vector>

namespace {

using csrbf::Index;
using csrbf::Point;
using csrbf::Points;
using std::numbers::pi;

constexpr const char* usage =
    "usage: csrbf-ventricle FOLDER\n\n"
    "Draws the contours of a left ventricle, as a physician would on short-axis images, reconstructs the wall from\n"
    "them and reports its distance from the true one. Writes contours.csv, contours.png, wall.ply, wall.csrbf, "
    "wall.png.\n";

// Millimetres. The wall is what is inside the epicardium and outside the endocardium, below the base.
constexpr double base = 25, slice_spacing = 9;
constexpr int slices = 10, points = 48;

// A half ellipsoid whose cross-sections are oval and turn towards the apex; radius 0 below the apex.
struct Sheet {
  double radius, apex, ovalness, folds;

  [[nodiscard]] double at(double angle, double z) const {
    const double along = z / (z < 0 ? apex : 2.5 * base), twist = 0.9 * z / apex;
    const double profile = std::sqrt(std::max(0.0, 1 - along * along));
    return radius * profile *
           (1 + ovalness * std::cos(2 * (angle - twist)) + folds * std::cos(5 * (angle - 2 * twist)));
  }
};

constexpr Sheet epicardium{33, 65, 0.06, 0}, endocardium{22, 54, 0.06, 0.05};

// Distance to a sheet within the slice, positive inside.
double depth(const Sheet& sheet, const Point<3>& p) {
  return sheet.at(std::atan2(p.y(), p.x()), p.z()) - std::hypot(p.x(), p.y());
}

struct Contours {
  std::vector<Point<3>> points;
  std::vector<double> contour;

  void add(const Sheet& sheet, double z) {
    if (sheet.at(0, z) <= 0) return;
    const double number = contour.empty() ? 1 : contour.back() + 1;
    for (int i = 0; i < ::points; ++i) {
      const double angle = 2 * pi * i / ::points, r = sheet.at(angle, z);
      points.emplace_back(r * std::cos(angle), r * std::sin(angle), z);
      contour.push_back(number);
    }
  }

  [[nodiscard]] csrbf::PointCloud cloud() const {
    const auto n = static_cast<Index>(points.size());
    csrbf::PointCloud cloud;
    cloud.points = Eigen::Map<const Points<3>>(points.front().data(), 3, n);
    cloud.properties = {{"contour", "int", Eigen::Map<const Eigen::VectorXd>(contour.data(), n)}};
    return cloud;
  }
};

Contours draw() {
  Contours contours;
  for (int k = 0; k < slices; ++k)
    for (const Sheet& sheet : {epicardium, endocardium}) contours.add(sheet, base - slice_spacing * k);
  return contours;
}

// Wires along the curves, to look at.
csrbf::Mesh wires(const csrbf::Polylines& lines, double radius) {
  constexpr int sides = 8;
  const Index edges = lines.edges.cols();
  csrbf::Mesh mesh;
  mesh.vertices.resize(3, 2 * sides * edges);
  mesh.triangles.resize(3, 2 * sides * edges);
  for (Index e = 0; e < edges; ++e) {
    const Point<3> a = lines.vertices.col(lines.edges(0, e)), b = lines.vertices.col(lines.edges(1, e));
    const Point<3> along = (b - a).normalized(), u = along.unitOrthogonal(), v = along.cross(u);
    for (int s = 0; s < sides; ++s) {
      const double angle = 2 * pi * s / sides;
      const Point<3> out = radius * (std::cos(angle) * u + std::sin(angle) * v);
      const auto at = static_cast<int>(2 * sides * e), next = (s + 1) % sides;
      mesh.vertices.col(at + s) = a + out;
      mesh.vertices.col(at + sides + s) = b + out;
      mesh.triangles.col(at + 2 * s) << at + s, at + next, at + sides + next;
      mesh.triangles.col(at + 2 * s + 1) << at + s, at + sides + next, at + sides + s;
    }
  }
  return mesh;
}

void say_errors(const csrbf::Mesh& mesh) {
  double sum = 0, largest = 0;
  Index count = 0;
  for (const auto& p : mesh.vertices.colwise()) {
    if (p.z() > base) continue;  // the cap
    const double error = std::min(std::abs(depth(epicardium, p)), std::abs(depth(endocardium, p)));
    sum += error * error;
    largest = std::max(largest, error);
    ++count;
  }
  std::printf("distance to the true wall within the slices, below the base: rms %.2f mm, largest %.2f mm\n",
              std::sqrt(sum / static_cast<double>(count)), largest);
}

void run(const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  const auto file = [&](const char* name) { return (folder / name).string(); };
  csrbf::write_points(file("contours.csv"), draw().cloud());

  const csrbf::Polylines contours = csrbf::read_polylines(file("contours.csv"));
  const csrbf::Reconstruction wall = csrbf::reconstruct_contours(contours);
  const csrbf::Mesh mesh = csrbf::polygonize(*wall.field);
  csrbf::write_model(file("wall.csrbf"), *wall.field);
  csrbf::write_mesh(file("wall.ply"), mesh);

  csrbf::RenderOptions look{.width = 640, .height = 640, .view = {35, 35}, .material = {0.75F, 0.30F, 0.27F}};
  look.frame = csrbf::bounding_box<3>(mesh.vertices);
  csrbf::write_png(file("wall.png"), csrbf::render(mesh, look));
  csrbf::write_png(file("contours.png"), csrbf::render(wires(contours, 0.5), look));

  const csrbf::Topology topology = csrbf::topology(mesh);
  std::printf("%lld points on %lld contours in %lld slices: %s, %lld component(s), Euler characteristic %lld\n",
              static_cast<long long>(wall.report.points), static_cast<long long>(wall.report.contours->contours),
              static_cast<long long>(wall.report.contours->slices),
              topology.watertight() ? "watertight" : "not watertight", static_cast<long long>(topology.components),
              static_cast<long long>(topology.euler));
  say_errors(mesh);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2 || argv[1][0] == '-') {
    const bool asked = argc == 2 && (std::string(argv[1]) == "--help" || std::string(argv[1]) == "-h");
    std::fputs(usage, asked ? stdout : stderr);
    return asked ? 0 : 2;
  }
  try {
    run(argv[1]);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "csrbf-ventricle: %s\n", error.what());
    return 1;
  }
  return 0;
}
