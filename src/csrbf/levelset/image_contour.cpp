#include "csrbf/levelset/image_contour.hpp"

#include "csrbf/core/error.hpp"

#include <Eigen/Geometry>

namespace csrbf {
namespace {

// A field in the axes of the image: voxel coordinates times the spacing.
template <int Dim>
class InImage final : public Field<Dim> {
 public:
  using Map = Eigen::Transform<double, Dim, Eigen::Affine>;

  InImage(const Field<Dim>& field, const Grid& grid) : field_(field) {
    require(grid.dimension() == Dim, "image_contour", "dimension of the image", grid.dimension(),
            "must be that of the level set, " + std::to_string(Dim));
    (void)grid.to_voxel<Dim>();  // throws when there is none
    to_physical_ = grid.to_physical<Dim>();
    to_physical_.linear() = grid.direction.topLeftCorner<Dim, Dim>();
    for (Index a = 0; a < Dim; ++a) {
      box_.lo[a] = -0.5 * grid.spacing[a];
      box_.hi[a] = (static_cast<double>(grid.size[a]) - 0.5) * grid.spacing[a];
    }
  }

  void evaluate_block(const PointsRef<Dim>& x, const JetBlock& out) const override {
    const Points<Dim> at = to_physical_ * Points<Dim>(x);
    field_.evaluate_block(at, out);
    const auto& A = to_physical_.linear();
    for (Index i = 0; out.gradient != nullptr && i < x.cols(); ++i) {
      Eigen::Map<Point<Dim>> gradient(out.gradient + Dim * i);
      gradient = (A.transpose() * gradient).eval();
    }
    for (Index i = 0; out.hessian != nullptr && i < x.cols(); ++i) {
      double* entries = out.hessian + symmetric_size<Dim> * i;
      Eigen::Matrix<double, Dim, Dim> H;
      for (Index a = 0, k = 0; a < Dim; ++a)
        for (Index b = a; b < Dim; ++b, ++k) H(a, b) = H(b, a) = entries[k];
      H = (A.transpose() * H * A).eval();
      for (Index a = 0, k = 0; a < Dim; ++a)
        for (Index b = a; b < Dim; ++b, ++k) entries[k] = H(a, b);
    }
  }
  [[nodiscard]] Box<Dim> bounds() const override { return box_; }
  [[nodiscard]] double feature_size() const override { return field_.feature_size(); }
  [[nodiscard]] const Map& to_physical() const { return to_physical_; }

 private:
  const Field<Dim>& field_;
  Map to_physical_;
  Box<Dim> box_;
};

// Middles of the edges of cells at whose ends the field has different signs.
Points<3> sign_changes(const Field<3>& field, int resolution) {
  const Box<3> box = field.bounds();
  const double cell = box.extent().maxCoeff() / resolution;
  GridAxes<3> axes;
  std::array<Index, 3> nodes{};
  for (Index a = 0; a < 3; ++a) {
    nodes[a] = 1 + std::max<Index>(1, static_cast<Index>(std::ceil(box.extent()[a] / cell)));
    axes[a] = Eigen::VectorXd::LinSpaced(nodes[a], box.lo[a], box.hi[a]);
  }
  const Eigen::VectorXd f = field.evaluate_grid(axes);
  std::vector<Point<3>> found;
  const std::array<Index, 3> strides{1, nodes[0], nodes[0] * nodes[1]};
  for (Index i = 0; i < f.size(); ++i) {
    const std::array<Index, 3> at{i % nodes[0], i / nodes[0] % nodes[1], i / strides[2]};
    for (Index a = 0; a < 3; ++a) {
      if (at[a] + 1 == nodes[a] || (f[i] > 0) == (f[i + strides[a]] > 0)) continue;
      Point<3> p(axes[0][at[0]], axes[1][at[1]], axes[2][at[2]]);
      p[a] = 0.5 * (axes[a][at[a]] + axes[a][at[a] + 1]);
      found.push_back(p);
    }
  }
  return Points<3>::NullaryExpr(3, std::ssize(found), [&](Index row, Index i) { return found[i][row]; });
}

// Do all corners of a triangle lie in one side of the box?
bool is_in_side(const Eigen::Matrix3d& corners, const Box<3>& box, double tolerance) {
  for (Index a = 0; a < 3; ++a)
    for (const double side : {box.lo[a], box.hi[a]})
      if ((corners.row(a).array() - side).abs().maxCoeff() < tolerance) return true;
  return false;
}

struct Measures {
  double area = 0, volume = 0;
};

// Of the flat triangle; the volume is that of the cone from 0.
Measures of_triangle(const Eigen::Matrix3d& corners) {
  const Point<3> twice = (corners.col(1) - corners.col(0)).cross(corners.col(2) - corners.col(0));
  return {0.5 * twice.norm(), corners.determinant() / 6};
}

// Of the quadratic patch through the corners and the middles of the edges, which lie on the circles that meet the
// normals at both ends: e (n_b - n_a) / 8 above the edge e from a to b. Patches over neighbours share their edges.
Measures of_patch(const Eigen::Matrix3d& corners, const Eigen::Matrix3d& normals) {
  Eigen::Matrix3d middles;
  for (Index k = 0; k < 3; ++k) {
    const Index a = (k + 1) % 3, b = (k + 2) % 3;
    const double height = (normals.col(b) - normals.col(a)).dot(corners.col(b) - corners.col(a)) / 8;
    middles.col(k) = 0.5 * (corners.col(a) + corners.col(b)) + height * (normals.col(a) + normals.col(b)).normalized();
  }
  // Six points, exact for polynomials of degree 4 (Dunavant 1985).
  struct Node {
    double at, weight;
  };
  constexpr std::array<Node, 2> nodes{{{0.445948490915965, 0.223381589678011}, {0.091576213509771, 0.109951743655322}}};
  Measures sum;
  for (const Node& node : nodes)
    for (Index apex = 0; apex < 3; ++apex) {
      Point<3> l = Point<3>::Constant(node.at);
      l[apex] = 1 - 2 * node.at;
      Point<3> x = Point<3>::Zero();
      Eigen::Matrix3d slope;  // by the barycentric coordinates
      for (Index k = 0; k < 3; ++k) {
        const Index a = (k + 1) % 3, b = (k + 2) % 3;
        x += l[k] * (2 * l[k] - 1) * corners.col(k) + 4 * l[a] * l[b] * middles.col(k);
        slope.col(k) = (4 * l[k] - 1) * corners.col(k) + 4 * (l[a] * middles.col(b) + l[b] * middles.col(a));
      }
      const Point<3> normal = (slope.col(1) - slope.col(0)).cross(slope.col(2) - slope.col(0));
      sum.area += 0.5 * node.weight * normal.norm();
      sum.volume += 0.5 * node.weight * x.dot(normal) / 3;
    }
  return sum;
}

// Area and volume of a mesh in the axes of the image, whose unit vectors are the columns of `axes`.
void measure(const Box<3>& box, const Eigen::Matrix3d& axes, double tolerance, ImageSurface& surface) {
  const Mesh& mesh = surface.mesh;
  const Eigen::Matrix3d for_normals = axes.inverse().transpose();
  const double side = axes.determinant() < 0 ? -1 : 1;  // of mirrored axes
  for (Index t = 0; t < mesh.triangles.cols(); ++t) {
    Eigen::Matrix3d corners, normals;
    for (Index k = 0; k < 3; ++k) {
      corners.col(k) = mesh.vertices.col(mesh.triangles(k, t)) - box.center();
      normals.col(k) = (for_normals * mesh.normals.col(mesh.triangles(k, t))).normalized();
    }
    const bool is_cap = is_in_side(corners.colwise() + box.center(), box, tolerance);
    corners = (axes * corners).eval();
    const Measures flat = of_triangle(corners);
    if (is_cap) {
      surface.volume += side * flat.volume;
      continue;
    }
    const Measures patch = normals.allFinite() ? of_patch(corners, normals) : flat;
    surface.area += patch.area;
    surface.volume += side * patch.volume;
    surface.area_error += std::abs(patch.area - flat.area);
    surface.volume_error += std::abs(patch.volume - flat.volume);
  }
}

}  // namespace

ImageContour image_contour(const Field<2>& field, const Grid& grid, const ImageContourOptions& options) {
  const InImage<2> plane(field, grid);
  ImageContour contour;
  contour.image = plane.bounds();
  contour.placement << grid.direction, grid.origin;
  constexpr int finest = 4096;  // cells: bounds the cost of large images; by hand
  const int resolution =
      options.resolution != 0 ? options.resolution : std::min(finest, 2 * automatic_resolution(plane));
  contour.lines = contour_lines(plane, {.resolution = resolution, .progress = options.progress});
  return contour;
}

ImageSurface image_contour(const Field<3>& field, const Grid& grid, const ImageContourOptions& options) {
  const InImage<3> volume(field, grid);
  const Box<3> box = volume.bounds();
  ImageSurface surface;
  const int resolution = options.resolution != 0 ? options.resolution : automatic_resolution(volume);
  require(resolution > 0 && resolution <= 4096, "image_contour", "resolution", resolution, "must be 1 to 4096");
  const Points<3> seeds = sign_changes(volume, resolution);
  if (seeds.cols() == 0) {  // all inside or all outside
    surface.volume =
        volume(box.center()) > 0 ? box.extent().prod() * std::abs(volume.to_physical().linear().determinant()) : 0;
    return surface;
  }
  surface.mesh =
      polygonize(volume, {.resolution = resolution, .bounds = box, .seeds = seeds, .progress = options.progress});
  constexpr double thin = 2e-3;  // of a cell: caps lie a thousandth outside the box
  const auto& map = volume.to_physical();
  measure(box, map.linear(), thin * box.extent().maxCoeff() / resolution, surface);
  Mesh& mesh = surface.mesh;
  mesh.space = grid.space;
  mesh.vertices = (map * mesh.vertices).eval();
  mesh.normals = (map.linear().inverse().transpose() * mesh.normals).colwise().normalized().eval();
  if (map.linear().determinant() < 0) mesh.triangles.row(1).swap(mesh.triangles.row(2));
  return surface;
}

}  // namespace csrbf
