#include "csrbf/implicit/render/camera.hpp"

#include <gtest/gtest.h>

#include <random>

namespace csrbf::camera_test {
namespace {

constexpr double rounding = 1e-12;

// Where a point appears, in pixels from the left and the top.
Point<2> project(const Camera& camera, const Point<3>& p) {
  const Point<3> d = p - camera.position;
  const double scale = camera.pixel_at(d.dot(camera.forward));
  return {0.5 * camera.width + d.dot(camera.right) / scale, 0.5 * camera.height - d.dot(camera.up) / scale};
}

Points<3> random_points(Index n) {
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  return Points<3>::NullaryExpr(3, n, [&] { return normal(random); });
}

TEST(Camera, LooksFromAzimuthAndElevation) {
  const Points<3> points = random_points(10);
  const Camera front = frame_points(points, {.view = {0, 0}});
  EXPECT_TRUE(front.forward.isApprox(-Point<3>::UnitX(), rounding));
  EXPECT_TRUE(front.right.isApprox(Point<3>::UnitY(), rounding));
  EXPECT_TRUE(front.up.isApprox(Point<3>::UnitZ(), rounding));
  EXPECT_TRUE(frame_points(points, {.view = {90, 0}}).forward.isApprox(-Point<3>::UnitY(), rounding));
  const Camera top = frame_points(points, {.view = {0, 90}});
  EXPECT_TRUE(top.forward.isApprox(-Point<3>::UnitZ(), rounding));
  EXPECT_TRUE(top.up.isApprox(-Point<3>::UnitX(), rounding));
}

TEST(Camera, TheUpAxisPermutesTheCoordinates) {
  const Points<3> points = random_points(10);
  EXPECT_TRUE(frame_points(points, {.view = {0, 0}, .up = UpAxis::y}).up.isApprox(Point<3>::UnitY(), rounding));
  EXPECT_TRUE(frame_points(points, {.view = {0, 0}, .up = UpAxis::y}).forward.isApprox(-Point<3>::UnitZ(), rounding));
  EXPECT_TRUE(frame_points(points, {.view = {0, 0}, .up = UpAxis::x}).forward.isApprox(-Point<3>::UnitY(), rounding));
}

TEST(Camera, RaysPassThroughThePointsThatProjectToTheirPixel) {
  const Points<3> points = random_points(100);
  for (const double field_of_view : {0.0, 20.0, 90.0}) {
    const Camera camera = frame_points(points, {.view = {40, -25}, .field_of_view = field_of_view});
    for (Index i = 0; i < points.cols(); ++i) {
      const Point<2> pixel = project(camera, points.col(i));
      const Ray ray = camera.ray(pixel[0], pixel[1]);
      EXPECT_NEAR(ray.direction.norm(), 1, rounding);
      const Point<3> d = points.col(i) - ray.origin;
      EXPECT_GT(d.dot(ray.direction), 0);
      EXPECT_NEAR((d - d.dot(ray.direction) * ray.direction).norm(), 0, 1e-10);
    }
  }
}

TEST(Camera, AllPointsFillThePictureUpToTheMarginInOneDirection) {
  const Points<3> points = random_points(100);
  for (const double field_of_view : {0.0, 20.0, 100.0}) {
    for (const double azimuth : {0.0, 70.0, 200.0}) {
      const double margin = 0.1;
      const Camera camera = frame_points(
          points,
          {.width = 300, .height = 200, .view = {azimuth, 30}, .field_of_view = field_of_view, .margin = margin});
      Box<2> seen;
      for (Index i = 0; i < points.cols(); ++i) {
        const Point<2> pixel = project(camera, points.col(i));
        seen.add(Point<2>(pixel[0] / camera.width, pixel[1] / camera.height));
      }
      EXPECT_GE(seen.lo.minCoeff(), margin - rounding);
      EXPECT_LE(seen.hi.maxCoeff(), 1 - margin + rounding);
      EXPECT_NEAR(seen.extent().maxCoeff(), 1 - 2 * margin, 1e-9);
      const Index tight = seen.extent()[0] > seen.extent()[1] ? 0 : 1;
      EXPECT_NEAR(seen.center()[tight], 0.5, 1e-9);
    }
  }
}

TEST(Camera, PointsBehindEachOtherAreInFrontOfTheCamera) {
  Points<3> points(3, 2);
  points << 0, 1,  //
      0, 0,        //
      0, 0;
  for (const double field_of_view : {0.0, 20.0}) {
    const Camera camera = frame_points(points, {.view = {0, 0}, .field_of_view = field_of_view});
    EXPECT_GT(camera.pixel, 0);
    EXPECT_GT((points.col(1) - camera.position).dot(camera.forward), 0);
  }
}

}  // namespace
}  // namespace csrbf::camera_test
