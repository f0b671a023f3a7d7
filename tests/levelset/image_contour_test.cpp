#include "csrbf/levelset/image_contour.hpp"

#include "csrbf/core/error.hpp"

#include <Eigen/Geometry>

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace csrbf::image_contour_test {
namespace {

constexpr double pi = std::numbers::pi;

// R^2 - |x - c|^2
template <int Dim>
class Ball final : public Field<Dim> {
 public:
  Ball(const Point<Dim>& center, double radius, double feature_size)
      : center_(center), radius_(radius), feature_size_(feature_size) {}
  void evaluate_block(const PointsRef<Dim>& x, const JetBlock& out) const override {
    for (Index i = 0; i < x.cols(); ++i) {
      const Point<Dim> d = x.col(i) - center_;
      out.value[i] = radius_ * radius_ - d.squaredNorm();
      if (out.gradient != nullptr) Eigen::Map<Point<Dim>>(out.gradient + Dim * i) = -2 * d;
    }
  }
  [[nodiscard]] Box<Dim> bounds() const override { return {}; }
  [[nodiscard]] double feature_size() const override { return feature_size_; }

 private:
  Point<Dim> center_;
  double radius_, feature_size_;
};

// A volume of 40 x 32 x 12 with axes that are turned in space and partly mirrored.
Grid turned_grid() {
  Grid grid;
  grid.size = {40, 32, 12};
  grid.spacing = {0.5, 0.6, 2};
  grid.origin = {30, -20, 5};
  grid.direction = Eigen::AngleAxisd(0.7, Point<3>(1, 2, -1).normalized()).toRotationMatrix();
  grid.direction.col(1) *= -1;
  return grid;
}

Point<3> at(const Grid& grid, double x, double y, double z) {
  return grid.to_physical<3>() * Point<3>(x, y, z);
}

double mesh_volume(const Mesh& mesh) {
  double volume = 0;
  for (Index t = 0; t < mesh.triangles.cols(); ++t) {
    Eigen::Matrix3d corners;
    for (Index k = 0; k < 3; ++k) corners.col(k) = mesh.vertices.col(mesh.triangles(k, t));
    volume += corners.determinant() / 6;
  }
  return volume;
}

TEST(ImageContour, MeasuresABallWithinItsEstimates) {
  const Grid grid = turned_grid();
  const double r = 6;
  const Ball<3> ball(at(grid, 20, 15, 6), r, 0.5);
  const ImageSurface found = image_contour(ball, grid);
  EXPECT_NEAR(found.volume, 4 * pi * r * r * r / 3, found.volume_error);
  EXPECT_NEAR(found.area, 4 * pi * r * r, found.area_error);
  EXPECT_LT(found.volume_error, 0.01 * found.volume);
  EXPECT_GT(mesh_volume(found.mesh), 0.98 * found.volume);  // outwards, though the axes are mirrored
  EXPECT_TRUE(topology(found.mesh).watertight());
  for (Index i = 0; i < found.mesh.vertices.cols(); ++i) {
    const Point<3> d = found.mesh.vertices.col(i) - at(grid, 20, 15, 6);
    ASSERT_NEAR(d.norm(), r, 1e-5);
    ASSERT_NEAR(found.mesh.normals.col(i).dot(d) / r, 1, 1e-5);
  }
}

TEST(ImageContour, OfABallConvergesToFourthOrder) {
  const Grid grid = turned_grid();
  const double r = 6, volume = 4 * pi * r * r * r / 3, area = 4 * pi * r * r;
  const Ball<3> ball(at(grid, 20, 15, 6), r, 0.5);
  std::array<double, 3> volume_errors{}, area_errors{};
  for (std::size_t k = 0; k < 3; ++k) {
    const ImageSurface found = image_contour(ball, grid, {.resolution = 20 << k});
    volume_errors[k] = std::abs(found.volume - volume);
    area_errors[k] = std::abs(found.area - area);
  }
  // Cells lie differently in each mesh: the order is taken over two halvings.
  EXPECT_GT(std::log2(volume_errors[0] / volume_errors[2]) / 2, 3.5);
  EXPECT_GT(std::log2(area_errors[0] / area_errors[2]) / 2, 3.5);
}

TEST(ImageContour, IsCutOffAtTheBorderOfTheVolume) {
  const Grid grid = turned_grid();
  const double r = 5;
  // The centre lies on the outer border of the first slice.
  const ImageSurface half = image_contour(Ball<3>(at(grid, 20, 15, -0.5), r, 0.25), grid);
  EXPECT_NEAR(half.volume, 2 * pi * r * r * r / 3, half.volume_error);
  EXPECT_NEAR(half.area, 2 * pi * r * r, 2e-3 * 2 * pi * r * r);  // the border itself does not count
  EXPECT_TRUE(topology(half.mesh).watertight());
}

TEST(ImageContour, OfAllOrNothingHasNoMesh) {
  Grid grid = turned_grid();
  class Constant final : public Field<3> {
   public:
    explicit Constant(double value) : value_(value) {}
    void evaluate_block(const PointsRef<3>& x, const JetBlock& out) const override {
      std::fill_n(out.value, x.cols(), value_);
      if (out.gradient != nullptr) std::fill_n(out.gradient, 3 * x.cols(), 0.0);
    }
    [[nodiscard]] Box<3> bounds() const override { return {}; }
    [[nodiscard]] double feature_size() const override { return 1; }

   private:
    double value_;
  };
  EXPECT_NEAR(image_contour(Constant(1), grid).volume, 20 * 19.2 * 24, 1e-9);
  EXPECT_EQ(image_contour(Constant(-1), grid).volume, 0);
  EXPECT_EQ(image_contour(Constant(1), grid).mesh.vertices.cols(), 0);
}

TEST(ImageContour, InThePlaneLiesInTheImageAndIsPlacedInSpace) {
  Grid grid;
  grid.axes = 2;
  grid.size = {50, 40, 1};
  grid.spacing = {0.5, 0.4, 1};
  grid.origin = {-7, 3, 9};
  grid.direction.topLeftCorner<2, 2>() = Eigen::Rotation2Dd(0.6).toRotationMatrix();
  const double r = 4;
  const Point<2> middle = grid.to_physical<2>() * Point<2>(25, 20);
  const ImageContour found = image_contour(Ball<2>(middle, r, 0.2), grid);
  EXPECT_NEAR(found.lines.area, pi * r * r, found.lines.area_error);
  EXPECT_NEAR(found.lines.length, 2 * pi * r, found.lines.length_error);
  EXPECT_NEAR(found.image.lo.x(), -0.25, 1e-12);
  EXPECT_NEAR(found.image.hi.y(), 39.5 * 0.4, 1e-12);
  for (Index i = 0; i < found.lines.points.cols(); ++i) {
    const Point<2> p = found.lines.points.col(i);
    const Point<3> placed = found.placement * Eigen::Vector4d(p.x(), p.y(), 0, 1);
    ASSERT_NEAR((placed.head<2>() - middle).norm(), r, 1e-6);
    ASSERT_EQ(placed.z(), 9);
  }
}

TEST(ImageContour, RefusesOtherDimensionsAndResolutions) {
  EXPECT_THROW((void)image_contour(Ball<2>(Point<2>(0, 0), 1, 1), turned_grid()), InvalidInput);
  EXPECT_THROW((void)image_contour(Ball<3>(at(turned_grid(), 20, 15, 6), 3, 1), turned_grid(), {.resolution = -1}),
               InvalidInput);
}

}  // namespace
}  // namespace csrbf::image_contour_test
