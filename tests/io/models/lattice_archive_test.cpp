#include "csrbf/io/models/lattice_archive.hpp"

#include "csrbf/io/model.hpp"
#include "csrbf/levelset/segment.hpp"

#include "io/io_testing.hpp"

#include <functional>

namespace csrbf::lattice_archive_test {
namespace {

using testing::content;
using testing::io_error;
using testing::TemporaryFolder;

// A bright ball on a dark ground, with voxels that are not cubes and axes that are turned.
template <int Dim>
Volume<float> ball_image() {
  VolumeLayout layout;
  layout.grid.axes = Dim;
  layout.grid.size = {24, 20, Dim == 3 ? 16 : 1};
  layout.grid.spacing = {1, 1.2, 1.5};
  layout.grid.origin = {-5, 3, 1};
  layout.grid.direction.topLeftCorner<2, 2>() = Eigen::Rotation2Dd(0.3).toRotationMatrix();
  Volume<float> image(layout);
  for (Index i = 0; i < layout.grid.voxels(); ++i) {
    const Point<3> p(static_cast<double>(i % 24) - 12, static_cast<double>(i / 24 % 20) - 10,
                     Dim == 3 ? static_cast<double>(i / 480) - 8 : 0.0);
    image.values[i] = p.norm() < 6 ? 10.0F : 1.0F;
  }
  return image;
}

template <int Dim>
Points<Dim> probes(const Field<Dim>& field) {
  const Box<Dim> box = field.bounds().inflated(4);
  return ((Points<Dim>::Random(Dim, 500).array() * 0.5).colwise() * box.extent().array()).colwise() +
         box.center().array();
}

template <int Dim>
void expect_round_trip() {
  SCOPED_TRACE(Dim);
  const TemporaryFolder folder;
  const Segmentation<Dim> segmentation = segment<Dim>(ball_image<Dim>(), {.kernel = "wendland-c4"});
  write_model(folder.file("ball.csrbf"), to_function(segmentation));
  const NamedFunction read = read_function(folder.file("ball.csrbf"));
  EXPECT_EQ(read.function.report().method, "segment");
  EXPECT_EQ(read.value_names, std::vector<std::string>{"level_set"});
  const Field<Dim>& expected = *segmentation.fields[0];
  const auto& found = *read.function.template fit<Dim>().components.at(0);
  const Points<Dim> x = probes(expected);
  const Jet<Dim> a = expected.evaluate(x, Derivatives::hessian), b = found.evaluate(x, Derivatives::hessian);
  EXPECT_GT(a.value.maxCoeff(), 1);
  EXPECT_EQ(a.value, b.value);
  EXPECT_EQ(a.gradient, b.gradient);
  EXPECT_EQ(a.hessian, b.hessian);
  EXPECT_EQ(expected.bounds().lo, found.bounds().lo);
  EXPECT_EQ(expected.feature_size(), found.feature_size());
  EXPECT_EQ(expected.seeds(), found.seeds());
  write_model(folder.file("again.csrbf"), read);
  EXPECT_EQ(content(folder.file("ball.csrbf")), content(folder.file("again.csrbf")));
}

TEST(LatticeArchive, KeepsLevelSetsBitForBit) {
  expect_round_trip<2>();
  expect_round_trip<3>();
}

TEST(LatticeArchive, IsASurfaceInSpace) {
  const TemporaryFolder folder;
  const Segmentation<3> segmentation = segment<3>(ball_image<3>());
  write_model(folder.file("ball.csrbf"), to_function(segmentation));
  const auto read = read_model(folder.file("ball.csrbf"));
  const Points<3> x = probes(*segmentation.fields[0]);
  EXPECT_EQ(read->evaluate(x).value, segmentation.fields[0]->evaluate(x).value);
  write_model(folder.file("alone.csrbf"), *segmentation.fields[0]);
  EXPECT_EQ(read_model(folder.file("alone.csrbf"))->evaluate(x).value, read->evaluate(x).value);
}

TEST(LatticeArchive, HoldsOneComponentForEachOfSeveralRegions) {
  Volume<float> image = ball_image<2>();
  for (std::size_t i = 0; i < 100; ++i) image.values[i] = 20;
  const Segmentation<2> segmentation = segment<2>(image, {.regions = 3});
  const NamedFunction function = to_function(segmentation);
  EXPECT_EQ(function.function.components(), 3);
  EXPECT_EQ(function.value_names, (std::vector<std::string>{"region0", "region1", "region2"}));
}

TEST(LatticeArchive, RefusesDamagedEntries) {
  const Segmentation<2> segmentation = segment<2>(ball_image<2>());
  const auto& field = dynamic_cast<const LatticeField<2>&>(*segmentation.fields[0]);
  const auto error_after = [&](const std::function<void(Archive&)>& change) {
    Archive archive = to_archive(field);
    archive.source = "model";
    change(archive);
    try {
      (void)lattice_field_from<2>(archive);
    } catch (const std::exception& error) {
      return std::string(error.what());
    }
    return std::string("no exception");
  };
  EXPECT_EQ(error_after([](Archive&) {}), "no exception");
  EXPECT_NE(error_after([](Archive& a) { a.set("support", -1.0); }).find("support"), std::string::npos);
  EXPECT_NE(error_after([](Archive& a) { a.set("kernel", "cubic"); }).find("kernel"), std::string::npos);
  EXPECT_NE(error_after([](Archive& a) {
              a.set("size", ArchiveArray<std::int64_t>::Constant(2, 1, 1) * 5);
            }).find("number of coefficients"),
            std::string::npos);
  EXPECT_NE(error_after([](Archive& a) {
              a.set("size", ArchiveArray<std::int64_t>::Constant(2, 1, std::int64_t{1} << 62));
            }).find("size"),
            std::string::npos);
  EXPECT_NE(error_after([](Archive& a) { a.set("to_lattice", Eigen::MatrixXd::Zero(2, 3)); }).find("axes"),
            std::string::npos);
}

TEST(LatticeArchive, EvaluatesSupportsWiderThanAnyLattice) {
  const Segmentation<2> segmentation = segment<2>(ball_image<2>());
  const auto& field = dynamic_cast<const LatticeField<2>&>(*segmentation.fields[0]);
  Archive archive = to_archive(field);
  archive.set("support", 1e300);
  EXPECT_TRUE(std::isfinite((*lattice_field_from<2>(archive))(field.bounds().center())));
}

}  // namespace
}  // namespace csrbf::lattice_archive_test
