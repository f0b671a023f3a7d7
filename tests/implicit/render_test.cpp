#include "csrbf/implicit/render.hpp"

#include "csrbf/core/parallel.hpp"
#include "csrbf/implicit/render/mesh_scene.hpp"
#include "csrbf/implicit/render/render_tile.hpp"
#include "implicit/mesh_testing.hpp"

#include <gtest/gtest.h>

#include <numbers>

namespace csrbf::render_test {
namespace {

using Color = std::array<int, 3>;

Color pixel(const RgbImage& image, int x, int y) {
  const std::size_t i = 3 * (static_cast<std::size_t>(y) * image.width + x);
  return {image.pixels[i], image.pixels[i + 1], image.pixels[i + 2]};
}

bool is_white(const Color& color) {
  return color == Color{255, 255, 255};
}

// Share of the picture that is not background.
double coverage(const RgbImage& image) {
  int covered = 0;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) covered += !is_white(pixel(image, x, y));
  return static_cast<double>(covered) / (image.width * image.height);
}

double mean_difference(const RgbImage& a, const RgbImage& b) {
  EXPECT_EQ(a.pixels.size(), b.pixels.size());
  double sum = 0;
  for (std::size_t i = 0; i < a.pixels.size(); ++i) sum += std::abs(a.pixels[i] - b.pixels[i]);
  return sum / static_cast<double>(a.pixels.size());
}

LinearRgb linear(const Color& color) {
  LinearRgb light;
  for (int k = 0; k < 3; ++k) light[k] = linear_from_srgb(static_cast<float>(color[k]) / 255);
  return light;
}

// Unlit picture without anything but the surface.
RenderOptions bare(int width, int height) {
  return {.width = width,
          .height = height,
          .color = RenderColor::normal,
          .ground = Ground::none,
          .samples = 1,
          .field_resolution = 48};
}

Mesh transformed(Mesh mesh, double scale, const Point<3>& shift) {
  mesh.vertices = ((scale * mesh.vertices).colwise() + shift).eval();
  return mesh;
}

class Sphere : public Field<3> {
 public:
  explicit Sphere(double radius) : radius_(radius) {}
  void evaluate_block(const PointsRef<3>& x, const JetBlock& out) const override {
    for (Index i = 0; i < x.cols(); ++i) {
      out.value[i] = radius_ * radius_ - x.col(i).squaredNorm();
      if (out.gradient != nullptr) Eigen::Map<Point<3>>(out.gradient + 3 * i) = -2 * x.col(i);
      if (out.hessian != nullptr) Eigen::Map<Eigen::Matrix<double, 6, 1>>(out.hessian + 6 * i) << -2, 0, 0, -2, 0, -2;
    }
  }
  [[nodiscard]] Box<3> bounds() const override {
    Box<3> box;
    box.hi.setConstant(radius_);
    box.lo.setConstant(-radius_);
    return box;
  }
  [[nodiscard]] Points<3> seeds() const override { return Point<3>(0, 0, radius_); }

 private:
  double radius_;
};

TEST(Render, TheOutlineOfASphereHasTheAreaOfADisk) {
  for (const double field_of_view : {0.0, 20.0, 60.0}) {
    RenderOptions options = bare(240, 180);
    options.field_of_view = field_of_view;
    const double radius = 0.5 * 180 * (1 - 2 * options.margin);
    const double disk = std::numbers::pi * radius * radius / (240 * 180);
    constexpr double boundary_pixels = 0.005;  // the lattice points of a disk miss its area by less
    EXPECT_NEAR(coverage(render(unit_sphere(60), options)), disk, boundary_pixels) << field_of_view;
    EXPECT_NEAR(coverage(render(Sphere(1), options)), disk, boundary_pixels) << field_of_view;
  }
}

TEST(Render, TheCentralPixelShowsTheNormalTowardsTheCamera) {
  for (const auto& view :
       {std::array{0.0, 0.0}, std::array{30.0, 20.0}, std::array{-130.0, 65.0}, std::array{90.0, -40.0}}) {
    RenderOptions options = bare(61, 41);
    options.view = view;
    options.field_of_view = 0;
    const double azimuth = view[0] * std::numbers::pi / 180, elevation = view[1] * std::numbers::pi / 180;
    const Point<3> normal(std::cos(azimuth) * std::cos(elevation), std::sin(azimuth) * std::cos(elevation),
                          std::sin(elevation));
    constexpr double quantization = 1.01;
    for (const RgbImage& image : {render(unit_sphere(40), options), render(Sphere(1), options)}) {
      const Color color = pixel(image, 30, 20);
      for (std::size_t k = 0; k < 3; ++k)
        EXPECT_NEAR(color[k], 255 * 0.5 * (normal[static_cast<Index>(k)] + 1), quantization);
    }
  }
}

TEST(Render, TheCurvatureOfASphereIsTheSameEverywhere) {
  // Mean curvature 1/r times the diagonal 2 sqrt(3) r is half of the limit: the middle of the positive side.
  RenderOptions options = bare(60, 60);
  options.color = RenderColor::mean_curvature;
  options.color_limit = 4 * std::sqrt(3.0);
  for (const double radius : {1.0, 1e-3}) {
    const LinearRgb seen = linear(pixel(render(Sphere(radius), options), 30, 30));
    constexpr float quantization = 0.02F;
    EXPECT_TRUE(seen.normalized().isApprox(diverging_color(0.5).normalized(), quantization));
  }
  options.color = RenderColor::gaussian_curvature;  // 1/r^2 times 12 r^2
  options.color_limit = 24;
  const LinearRgb seen = linear(pixel(render(Sphere(1), options), 30, 30));
  EXPECT_TRUE(seen.normalized().isApprox(diverging_color(0.5).normalized(), 0.02F));
}

TEST(Render, CurvaturesOfAMeshComeFromItsVertexProperties) {
  Mesh mesh = unit_sphere(20);
  mesh.properties.push_back({"mean_curvature", "float", Eigen::VectorXd::Constant(mesh.vertices.cols(), -1)});
  RenderOptions options = bare(60, 60);
  options.color = RenderColor::mean_curvature;
  options.color_limit = 4 * std::sqrt(3.0);
  const LinearRgb seen = linear(pixel(render(mesh, options), 30, 30));
  EXPECT_TRUE(seen.normalized().isApprox(diverging_color(-0.5).normalized(), 0.02F));
}

TEST(Render, TheErrorIsTheDistanceToTheReference) {
  const Mesh reference = unit_sphere(60);
  RenderOptions options = bare(60, 60);
  options.color = RenderColor::error;
  options.reference = &reference;
  options.color_limit = 0.2 / (2 * std::sqrt(3.0));
  const LinearRgb seen = linear(pixel(render(transformed(reference, 1.1, {0, 0, 0}), options), 30, 30));
  EXPECT_TRUE(seen.normalized().isApprox(sequential_color(0.5).normalized(), 0.02F));
}

TEST(Render, VertexColorsAreTheMaterial) {
  Mesh mesh = unit_sphere(20);
  const Index n = mesh.vertices.cols();
  mesh.properties.push_back({"red", "uchar", Eigen::VectorXd::Constant(n, 200)});
  mesh.properties.push_back({"green", "uchar", Eigen::VectorXd::Constant(n, 0)});
  mesh.properties.push_back({"blue", "uchar", Eigen::VectorXd::Constant(n, 0)});
  const Color color = pixel(render(mesh, {.width = 60, .height = 60}), 30, 30);
  EXPECT_GT(color[0], 120);
  EXPECT_LT(color[1], 60);  // the gloss is white
  EXPECT_LT(color[2], 60);
}

TEST(Render, OutlinesAreSymmetricWhereTheSurfaceIs) {
  RenderOptions options = bare(121, 81);
  options.view = {0, 0};
  const RgbImage image = render(unit_sphere(40), options);
  for (int y = 0; y < 81; ++y)
    for (int x = 0; x < 121; ++x) EXPECT_EQ(is_white(pixel(image, x, y)), is_white(pixel(image, 120 - x, 80 - y)));
}

TEST(Render, AConvexSurfaceHidesNoSkyFromItself) {
  RenderOptions options{.width = 80, .height = 60, .ground = Ground::none, .occlusion_rays = 0};
  for (const MeshShading shading : {MeshShading::smooth, MeshShading::flat}) {
    options.shading = shading;
    options.occlusion_rays = 0;
    const RgbImage open = render(unit_sphere(12), options);
    options.occlusion_rays = 16;
    constexpr double penumbra = 0.6;  // grey levels: where the key light sets its rays graze the surface
    EXPECT_LT(mean_difference(open, render(unit_sphere(12), options)), penumbra);
  }
}

TEST(Render, TheGroundOnlyDarkensTheBackground) {
  RenderOptions options{.width = 120, .height = 90};
  const RgbImage with_ground = render(unit_sphere(20), options);
  options.ground = Ground::none;
  const RgbImage without = render(unit_sphere(20), options);
  int darker = 0;
  for (std::size_t i = 0; i < without.pixels.size(); ++i) {
    if (without.pixels[i] != 255) continue;
    EXPECT_LE(with_ground.pixels[i], 255);
    darker += with_ground.pixels[i] < 250;
  }
  EXPECT_GT(darker, 500);
  EXPECT_TRUE(is_white(pixel(without, 0, 89)));
  EXPECT_TRUE(is_white(pixel(with_ground, 0, 0)));
}

TEST(Render, AFieldAndItsMeshGiveTheSamePicture) {
  const RenderOptions options{.width = 120, .height = 90, .field_resolution = 100};
  constexpr double half_a_grey_level = 0.5;
  EXPECT_LT(mean_difference(render(Sphere(1), options), render(unit_sphere(80), options)), half_a_grey_level);
}

TEST(Render, DoesNotDependOnTheNumberOfThreads) {
  const RenderOptions options{.width = 200, .height = 150};
  set_thread_count(1);
  const RgbImage serial = render(unit_sphere(20), options);
  set_thread_count(4);
  const RgbImage parallel = render(unit_sphere(20), options);
  set_thread_count(0);
  EXPECT_EQ(serial.pixels, parallel.pixels);
}

TEST(Render, DoesNotDependOnTheTiles) {
  const RenderOptions options{.width = 90, .height = 70};
  const Mesh mesh = unit_sphere(20);
  const MeshScene scene(mesh, options);
  const Box<3> box = bounding_box<3>(scene.outline());
  const SurfaceColor color(options, box.diagonal());
  const Studio studio(scene, options, color, frame_points(scene.outline(), options), box);
  RgbImage image(90, 70);
  for (const auto& [x_begin, x_end] : {std::array{0, 37}, std::array{37, 90}})
    for (const auto& [y_begin, y_end] : {std::array{0, 11}, std::array{11, 70}})
      render_tile(studio, {x_begin, x_end, y_begin, y_end}, image);
  EXPECT_EQ(image.pixels, render(mesh, options).pixels);
}

TEST(Render, ScaleAndPositionDoNotChangeThePicture) {
  const RenderOptions options{.width = 100, .height = 80};
  const RgbImage expected = render(unit_sphere(20), options);
  EXPECT_EQ(render(transformed(unit_sphere(20), 0x1p-100, {0, 0, 0}), options).pixels, expected.pixels);
  EXPECT_EQ(render(transformed(unit_sphere(20), 0x1p100, {0, 0, 0}), options).pixels, expected.pixels);
  constexpr double few_pixels = 0.05;  // of the outline may fall on the other side by rounding
  EXPECT_LT(mean_difference(render(transformed(unit_sphere(20), 1, {1000, -2000, 500}), options), expected),
            few_pixels);
}

TEST(Render, AMeshTurnedInsideOutLooksTheSame) {
  Mesh mesh = unit_sphere(20);
  mesh.normals.resize(3, 0);
  const RenderOptions options{.width = 100, .height = 80};
  const RgbImage expected = render(mesh, options);
  mesh.triangles.row(1).swap(mesh.triangles.row(2));
  EXPECT_LT(mean_difference(render(mesh, options), expected), 0.01);
}

TEST(Render, BothSidesOfASheetLookAlike) {
  // A bowl seen from above: inside out by its volume, or not, with normals or without.
  Mesh bowl = unit_sphere(20);
  std::vector<Index> lower;
  for (Index t = 0; t < bowl.triangles.cols(); ++t)
    if (bowl.vertices(2, bowl.triangles.col(t).maxCoeff()) < -0.8) lower.push_back(t);
  bowl.triangles = Triangles(bowl.triangles(Eigen::all, lower));
  const RenderOptions options{.width = 100, .height = 80, .view = {0, 60}};
  const RgbImage expected = render(bowl, options);
  Mesh turned = bowl;
  turned.triangles.row(1).swap(turned.triangles.row(2));
  EXPECT_LT(mean_difference(render(turned, options), expected), 0.01);
  turned.normals = -turned.normals;
  EXPECT_LT(mean_difference(render(turned, options), expected), 0.01);
  bowl.normals.resize(3, 0);
  constexpr double facets = 2;  // of 255, by other normals at the edge
  EXPECT_LT(mean_difference(render(bowl, options), expected), facets);
}

TEST(Render, TheFrameOptionReplacesTheSurface) {
  RenderOptions options = bare(100, 100);
  options.field_of_view = 0;
  options.view = {0, 0};
  options.margin = 0;
  options.frame.lo.setConstant(-4);
  options.frame.hi.setConstant(4);
  constexpr double boundary_pixels = 0.005;
  EXPECT_NEAR(coverage(render(unit_sphere(40), options)), std::numbers::pi / 64, boundary_pixels);
}

TEST(Render, MoreSamplesConvergeToTheSamePicture) {
  RenderOptions options{.width = 40, .height = 30, .samples = 8, .occlusion_rays = 64};
  const RgbImage best = render(unit_sphere(20), options);
  options.samples = 1;
  const double one = mean_difference(render(unit_sphere(20), options), best);
  options.samples = 4;
  const double sixteen = mean_difference(render(unit_sphere(20), options), best);
  EXPECT_LT(sixteen, 0.5 * one);
}

TEST(Render, StopsWhenTheProgressCallbackSaysSo) {
  EXPECT_THROW(render(unit_sphere(8), {.progress = [](std::string_view, double) { return false; }}), Cancelled);
}

TEST(Render, RejectsWhatItCannotShow) {
  const Mesh mesh = unit_sphere(8);
  const auto expect = [&](const Mesh& m, const RenderOptions& options, const char* message) {
    EXPECT_NE(invalid_input_message([&] { render(m, options); }).find(message), std::string::npos) << message;
  };
  expect(Mesh{}, {}, "the mesh has no surface");
  expect(mesh, {.width = 0}, "width = 0");
  expect(mesh, {.height = 40000}, "height = 40000");
  expect(mesh, {.view = {std::numeric_limits<double>::quiet_NaN(), 0}}, "azimuth = nan");
  expect(mesh, {.view = {0, 91}}, "elevation = 91");
  expect(mesh, {.field_of_view = 170}, "field_of_view = 170");
  expect(mesh, {.margin = 0.5}, "margin = 0.5");
  expect(mesh, {.color = RenderColor::error}, "set options.reference");
  expect(mesh, {.color = RenderColor::mean_curvature}, "render the model instead of the mesh");
  expect(mesh, {.color_limit = -1}, "color_limit = -1");
  expect(mesh, {.material = {2, 0, 0}}, "color component = 2");
  expect(mesh, {.samples = 0}, "samples = 0");
  expect(mesh, {.occlusion_rays = -1}, "occlusion_rays = -1");
  expect(mesh, {.field_resolution = 1}, "field_resolution = 1");
  Mesh point = mesh;
  point.vertices.setZero();
  expect(point, {}, "all vertices coincide");
  Mesh wrong_normals = mesh;
  wrong_normals.normals.resize(3, 5);
  expect(wrong_normals, {}, "number of vertex normals = 5");
  Mesh wrong_property = mesh;
  wrong_property.properties.push_back({"red", "uchar", Eigen::VectorXd::Zero(3)});
  expect(wrong_property, {}, "must be one per vertex");
}

}  // namespace
}  // namespace csrbf::render_test
