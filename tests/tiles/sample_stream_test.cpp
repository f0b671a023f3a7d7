#include "csrbf/tiles/stages/sample_stream.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/io/files/atomic_file.hpp"
#include "csrbf/io/files/npy.hpp"
#include "csrbf/io/files/read_file.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <limits>

namespace csrbf::sample_stream_test {
namespace {

constexpr Index rows = 500;

// x, y, value, weight by row; row 7 lacks a coordinate, row 9 has the value -9999.
std::vector<double> some_numbers() {
  std::vector<double> numbers;
  for (Index i = 0; i < rows; ++i) {
    const auto t = static_cast<double>(i);
    numbers.insert(numbers.end(), {0.1 * t, std::sin(t), 2 * t, 1 + t});
  }
  numbers[4 * 7] = std::numeric_limits<double>::quiet_NaN();
  numbers[4 * 9 + 2] = -9999;
  return numbers;
}

std::string write_samples(const std::string& extension) {
  const std::string test = testing::UnitTest::GetInstance()->current_test_info()->name();
  const std::string path = testing::TempDir() + "stream_of_samples_" + test + extension;
  const std::vector<double> numbers = some_numbers();
  if (extension == ".npy") {
    write_file(path, format_npy({{rows, 4}, numbers}));
    return path;
  }
  std::string text = "x,y,value,weight\n";
  for (std::size_t i = 0; i < numbers.size(); ++i)
    text += (std::isnan(numbers[i]) ? "" : std::to_string(numbers[i])) + (i % 4 == 3 ? "\n" : ",");
  write_file(path, text);
  return path;
}

const SampleColumns columns{.coordinates = "1,2", .values = "3", .weights = "4"};

TEST(SampleStream, PiecesAreTheSamplesOfTheFile) {
  const std::string path = write_samples(".npy");
  SampleStream stream(path, columns, {});
  ASSERT_EQ(stream.size(), rows);
  const Point<2> scales(10, 0.5);
  const Samples<2> part = samples_of(stream.read<2>(100, 130, scales), true);
  ASSERT_EQ(part.size(), 30);
  for (Index i = 0; i < 30; ++i) {
    const auto t = static_cast<double>(100 + i);
    EXPECT_EQ(part.points(0, i), 0.1 * t / 10);
    EXPECT_EQ(part.points(1, i), std::sin(t) / 0.5);
    EXPECT_EQ(part.values(i, 0), 2 * t);
    EXPECT_EQ(part.weights[i], 1 + t);
  }
  std::filesystem::remove(path);
}

TEST(SampleStream, RowsWithoutNumbersOrValuesHaveNoPlace) {
  for (const std::string extension : {".npy", ".csv"}) {
    const std::string path = write_samples(extension);
    SampleStream stream(path, columns, -9999.0);
    const Samples<2> all = samples_of(stream.read<2>(0, stream.size(), Point<2>::Ones()), true);
    const Index nowhere = all.size() - all.points.array().isFinite().colwise().all().count();
    EXPECT_EQ(all.points.array().isInf().colwise().all().count(), 1) << extension;  // that has a number
    EXPECT_EQ(all.size() - nowhere, rows - 2) << extension;
    std::filesystem::remove(path);
  }
}

TEST(SampleStream, AFileThatEndsEarlyIsReadAsAWholeAndRefused) {
  const std::string path = write_samples(".npy");
  const std::string bytes = read_file(path);
  write_file(path, bytes.substr(0, bytes.size() - 8));
  EXPECT_THROW(SampleStream(path, columns, {}), IoError);
  std::filesystem::remove(path);
}

}  // namespace
}  // namespace csrbf::sample_stream_test
