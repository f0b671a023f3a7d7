#include "csrbf/io/models/surface_archive.hpp"

#include "csrbf/approx/fit.hpp"
#include "csrbf/implicit/combine.hpp"
#include "csrbf/implicit/combine/extend_distance.hpp"
#include "csrbf/io/model.hpp"
#include "io/io_testing.hpp"
#include "surface/composite_field_testing.hpp"

namespace csrbf::surface_archive_test {
namespace {

using csrbf::testing::content;
using csrbf::testing::io_error;
using csrbf::testing::TemporaryFolder;

Solid torus() {
  return std::make_shared<const CompositeField>(composite_field(Torus().cloud(400), Torus().area()));
}

// A fitted ball.
Solid fitted() {
  Samples<3> samples;
  samples.points = Points<3>::Random(3, 60);
  samples.values = (0.5 - samples.points.colwise().norm().array()).matrix().transpose();
  return fit(samples, {.method = "interpolate", .kernel = "wendland-c4"}).components.front();
}

// Every kind of field that can be in a tree.
Solid tree() {
  CombineOptions blend;
  blend.blending = Blending::super_elliptic;
  const Solid rounded = combine(Operation::unite, {torus(), fitted()}, blend);
  blend.blending = Blending::log_sum_exp;
  CombineOptions smooth;
  smooth.blending = Blending::r_function;
  return combine(Operation::subtract, {rounded, combine(Operation::intersect, {fitted(), ~fitted()}, smooth)}, blend);
}

TEST(SurfaceArchive, KeepsTreesOfSolidsBitForBit) {
  const TemporaryFolder folder;
  const Solid solid = tree();
  write_model(folder.file("tree.csrbf"), *solid);
  const std::shared_ptr<const Field<3>> read = read_model(folder.file("tree.csrbf"));
  const Points<3> x = 2 * Points<3>::Random(3, 1000);
  const Jet<3> expected = solid->evaluate(x, Derivatives::hessian), found = read->evaluate(x, Derivatives::hessian);
  EXPECT_EQ(found.value, expected.value);
  EXPECT_EQ(found.gradient, expected.gradient);
  EXPECT_EQ(found.hessian, expected.hessian);
  EXPECT_EQ(read->bounds().lo, solid->bounds().lo);
  EXPECT_EQ(read->seeds(), solid->seeds());
  EXPECT_EQ(read->feature_size(), solid->feature_size());
  write_model(folder.file("again.csrbf"), *read);
  EXPECT_EQ(content(folder.file("again.csrbf")), content(folder.file("tree.csrbf")));
}

TEST(SurfaceArchive, StoresTheDistanceOfBlendedSolids) {
  const Archive archive = surface_to_archive(*tree());
  EXPECT_EQ(archive.kind, "combined surface");
  EXPECT_EQ(archive.text("term0/kind"), "extended surface");
  EXPECT_EQ(archive.text("blending"), "log-sum-exp");
}

TEST(SurfaceArchive, KeepsFittedFunctions) {
  const Solid ball = fitted();
  const Points<3> x = Points<3>::Random(3, 100);
  EXPECT_EQ(surface_from(surface_to_archive(*ball))->evaluate(x).value, ball->evaluate(x).value);
}

TEST(SurfaceArchive, RefusesDamagedTrees) {
  const Archive good = surface_to_archive(*tree());
  const auto error_after = [&](const auto& change) {
    Archive archive = good;
    archive.source = "bad.csrbf";
    change(archive);
    return io_error([&] { (void)surface_from(archive); });
  };
  const auto says = [](const std::string& error, const std::string& what) {
    EXPECT_NE(error.find(what), std::string::npos) << error;
  };
  says(error_after([](Archive& a) { a.set("blending", std::string("soft")); }), "knows no blending \"soft\"");
  says(error_after([](Archive& a) { a.set("range", -1.0); }), "the range of the blend is damaged");
  says(error_after([](Archive& a) { a.set("range", 0.0); }), "the range of the blend is damaged");
  says(error_after([](Archive& a) { a.set("sharpness", 0.5); }), "the range of the blend is damaged");
  says(error_after([](Archive& a) { a.set("terms", 0); }), "\"terms\" = 0 is not in");
  says(error_after([](Archive& a) { a.set("terms", 3); }), "no entry \"term2/kind\"");
  says(error_after([](Archive& a) { a.set("term1/kind", std::string("report")); }),
       "this is a \"report\", not a surface");
  says(error_after([](Archive& a) { a.set("term0/near", 0.0); }), "\"near\" is not positive");
  says(error_after([](Archive& a) { a.set("term0/size", Eigen::Matrix<std::int64_t, 3, 1>(3, 4, 4)); }),
       "the lattice is damaged");
  says(error_after([](Archive& a) { a.set("term0/size", Eigen::Matrix<std::int64_t, 3, 1>(4, 4, 4)); }),
       "\"lack\" has");
}

TEST(SurfaceArchive, RefusesTreesThatAreTooDeep) {
  Solid solid = fitted();
  for (int i = 0; i < 300; ++i) solid = ~solid;
  const Archive deep = surface_to_archive(*solid);
  EXPECT_NE(io_error([&] { (void)surface_from(deep); }).find("more than 256 levels deep"), std::string::npos);
}

TEST(SurfaceArchive, RefusesFieldsWithoutFileForm) {
  class Nothing : public Field<3> {
   public:
    void evaluate_block(const PointsRef<3>&, const JetBlock&) const override {}
    [[nodiscard]] Box<3> bounds() const override { return {}; }
  };
  EXPECT_NE(invalid_input_message([] {
              surface_to_archive(*~Solid(std::make_shared<const Nothing>()));
            }).find("no file form"),
            std::string::npos);
}

}  // namespace
}  // namespace csrbf::surface_archive_test
