#include "csrbf/surface/prepare/transfer_properties.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/core/parallel.hpp"

#include <gtest/gtest.h>

#include <numeric>
#include <random>

namespace csrbf::transfer_properties_test {
namespace {

Points<3> random_points(Index n, unsigned seed) {
  std::mt19937_64 generator(seed);
  std::uniform_real_distribution<double> coordinate(-1, 1);
  return Points<3>::NullaryExpr(3, n, [&] { return coordinate(generator); });
}

std::vector<Property> random_properties(Index n) {
  std::mt19937_64 generator(3);
  std::uniform_int_distribution<int> byte(0, 255);
  std::vector<Property> properties{{"red", "uchar", {}}, {"label", "uchar", {}}, {"quality", "float", {}}};
  for (Property& p : properties) p.values = Eigen::VectorXd::NullaryExpr(n, [&] { return byte(generator); });
  return properties;
}

TEST(TransferProperties, GivesSamplesTheirOwnValues) {
  const Points<3> samples = random_points(200, 1);
  const std::vector<Property> properties = random_properties(200);
  const std::vector<Property> result = transfer_properties(samples, properties, samples);
  for (std::size_t p = 0; p < properties.size(); ++p) {
    EXPECT_EQ(result[p].values, properties[p].values);
    EXPECT_EQ(result[p].name, properties[p].name);
    EXPECT_EQ(result[p].type, properties[p].type);
  }
}

TEST(TransferProperties, MixesColoursByInverseDistance) {
  Points<3> samples(3, 2);
  samples << 0, 3, 0, 0, 0, 0;
  const std::vector<Property> properties{{"green", "uchar", Eigen::Vector2d(0, 240)},
                                         {"time", "double", Eigen::Vector2d(5, 7)}};
  // Distances 1 and 2: weights 2/3 and 1/3.
  const std::vector<Property> result = transfer_properties(samples, properties, Point<3>(1, 0, 0));
  EXPECT_EQ(result[0].values(0), 80);
  EXPECT_EQ(result[1].values(0), 5);
}

TEST(TransferProperties, AgreesWithBruteForce) {
  const Points<3> samples = random_points(300, 1);
  const Points<3> targets = random_points(100, 2);
  const std::vector<Property> properties = random_properties(300);
  const std::vector<Property> result = transfer_properties(samples, properties, targets);
  for (Index i = 0; i < targets.cols(); ++i) {
    const Eigen::VectorXd distance = (samples.colwise() - targets.col(i)).colwise().norm();
    std::vector<Index> order(300);
    std::iota(order.begin(), order.end(), 0);
    std::sort(order.begin(), order.end(), [&](Index a, Index b) { return distance[a] < distance[b]; });
    double sum = 0;
    double red = 0;
    for (std::size_t k = 0; k < 4; ++k) {
      sum += 1 / distance[order[k]];
      red += properties[0].values[order[k]] / distance[order[k]];
    }
    EXPECT_NEAR(result[0].values[i], red / sum, 0.5 + 1e-9);  // rounded to a whole number
    EXPECT_EQ(result[1].values[i], properties[1].values[order[0]]);
    EXPECT_EQ(result[2].values[i], properties[2].values[order[0]]);
  }
}

TEST(TransferProperties, DoesNotDependOnUnitsOrThreads) {
  const Points<3> samples = random_points(500, 1);
  const Points<3> targets = random_points(500, 2);
  const std::vector<Property> properties = random_properties(500);
  const std::vector<Property> expected = transfer_properties(samples, properties, targets);
  for (const double scale : {0x1p-100, 0x1p100}) {
    const std::vector<Property> result = transfer_properties(scale * samples, properties, scale * targets);
    for (std::size_t p = 0; p < expected.size(); ++p) EXPECT_EQ(result[p].values, expected[p].values);
  }
  set_thread_count(1);
  const std::vector<Property> serial = transfer_properties(samples, properties, targets);
  set_thread_count(0);
  for (std::size_t p = 0; p < expected.size(); ++p) EXPECT_EQ(serial[p].values, expected[p].values);
}

TEST(TransferProperties, LeavesOutSamplesThatAreNotFinite) {
  Points<3> samples(3, 2);
  samples << std::nan(""), 9, 0, 0, 0, 0;
  const std::vector<Property> properties{{"red", "uchar", Eigen::Vector2d(10, 20)}};
  EXPECT_EQ(transfer_properties(samples, properties, Point<3>::Zero())[0].values(0), 20);
  EXPECT_THROW(transfer_properties(samples.leftCols(1), {{"red", "uchar", Eigen::VectorXd::Zero(1)}}, Point<3>::Zero()),
               InvalidInput);
}

TEST(TransferProperties, NeedsOneValuePerSample) {
  EXPECT_THROW(
      transfer_properties(Points<3>::Zero(3, 2), {{"red", "uchar", Eigen::VectorXd::Zero(3)}}, Point<3>::Zero()),
      InvalidInput);
}

}  // namespace
}  // namespace csrbf::transfer_properties_test
