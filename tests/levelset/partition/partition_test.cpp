#include "csrbf/levelset/partition/grained_partition.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <random>

namespace csrbf::partition_test {
namespace {

constexpr Index n = 96;
constexpr double length = 1.5;

struct Picture {
  Grid grid;
  std::vector<float> values;
  std::vector<std::uint8_t> truth;
};

// value(x, y, inside, a normal number) where inside(x, y).
Picture paint(const std::function<bool(double, double)>& inside,
              const std::function<double(double, double, bool, double)>& value) {
  Picture picture;
  picture.grid.axes = 2;
  picture.grid.size = {n, n, 1};
  std::mt19937 generator(7);
  std::normal_distribution<double> normal(0, 1);
  for (Index j = 0; j < n; ++j)
    for (Index i = 0; i < n; ++i) {
      const auto x = static_cast<double>(i), y = static_cast<double>(j);
      const bool in = inside(x, y);
      picture.truth.push_back(in ? 1 : 0);
      picture.values.push_back(static_cast<float>(value(x, y, in, normal(generator))));
    }
  return picture;
}

Index levels(const std::vector<float>& values) {
  return choose_bins(values, 256).count;
}

struct Found {
  Partition partition;
  double price, price_of_truth, dice;
};

Found find(const Picture& picture, const PartitionOptions& options = {}) {
  const auto [lo, hi] = std::minmax_element(picture.values.begin(), picture.values.end());
  PartitionPrice price(picture.values, static_cast<double>(*lo), static_cast<double>(*hi), picture.grid, {},
                       contour_weight(picture.grid, length), levels(picture.values));
  Found found{options.many < n * n ? find_grained_partition(price, options) : find_partition(price, options), 0, 0, 0};
  found.price = price.fit(found.partition.labels, found.partition.model);
  found.price_of_truth = price.fit(picture.truth, found.partition.model);
  std::array<double, 2> both{0, 0}, sum{0, 0};
  for (std::size_t i = 0; i < picture.truth.size(); ++i)
    for (std::size_t k = 0; k < 2; ++k) {
      const bool in = (found.partition.labels[i] != 0) == (k == 0), true_in = picture.truth[i] != 0;
      both[k] += in && true_in ? 1 : 0;
      sum[k] += (in ? 1 : 0) + (true_in ? 1 : 0);
    }
  found.dice = std::max(2 * both[0] / sum[0], 2 * both[1] / sum[1]);
  return found;
}

bool disc(double x, double y, double cx, double cy, double radius) {
  return std::hypot(x - cx, y - cy) < radius;
}
bool four_discs(double x, double y) {
  return disc(x, y, 24, 24, 11) || disc(x, y, 72, 24, 11) || disc(x, y, 24, 72, 11) || disc(x, y, 72, 72, 11);
}

TEST(Partition, FindsAnObjectOfAThousandthOfTheImage) {
  const Found found = find(paint([](double x, double y) { return disc(x, y, 30, 60, 1.8); },
                                 [](double, double, bool in, double z) { return in + 0.1 * z; }));
  EXPECT_GT(found.dice, 0.99);
  EXPECT_EQ(found.partition.model.shape, MeanShape::constant);
  EXPECT_FALSE(found.partition.model.own_deviations);
}

TEST(Partition, FindsBarsInMuchNoise) {
  const Found found = find(paint([](double x, double) { return std::fmod(x, 24) < 12; },
                                 [](double, double, bool in, double z) { return in + z; }));
  EXPECT_GT(found.dice, 0.95);
  EXPECT_GT(found.partition.gain, 300);
}

TEST(Partition, GainsNothingFromNoise) {
  const Found found =
      find(paint([](double, double) { return false; }, [](double, double, bool, double z) { return z; }));
  EXPECT_LT(found.partition.gain, 0);
}

TEST(Partition, IsNoMoreExpensiveThanTheTruth) {
  for (const double noise : {0.1, 0.5, 1.0, 1.4}) {
    const Found found = find(paint([](double x, double y) { return disc(x, y, 50, 45, 25); },
                                   [&](double, double, bool in, double z) { return in + noise * z; }));
    EXPECT_LE(found.price, found.price_of_truth + 1) << noise;
    EXPECT_GT(found.dice, 0.96) << noise;
    for (std::size_t i = 1; i < found.partition.energy.size(); ++i)
      EXPECT_LE(found.partition.energy[i], found.partition.energy[i - 1]);
  }
}

TEST(Partition, TellsEqualMeansApartByTheirDeviations) {
  const Found found = find(paint([](double x, double y) { return disc(x, y, 50, 45, 25); },
                                 [](double, double, bool in, double z) { return (in ? 2 : 1) * z; }));
  EXPECT_TRUE(found.partition.model.own_deviations);
  EXPECT_GT(found.dice, 0.95);
}

TEST(Partition, TellsShapesOfEqualMeansAndDeviationsApart) {
  std::mt19937 generator(3);
  std::exponential_distribution<double> exponential(1);
  const auto inside = [](double x, double y) { return disc(x, y, 50, 45, 28); };
  // Skew to either side; heavy tails beside none.
  const Found skew = find(
      paint(inside, [&](double, double, bool in, double) { return (in ? 1 : -1) * (exponential(generator) - 1); }));
  EXPECT_TRUE(skew.partition.model.own_shapes);
  EXPECT_GT(skew.dice, 0.95);
  const Found tails = find(paint(inside, [&](double, double, bool in, double z) {
    const double sign = z > 0 ? 1 : -1;
    return in ? sign * exponential(generator) / std::sqrt(2.0) : std::sqrt(3.0) * std::erf(z / std::sqrt(2.0));
  }));
  EXPECT_TRUE(tails.partition.model.own_shapes);
  EXPECT_GT(tails.dice, 0.95);
}

// Photons: the voxels without any have no deviation, and are no region.
TEST(Partition, TakesFewLevelsForWhatTheyAre) {
  std::mt19937 generator(4);
  const Picture picture = paint([](double x, double y) { return disc(x, y, 50, 45, 28); },
                                [&](double, double, bool in, double) {
                                  return static_cast<double>(std::poisson_distribution<int>(in ? 1.2 : 0.2)(generator));
                                });
  EXPECT_GT(find(picture).dice, 0.9);
}

// Nearly all starts say "noise" or "dark": voxels a few apart tell what these share.
TEST(Partition, FindsHeavyNoiseNoHindrance) {
  std::mt19937 generator(5);
  std::student_t_distribution<double> student(2);
  const Found found =
      find(paint(four_discs, [&](double, double, bool in, double) { return in + 0.25 * student(generator); }));
  EXPECT_GT(found.dice, 0.95);
}

TEST(Partition, SeesThroughLightThatVariesMoreThanTheObjects) {
  const Found found =
      find(paint(four_discs, [](double x, double, bool in, double z) { return in + x / 32 + 0.1 * z; }));
  EXPECT_EQ(found.partition.model.shape, MeanShape::linear);
  EXPECT_GT(found.dice, 0.99);
}

// What the means of large images are is chosen on blocks of their voxels.
TEST(Partition, SeesThroughLightInImagesOfManyVoxels) {
  const Picture picture = paint(four_discs, [](double x, double, bool in, double noise) {
    return (in ? 160 : 100) * (0.5 + 1.5 * x / static_cast<double>(n)) + 8 * noise;
  });
  PartitionOptions options;
  options.many = n * n / 2;
  const Found found = find(picture, options);
  EXPECT_GT(found.dice, 0.95);
  EXPECT_NE(found.partition.model.shape, MeanShape::constant);
  // What prefer_sharp_labels() compares with.
  EXPECT_EQ(found.partition.others.size(), 1);
  options.shape = MeanShape::constant;
  EXPECT_EQ(find(picture, options).partition.model, PartitionModel());
  options.shape = MeanShape::quadratic;
  EXPECT_EQ(find(picture, options).partition.model.shape, MeanShape::quadratic);
}

// Light that is no quadratic, and borders that a camera blurs: what is left of them is no structure of the regions.
TEST(Partition, SeesThroughLightThatNoModelFits) {
  const auto upper = [](double x, double y) { return y > 40 + 0.2 * x; };
  for (const double width : {0.01, 2.0}) {
    const Found found = find(paint(upper, [&](double x, double y, bool, double z) {
      const double light = 0.4 + 1.2 * std::exp(-4 * (std::pow(x / n - 0.4, 2) + std::pow(y / n - 0.6, 2)));
      return light * (0.6 + 1 / (1 + std::exp((40 + 0.2 * x - y) / width))) + 0.02 * z;
    }));
    EXPECT_GT(found.dice, 0.95) << width;
  }
}

TEST(Partition, SeesBarsThroughLightAndHeavyNoise) {
  std::mt19937 generator(6);
  std::student_t_distribution<double> student(2.5);
  const Found found = find(paint([](double x, double) { return std::fmod(x, 16) < 8; },
                                 [&](double x, double, bool in, double) {
                                   const double light = 0.4 + 1.2 * x / n;
                                   return light * (in ? 1.6 : 0.6) + 0.5 * std::clamp(student(generator), -30.0, 30.0);
                                 }));
  EXPECT_TRUE(found.partition.model.own_shapes);
  EXPECT_NE(found.partition.model.shape, MeanShape::constant);
  EXPECT_GT(found.dice, 0.85);
}

TEST(Partition, SeesThreeRegionsThroughLightThatVaries) {
  Picture picture = paint(
      [](double x, double y) { return disc(x, y, 50, 45, 35); },
      [](double x, double y, bool in, double z) { return in + (disc(x, y, 50, 45, 18) ? 1 : 0) + x / 32 + 0.1 * z; });
  const auto [lo, hi] = std::minmax_element(picture.values.begin(), picture.values.end());
  PartitionPrice price(picture.values, static_cast<double>(*lo), static_cast<double>(*hi), picture.grid, {},
                       contour_weight(picture.grid, length));
  const Partition found = find_partition(price, {.regions = 3});
  EXPECT_EQ(found.model.shape, MeanShape::linear);
  std::array<std::array<int, 3>, 3> counts{};  // of labels and rings
  for (Index i = 0; i < n * n; ++i) {
    const auto x = static_cast<double>(i % n), y = static_cast<double>(i / n);
    const std::size_t ring = disc(x, y, 50, 45, 18) ? 2 : disc(x, y, 50, 45, 35) ? 1 : 0;
    ++counts[found.labels[static_cast<std::size_t>(i)]][ring];
  }
  int alike = 0;
  for (const std::array<int, 3>& label : counts) alike += *std::max_element(label.begin(), label.end());
  EXPECT_GT(alike, 0.99 * n * n);
}

TEST(Partition, GivesDimAndBrightObjectsMeansOfTheirOwn) {
  const Found found = find(paint(four_discs, [](double x, double y, bool in, double z) {
    return in * (x < 48 ? 1.0 : 0.25) * (y < 48 ? 1 : 0.6) + 0.02 * z;
  }));
  EXPECT_EQ(found.partition.model.shape, MeanShape::objects);
  EXPECT_GT(found.dice, 0.99);
}

TEST(Partition, KeepsSeedsAndSaysWhichRegionIsWhich) {
  const Picture picture = paint([](double x, double y) { return disc(x, y, 50, 45, 25); },
                                [](double, double, bool in, double z) { return in + 0.3 * z; });
  std::vector<std::uint8_t> seeds(picture.values.size(), 0);
  const auto at = [](Index x, Index y) { return static_cast<std::size_t>(x + n * y); };
  seeds[at(50, 45)] = 1;  // the bright disc is label 0
  seeds[at(48, 45)] = 1;
  seeds[at(5, 5)] = 2;
  seeds[at(8, 5)] = 2;
  seeds[at(90, 90)] = 1;  // against its value
  const auto [lo, hi] = std::minmax_element(picture.values.begin(), picture.values.end());
  PartitionPrice price(picture.values, static_cast<double>(*lo), static_cast<double>(*hi), picture.grid, {},
                       contour_weight(picture.grid, length));
  price.set_seeds({seeds, {}});
  const Partition found = find_partition(price);
  Index wrong = 0;
  for (std::size_t i = 0; i < seeds.size(); ++i) {
    EXPECT_TRUE(seeds[i] == 0 || found.labels[i] == seeds[i] - 1) << i;
    wrong += found.labels[i] == picture.truth[i] ? 1 : 0;
  }
  EXPECT_LT(wrong, 60);  // of 9216
}

// Of a block of uncertain seeds in plain noise, each costs log(p / (1 - p)) in the other region.
TEST(Partition, WeighsUncertainSeeds) {
  const Picture picture = paint([](double x, double y) { return disc(x, y, 30, 45, 20); },
                                [](double, double, bool in, double z) { return in + 0.7 * z; });
  const auto at = [](Index x, Index y) { return static_cast<std::size_t>(x + n * y); };
  std::vector<std::uint8_t> seeds(picture.values.size(), 0);
  for (Index y = 35; y < 55; ++y)
    for (Index x = 20; x < 40; ++x) seeds[at(x, y)] = 2;
  seeds[at(5, 5)] = seeds[at(90, 5)] = 1;
  for (Index y = 40; y < 52; ++y)
    for (Index x = 70; x < 82; ++x) seeds[at(x, y)] = 2;
  const auto [lo, hi] = std::minmax_element(picture.values.begin(), picture.values.end());
  PartitionPrice price(picture.values, static_cast<double>(*lo), static_cast<double>(*hi), picture.grid, {},
                       contour_weight(picture.grid, length));
  const auto share = [&](double confidence) {
    price.set_seeds(seed_costs(seeds, confidence, {}, 2));
    const Partition found = find_partition(price, {.model = PartitionModel()});
    double inside = 0;
    for (Index y = 40; y < 52; ++y)
      for (Index x = 70; x < 82; ++x) inside += found.labels[at(x, y)] / 144.0;
    return inside;
  };
  EXPECT_LT(share(0.6), 0.1);  // a voxel says a nat against it, a seed 0.4 nats for it
  EXPECT_GT(share(0.95), 0.9);
  EXPECT_NEAR(share(1), 1, 1e-9);
}

TEST(SeedCosts, AreLogarithmsOfRatios) {
  const std::vector<std::uint8_t> seeds{0, 1, 2, 3};
  EXPECT_TRUE(seed_costs(seeds, 1, {}, 3).nats.empty());
  EXPECT_TRUE(seed_costs(seeds, 1, {}, 3).is_certain(1));
  EXPECT_FALSE(seed_costs(seeds, 1, {}, 3).is_certain(0)) << "no seed";
  EXPECT_NEAR(seed_costs(seeds, 0.9, {}, 2).at(1), std::log(9), 1e-6);
  EXPECT_NEAR(seed_costs(seeds, 0.9, {}, 3).at(1), std::log(18), 1e-6);
  const std::vector<float> single{1, 0.75F, 1, 0.2F};
  const SeedCosts costs = seed_costs(seeds, 0.5, single, 3);
  EXPECT_NEAR(costs.at(1), std::log(6), 1e-6);
  EXPECT_TRUE(costs.is_certain(2));
  EXPECT_EQ(costs.at(3), 0) << "less likely than chance says nothing";
}

TEST(Partition, ConsidersOnlyTheModelGiven) {
  const Picture picture = paint([](double x, double y) { return disc(x, y, 50, 45, 25); },
                                [](double, double, bool in, double z) { return in + 0.3 * z; });
  PartitionPrice price(picture.values, -1, 2, picture.grid, {}, contour_weight(picture.grid, length));
  const PartitionModel linear{MeanShape::linear};
  const Partition found = find_partition(price, {.model = linear});
  EXPECT_EQ(found.model, linear);
  ASSERT_EQ(found.prices.size(), 1);
  EXPECT_EQ(found.prices[0].model, linear);
}

TEST(Partition, DoesNotTakeStructuresForDeviations) {
  // The inside of a blurred spot is no law of independent voxels.
  const Found found = find(paint([](double x, double y) { return disc(x, y, 48, 48, 12); },
                                 [](double x, double y, bool, double z) {
                                   const double r = std::hypot(x - 48, y - 48);
                                   return 1 / (1 + std::exp((r - 12) / 2)) + 0.3 * std::exp(-r / 20) + 0.005 * z;
                                 }));
  EXPECT_FALSE(found.partition.model.own_deviations);
  EXPECT_GT(found.dice, 0.85);  // the flank of the spot belongs to either side
}

TEST(Partition, FindsThinLinesInLightOfThriceTheirContrast) {
  const auto lines = [](double x, double y) {
    return std::abs(x - 30 - 12 * std::sin(y / 14)) < 1.5 || std::abs(y - 66 - 10 * std::sin(x / 11)) < 1.5;
  };
  const Found found = find(paint(lines, [](double x, double y, bool in, double z) {
    return 3 * std::sin(x / 17) * std::cos(y / 13) - (in ? 1 : 0) + 0.15 * z;
  }));
  EXPECT_GT(found.dice, 0.95);
  EXPECT_TRUE(found.partition.converged);
}

// Sums of them are as smooth as light.
TEST(Partition, DoesNotTakeBlurredSpotsForLight) {
  const auto height = [](double x, double y) {
    double sum = 0;
    for (const auto& [a, b] : {std::pair{18, 20}, {60, 16}, {82, 50}, {40, 48}, {22, 78}, {66, 82}})
      sum += std::exp(-((x - a) * (x - a) + (y - b) * (y - b)) / 72);
    return sum;
  };
  const auto in_spot = [&](double x, double y) { return height(x, y) > 0.5; };
  const Found found = find(paint(in_spot, [&](double x, double y, bool, double z) { return height(x, y) + 0.05 * z; }));
  EXPECT_GT(found.dice, 0.8);
}

TEST(Partition, ListsAPriceForEachModelAboveTheOneChosen) {
  const Found found = find(paint(four_discs, [](double, double, bool in, double z) { return in + 0.1 * z; }));
  ASSERT_EQ(found.partition.prices.size(), 11);
  double least = 1e9;
  for (const ModelPrice& each : found.partition.prices) least = std::min(least, each.nats);
  EXPECT_NEAR(least, 0, 1);
}

}  // namespace
}  // namespace csrbf::partition_test
