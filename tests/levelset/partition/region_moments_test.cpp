#include "csrbf/levelset/partition/region_moments.hpp"

#include <gtest/gtest.h>

#include <random>

namespace csrbf::region_moments_test {
namespace {

struct Picture {
  Grid grid;
  std::vector<float> values;
  std::vector<std::uint8_t> labels;
};

// value(x, y, z) of coordinates in [-1, 1], with random labels 0, 1 and 2.
template <class Value>
Picture paint(std::array<Index, 3> size, const Value& value) {
  Picture picture;
  picture.grid.size = size;
  picture.grid.axes = size[2] > 1 ? 3 : 2;
  std::mt19937 generator(5);
  std::uniform_int_distribution<int> label(0, 2);
  const auto at = [](Index i, Index n) {
    return n > 1 ? 2 * static_cast<double>(i) / static_cast<double>(n - 1) - 1 : 0;
  };
  for (Index z = 0; z < size[2]; ++z)
    for (Index y = 0; y < size[1]; ++y)
      for (Index x = 0; x < size[0]; ++x) {
        picture.values.push_back(static_cast<float>(value(at(x, size[0]), at(y, size[1]), at(z, size[2]))));
        picture.labels.push_back(static_cast<std::uint8_t>(label(generator)));
      }
  return picture;
}

double quadratic(double x, double y, double z) {
  return 0.3 + 0.2 * x - 0.1 * y + 0.05 * z + 0.1 * x * y - 0.2 * y * z + 0.3 * x * x - 0.1 * z * z;
}

TEST(RegionMoments, AreThoseOfTheVoxelsOfOneLabel) {
  const Picture p = paint({37, 11, 1}, quadratic);
  double count = 0, sum = 0, squares = 0;
  for (std::size_t i = 0; i < p.values.size(); ++i) {
    if (p.labels[i] != 1) continue;
    const auto v = static_cast<double>(p.values[i]);
    count += 1;
    sum += v;
    squares += v * v;
  }
  const RegionMoments found = region_moments(p.values, p.labels, 1, p.grid);
  EXPECT_EQ(found.count(), count);
  EXPECT_NEAR(found.mean(), sum / count, 1e-12);
  EXPECT_NEAR(found.squares, squares, 1e-9);
}

TEST(RegionMoments, OfAllLabelsAddUpToThoseOfTheImage) {
  const Picture p = paint({20, 9, 7}, quadratic);
  RegionMoments sum = region_moments(p.values, p.labels, 0, p.grid);
  sum.add(region_moments(p.values, p.labels, 1, p.grid));
  sum.add(region_moments(p.values, p.labels, 2, p.grid));
  const RegionMoments all = region_moments(p.values, std::vector<std::uint8_t>(p.labels.size(), 0), 0, p.grid);
  EXPECT_NEAR(sum.powers[2][1][1], all.powers[2][1][1], 1e-9);
  EXPECT_NEAR(sum.values[1][0][1], all.values[1][0][1], 1e-9);
}

TEST(MeanPolynomial, OfDegreeTwoIsExactForAQuadraticFromAnyOfItsVoxels) {
  for (const std::array<Index, 3> size : {std::array<Index, 3>{40, 30, 1}, {17, 12, 9}}) {
    const Picture p = paint(size, quadratic);
    const RegionMoments region = region_moments(p.values, p.labels, 2, p.grid);
    const MeanPolynomial mean(region, 2, p.grid);
    EXPECT_EQ(mean.parameters(), size[2] > 1 ? 10 : 6);
    EXPECT_NEAR(mean.residual(region), 0, 1e-5);
    EXPECT_GT(MeanPolynomial(region, 1, p.grid).residual(region), 1);
    std::vector<float> row(static_cast<std::size_t>(size[0]));
    const Index last = size[1] * size[2] - 1;
    mean.fill_row(last, row);
    for (Index x = 0; x < size[0]; ++x) EXPECT_NEAR(row[x], p.values[last * size[0] + x], 1e-4);
  }
}

}  // namespace
}  // namespace csrbf::region_moments_test
