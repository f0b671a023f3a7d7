#include "csrbf/io/model.hpp"

#include "csrbf/io/models/archive.hpp"
#include "io/io_testing.hpp"
#include "surface/composite_field_testing.hpp"

#include <functional>

namespace csrbf::model_test {
namespace {

using csrbf::testing::content;
using csrbf::testing::io_error;
using csrbf::testing::TemporaryFolder;

CompositeField torus_field(Index n = 3000) {
  return composite_field(Torus().cloud(n), Torus().area());
}

Points<3> probes(const Field<3>& field) {
  const Points<3> everywhere = random_points(1000, field.bounds().inflated(1), 1);
  Points<3> points(3, 2000);
  points << everywhere, with_noise(Torus().cloud(1000), 0.05).points;
  return points;
}

// A small model whose entries can be changed behind the checksum.
class DamagedModel : public ::testing::Test {
 protected:
  DamagedModel() {
    write_model(folder_.file("good.csrbf"), torus_field(400));
    archive_ = read_archive(folder_.file("good.csrbf"));
  }

  // What read_model says about the model after `change`.
  std::string error_after(const std::function<void(Archive&)>& change) {
    Archive changed = archive_;
    change(changed);
    write_archive(folder_.file("bad.csrbf"), changed);
    return io_error([&] { (void)read_model(folder_.file("bad.csrbf")); });
  }

  template <class T>
  std::string error_after_changing(const std::string& name, Index row, Index col, T value) {
    return error_after([&](Archive& archive) {
      ArchiveArray<T> array = archive.array<T>(name);
      array(row, col) = value;
      archive.set(name, array);
    });
  }

  TemporaryFolder folder_;
  Archive archive_;
};

TEST(Model, KeepsValuesGradientsAndHessiansBitForBit) {
  const TemporaryFolder folder;
  const CompositeField field = torus_field();
  write_model(folder.file("torus.csrbf"), field);
  const std::shared_ptr<const Field<3>> read = read_model(folder.file("torus.csrbf"));
  const Points<3> x = probes(field);
  const Jet<3> expected = field.evaluate(x, Derivatives::hessian), found = read->evaluate(x, Derivatives::hessian);
  EXPECT_EQ(found.value, expected.value);
  EXPECT_EQ(found.gradient, expected.gradient);
  EXPECT_EQ(found.hessian, expected.hessian);
  EXPECT_EQ(read->bounds().lo, field.bounds().lo);
  EXPECT_EQ(read->bounds().hi, field.bounds().hi);
  EXPECT_EQ(read->seeds(), field.seeds());
  EXPECT_EQ(read->feature_size(), field.feature_size());
}

TEST(Model, KeepsTheWindingLevelOfOpenSurfaces) {
  const TemporaryFolder folder;
  CompositeField::Data data = torus_field(1000).data();
  data.winding_level = -0.75;
  const CompositeField field(data);
  write_model(folder.file("open.csrbf"), field);
  const Points<3> x = probes(field);
  EXPECT_EQ(read_model(folder.file("open.csrbf"))->evaluate(x).value, field.evaluate(x).value);
  EXPECT_NE(torus_field(1000).evaluate(x).value, field.evaluate(x).value);
}

TEST(Model, IsTheSameFileWhenWrittenAgain) {
  const TemporaryFolder folder;
  write_model(folder.file("one.csrbf"), torus_field(1000));
  write_model(folder.file("two.csrbf"), *read_model(folder.file("one.csrbf")));
  EXPECT_EQ(content(folder.file("one.csrbf")), content(folder.file("two.csrbf")));
}

TEST(Model, KeepsFieldsOfOneLevelWithoutCsrbf) {
  const TemporaryFolder folder;
  CompositeOptions options;
  options.centers_per_patch = 0;
  const CompositeField field = composite_field(Torus().cloud(300), Torus().area(), options);
  ASSERT_EQ(field.data().levels.size(), 1);
  ASSERT_EQ(field.data().levels[0].centers(), 0);
  write_model(folder.file("plain.csrbf"), field);
  const Points<3> x = probes(field);
  EXPECT_EQ(read_model(folder.file("plain.csrbf"))->evaluate(x).value, field.evaluate(x).value);
}

TEST(Model, RefusesFieldsThatHaveNoFileForm) {
  class Nothing : public Field<3> {
   public:
    void evaluate_block(const PointsRef<3>&, const JetBlock&) const override {}
    [[nodiscard]] Box<3> bounds() const override { return {}; }
  };
  const TemporaryFolder folder;
  EXPECT_EQ(invalid_input_message([&] { write_model(folder.file("x.csrbf"), Nothing()); }),
            "write_model: field: this kind of field has no file form");
  EXPECT_EQ(folder.files(), 0);
}

TEST(Model, RefusesTruncatedAndFlippedFiles) {
  const TemporaryFolder folder;
  write_model(folder.file("good.csrbf"), torus_field(400));
  const std::string bytes = content(folder.file("good.csrbf"));
  for (std::size_t k = 0; k < 60; ++k) {
    const std::size_t at = k * bytes.size() / 60;
    const std::string cut = folder.with("cut.csrbf", bytes.substr(0, at));
    EXPECT_NE(io_error([&] { (void)read_model(cut); }).find("cut.csrbf"), std::string::npos) << at;
    std::string flipped = bytes;
    flipped[at] = static_cast<char>(flipped[at] ^ 0x10);
    const std::string bad = folder.with("flipped.csrbf", flipped);
    EXPECT_NE(io_error([&] { (void)read_model(bad); }).find("flipped.csrbf"), std::string::npos) << at;
  }
  const std::string longer = folder.with("longer.csrbf", bytes + "x");
  EXPECT_NE(io_error([&] { (void)read_model(longer); }).find("longer.csrbf"), std::string::npos);
  EXPECT_NE(io_error([&] { (void)read_model(folder.file("none.csrbf")); }).find("none.csrbf"), std::string::npos);
  EXPECT_NE(io_error([&] { write_model(folder.file("no/such/folder.csrbf"), torus_field(400)); }).find("folder.csrbf"),
            std::string::npos);
}

TEST_F(DamagedModel, OfAnotherKindIsRefused) {
  const std::string error = error_after([](Archive& archive) { archive.kind = "patches"; });
  EXPECT_NE(error.find("bad.csrbf: this is a \"patches\", not a surface"), std::string::npos) << error;
}

TEST_F(DamagedModel, OfANewerFormatIsRefused) {
  std::string bytes = content(folder_.file("good.csrbf"));
  bytes[8] = 2;  // the format, behind the magic; what follows need not be what this program knows
  bytes.resize(bytes.size() / 2);
  const std::string newer = folder_.with("newer.csrbf", bytes);
  EXPECT_EQ(io_error([&] { (void)read_model(newer); }),
            newer + ": written by a newer csrbf (format 2, this program reads up to 1)");
}

TEST_F(DamagedModel, WithoutAnEntryIsRefused) {
  for (const auto& [name, value] : archive_.values()) {
    const std::string error = error_after([&, gone = name](Archive& archive) {
      Archive rest;
      rest.kind = archive.kind;
      for (const auto& [other, kept] : archive.values())
        if (other != gone) rest.insert(other, kept);
      archive = rest;
    });
    // A part without its last entry may be missing altogether.
    EXPECT_NE(error.find("bad.csrbf: "), std::string::npos) << name << ": " << error;
  }
}

TEST_F(DamagedModel, WithArraysThatDoNotFitTogetherIsRefused) {
  const Index patches = archive_.array<double>("level0/patches").cols();
  EXPECT_NE(error_after_changing<std::int64_t>("level0/center_begin", 0, 0, 1).find("do not fit"), std::string::npos);
  EXPECT_NE(error_after_changing<std::int64_t>("level0/center_begin", patches, 0, 0).find("do not fit"),
            std::string::npos);
  EXPECT_NE(error_after_changing<std::int64_t>("level0/center_begin", 1, 0, 1 << 30).find("do not fit"),
            std::string::npos);
  EXPECT_NE(error_after_changing<std::int64_t>("level0/center_begin", 1, 0, std::numeric_limits<std::int64_t>::min())
                .find("do not fit"),
            std::string::npos);
  for (const std::string name :
       {"level0/patches", "level0/centers", "level0/alpha", "winding/normals", "winding/areas"})
    EXPECT_NE(error_after([&](Archive& archive) {
                const ArchiveArray<double> array = archive.array<double>(name);
                archive.set(name, array.topRows(array.rows() - 1));
              }).find("bad.csrbf: "),
              std::string::npos)
        << name;
  EXPECT_NE(error_after([](Archive& archive) { archive.set("levels", 0); }).find("bad.csrbf: "), std::string::npos);
  EXPECT_NE(error_after([](Archive& archive) { archive.set("levels", 3); }).find("bad.csrbf: "), std::string::npos);
}

TEST_F(DamagedModel, WithoutSamplesOfTheWindingNumberIsRead) {
  EXPECT_EQ(error_after([](Archive& archive) {
              for (const std::string name : {"winding/points", "winding/normals"})
                archive.set(name, ArchiveArray<double>(3, 0));
              for (const std::string name : {"winding/areas", "winding/smoothing_length"})
                archive.set(name, ArchiveArray<double>(0, 1));
            }),
            "no exception");
}

TEST_F(DamagedModel, WithNumbersThatMakeNoSenseIsRefused) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  constexpr Index radius = 12, flatness = 13;
  EXPECT_NE(error_after_changing<double>("level0/patches", radius, 2, 0).find("a patch is damaged"), std::string::npos);
  EXPECT_NE(error_after_changing<double>("level0/patches", flatness, 2, -1).find("a patch is damaged"),
            std::string::npos);
  EXPECT_NE(error_after_changing<double>("level0/patches", 3, 2, nan).find("NaN"), std::string::npos);
  EXPECT_NE(error_after([&](Archive& archive) { archive.set("scale", 0.0); }).find("the scale is damaged"),
            std::string::npos);
  EXPECT_NE(error_after([&](Archive& archive) { archive.set("far_value", nan); }).find("the scale is damaged"),
            std::string::npos);
  for (const std::string name : {"level0/centers", "level0/alpha", "origin", "lower_bounds", "winding/points",
                                 "winding/normals", "winding/areas", "winding/smoothing_length"})
    EXPECT_NE(error_after_changing<double>(name, 0, 0, nan).find("bad.csrbf: "), std::string::npos) << name;
  EXPECT_NE(error_after_changing<double>("winding/areas", 0, 0, -1).find("bad.csrbf: "), std::string::npos);
  EXPECT_NE(error_after([&](Archive& archive) { archive.set("detail", nan); }).find("bad.csrbf: "), std::string::npos);
  EXPECT_NE(
      error_after([&](Archive& archive) { archive.set("winding_level", 3.0); }).find("the winding level is damaged"),
      std::string::npos);
}

}  // namespace
}  // namespace csrbf::model_test
