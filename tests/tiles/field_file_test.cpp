#include "csrbf/tiles/folder/field_file.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/surface/reconstruct.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <random>

namespace csrbf::field_file_test {
namespace {

// The surface of a bumpy ball, from points with normals.
std::shared_ptr<const CompositeField> ball() {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  PointCloud cloud;
  cloud.points.resize(3, 3000);
  for (Index i = 0; i < cloud.points.cols(); ++i) {
    const Point<3> p = Point<3>(normal(random), normal(random), normal(random)).normalized();
    cloud.points.col(i) = (1 + 0.05 * std::sin(5 * p[0])) * p + Point<3>(100, 0, 0);
  }
  ReconstructOptions options;
  options.method = "composite";
  return std::dynamic_pointer_cast<const CompositeField>(reconstruct(cloud, options).field);
}

class FieldFile : public testing::Test {
 protected:
  void TearDown() override { std::filesystem::remove(path_); }

  [[nodiscard]] Jet<3> written_and_read(FieldNumbers numbers) const {
    write_field(path_, *field_, numbers);
    return read_field(path_)->evaluate(PointsRef<3>(places_), Derivatives::gradient);
  }

  const std::string path_ =
      testing::TempDir() + "field_file_" + testing::UnitTest::GetInstance()->current_test_info()->name();
  const std::shared_ptr<const CompositeField> field_ = ball();
  const Points<3> places_ = (1.2 * Points<3>::Random(3, 2000)).colwise() + Point<3>(100, 0, 0);
  const Jet<3> jet_ = field_->evaluate(PointsRef<3>(places_), Derivatives::gradient);
};

TEST_F(FieldFile, ExactNumbersHaveTheSameValues) {
  const Jet<3> read = written_and_read(FieldNumbers::exact);
  EXPECT_EQ(read.value, jet_.value);
  EXPECT_EQ(read.gradient, jet_.gradient);
}

TEST_F(FieldFile, RoundedNumbersTakeFewerBytesAndHardlyMoveTheSurface) {
  write_field(path_, *field_, FieldNumbers::exact);
  const auto exact = std::filesystem::file_size(path_);
  const Jet<3> read = written_and_read(FieldNumbers::rounded);
  EXPECT_LT(static_cast<double>(std::filesystem::file_size(path_)), 0.75 * static_cast<double>(exact));
  EXPECT_NE(read.value, jet_.value);
  EXPECT_LT((read.value - jet_.value).cwiseAbs().maxCoeff(), 1e-5 * field_->feature_size());
  EXPECT_LT((read.gradient - jet_.gradient).cwiseAbs().maxCoeff(), 1e-4);
}

TEST_F(FieldFile, RoundedTwiceIsRoundedOnce) {
  const Jet<3> once = written_and_read(FieldNumbers::rounded);
  write_field(path_, *read_field(path_), FieldNumbers::rounded);
  EXPECT_EQ(read_field(path_)->evaluate(PointsRef<3>(places_), Derivatives::gradient).value, once.value);
}

TEST_F(FieldFile, DamagedFilesAreRefused) {
  write_field(path_, *field_, FieldNumbers::rounded);
  const auto size = std::filesystem::file_size(path_);
  for (const auto left : {size - 1, size / 2, size / 20, std::uintmax_t{60}, std::uintmax_t{0}}) {
    std::filesystem::resize_file(path_, left);
    EXPECT_THROW((void)read_field(path_), IoError) << left;
  }
}

}  // namespace
}  // namespace csrbf::field_file_test
