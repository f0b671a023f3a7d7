#include "csrbf/approx/samples/robust_weights.hpp"
#include "csrbf/approx/samples/missing_marks.hpp"

#include "approx/approx_testing.hpp"

#include "csrbf/approx/samples/local_deviations.hpp"

#include <algorithm>
#include <numeric>

namespace csrbf::robust_weights_test {
namespace {

template <int Dim, class Function>
Samples<Dim> noisy(Index n, const Function& f, double sigma, unsigned seed = 5) {
  Samples<Dim> data = sample<Dim>(random_points<Dim>(n, seed), f);
  std::mt19937_64 random(seed);
  std::normal_distribution<double> error;
  for (double& value : data.values.reshaped()) value += sigma * error(random);
  return data;
}

TEST(RobustWeights, FindsGrossErrorsAndNoOthers) {
  for (const double sigma : {0.0, .02}) {
    Samples<2> data = noisy<2>(1500, franke, sigma);
    std::vector<Index> expected;
    for (Index i = 10; i < 1500; i += 40) {
      data.values(i) += i % 80 < 40 ? 5 : -3;
      expected.push_back(i);
    }
    const RobustWeights found = robust_weights(data, "auto");
    EXPECT_EQ(found.gross_errors, expected) << sigma;
    for (const Index i : expected) EXPECT_EQ(found.factors[i], 0);
    EXPECT_EQ(found.factors.sum(), 1500 - static_cast<double>(expected.size()));
  }
}

TEST(RobustWeights, TakesNothingForAnErrorWhereThereAreNone) {
  const auto step = [](const Point<2>& p) { return p[0] + .3 * p[1] > .6 ? 1. : 0.; };
  const auto bump = [](const Point<2>& p) { return std::exp(-300 * (p - Point<2>(.4, .6)).squaredNorm()); };
  for (unsigned seed = 1; seed <= 3; ++seed) {
    EXPECT_TRUE(robust_weights(noisy<2>(1500, franke, 0, seed), "auto").gross_errors.empty());
    EXPECT_TRUE(robust_weights(noisy<2>(1500, franke, .1, seed), "auto").gross_errors.empty());
    EXPECT_TRUE(robust_weights(noisy<2>(1500, step, .01, seed), "auto").gross_errors.empty());
    EXPECT_TRUE(robust_weights(noisy<2>(1500, bump, .01, seed), "auto").gross_errors.empty());
    EXPECT_TRUE(robust_weights(noisy<1>(300, waves<1>, .1, seed), "auto").gross_errors.empty());
    EXPECT_TRUE(robust_weights(noisy<5>(300, waves<5>, 0, seed), "auto").gross_errors.empty());
  }
}

// Some samples anywhere, and many on tracks and in clusters: the nearest ones of a sample may be on one side of it.
Samples<2> uneven(Index n, unsigned seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::normal_distribution<double> normal;
  Points<2> ends = random_points<2>(24, seed), points = random_points<2>(n, seed + 1);
  for (Index i = n / 15; i < n; ++i) {
    const Index k = static_cast<Index>(random() % 12);
    const double t = i < n / 2 ? uniform(random) : 0, width = i < n / 2 ? 1e-4 : .02;
    points.col(i) = (1 - t) * ends.col(2 * k) + t * ends.col(2 * k + 1);
    for (double& x : points.col(i)) x += width * normal(random);
  }
  return sample<2>(points, [](const Point<2>& p) { return std::sin(7 * p[0] + 3 * p[1]) + std::cos(9 * p[1]); });
}

TEST(RobustWeights, TellErrorsWhereTheOthersAreOnOneSide) {
  std::size_t false_errors = 0, found = 0, errors = 0;
  for (unsigned seed = 1; seed <= 6; ++seed) {
    Samples<2> data = uneven(600 * seed, seed);
    false_errors += robust_weights(data, "auto").gross_errors.size();
    for (Index i = 10; i < data.size(); i += 60, ++errors) data.values(i) += i % 120 < 60 ? 5 : -3;
    for (const Index i : robust_weights(data, "auto").gross_errors) found += i % 60 == 10 ? 1 : 0;
  }
  EXPECT_LE(false_errors, 1);
  EXPECT_GE(found, errors * 95 / 100);
}

// Samples that are known to be imprecise are no errors, but may have some.
TEST(RobustWeights, ExpectLargerErrorsOfSamplesOfLessWeight) {
  Samples<2> data = noisy<2>(1500, franke, .02);
  data.weights = Eigen::VectorXd::Ones(1500);
  std::mt19937_64 random(3);
  std::normal_distribution<double> error;
  for (Index i = 0; i < 1500; i += 10) {
    data.weights[i] = 4e-4;
    data.values(i) += error(random);
  }
  EXPECT_TRUE(robust_weights(data, "auto").gross_errors.empty());
  std::vector<Index> expected;
  for (Index i = 10; i < 1500; i += 60) {
    data.values(i) += i % 120 < 60 ? 300 : -200;
    expected.push_back(i);
  }
  EXPECT_EQ(robust_weights(data, "auto").gross_errors, expected);
}

// Among the nearest samples by kilometres, all depths are seen.
TEST(RobustWeights, TakesNoLayerForErrorsWhereUnitsDiffer) {
  const auto layer = [](const Point<3>& p) { return std::exp(-200 * std::pow(p[2] - .5 - .2 * p[0], 2)); };
  for (unsigned seed = 1; seed <= 6; ++seed) {
    Samples<3> data = noisy<3>(2600, layer, .01, seed);
    data.points.row(0) *= 20;
    data.points.row(1) *= 30;
    EXPECT_TRUE(robust_weights(data, "auto").gross_errors.empty());
    std::vector<Index> errors;
    for (Index i = 7; i < 2600; i += 60) {
      data.values(i) += 10;
      errors.push_back(i);
    }
    EXPECT_EQ(robust_weights(data, "auto").gross_errors, errors);
  }
}

// A wrong coordinate is no unit.
TEST(RobustWeights, FindsErrorsBesideAFarSample) {
  Samples<2> data = noisy<2>(3000, franke, .01);
  for (Index i = 7; i < 3000; i += 60) data.values(i) += 10;
  const std::vector<Index> errors = robust_weights(data, "auto").gross_errors;
  EXPECT_GE(std::ssize(errors), 48);
  data.points.col(1) << 1e4, .5;
  EXPECT_EQ(robust_weights(data, "auto").gross_errors, errors);
}

TEST(RobustWeights, KeepsThePeaksOfFewSamplesAndNamesThem) {
  const Points<1> x = Eigen::RowVectorXd::LinSpaced(12, 0, 1);
  const RobustWeights found =
      robust_weights(sample<1>(x, [](const Point<1>& p) { return std::exp(6 * p[0]); }), "auto");
  EXPECT_EQ(found.factors.size(), 0);
  EXPECT_TRUE(found.gross_errors.empty());
  EXPECT_EQ(found.suspects.back(), 11);
}

TEST(RobustWeights, LooksAtAllOfManySamplesWhereSomeAreErrors) {
  Samples<2> data = noisy<2>(20'000, franke, .02);
  EXPECT_EQ(robust_weights(data, "auto").factors.size(), 0);
  for (Index i = 0; i < 20'000; i += 50) data.values(i) += 3;
  EXPECT_EQ(robust_weights(data, "auto").gross_errors.size(), 400U);
}

TEST(RobustWeights, FindsAllMarksOfMissingValues) {
  for (const double mark : {-9999.0, 1e20}) {
    Samples<2> data = noisy<2>(2000, franke, .02);
    std::mt19937_64 random(3);
    std::vector<Index> expected;
    for (Index i = 0; i < 2000; ++i) {
      if (random() % 20 != 0) continue;  // some are neighbours
      data.values(i) = mark;
      expected.push_back(i);
    }
    EXPECT_EQ(robust_weights(data, "auto").gross_errors, expected) << mark;
  }
}

// A sensor that saturates on a peak is no mark, also where a few such values are elsewhere.
TEST(RobustWeights, KeepsSaturatedPeaks) {
  Samples<2> data = noisy<2>(2000, franke, .02);
  std::vector<Index> peak;
  for (Index i = 0; i < 2000; ++i)
    if ((data.points.col(i) - Point<2>(.3, .6)).norm() < .04) peak.push_back(i);
  for (const Index i : peak) data.values(i) = 50;
  for (const Index i : {100, 700, 1500}) data.values(i) = 50;
  const std::vector<Index> found = robust_weights(data, "auto").gross_errors;
  const auto lost = std::count_if(peak.begin(), peak.end(),
                                  [&](Index i) { return std::binary_search(found.begin(), found.end(), i); });
  EXPECT_GT(std::ssize(found), lost);  // those elsewhere
  EXPECT_LT(2 * lost, std::ssize(peak));
}

TEST(RobustWeights, KeepsThinThings) {
  const auto joints = [](const Point<2>& p) { return std::fmod(p[0], .25) < .01 ? 0. : 1 + .3 * p[1]; };
  EXPECT_TRUE(robust_weights(noisy<2>(4000, joints, .02), "auto").gross_errors.empty());
}

TEST(RobustWeights, KeepsNarrowPeaksOfSeveralSamples) {
  for (const Index n : {100, 150, 600}) {
    Index kept = 0, left_out = 0;
    for (unsigned seed = 1; seed <= 10; ++seed) {
      const double width = .6 / std::sqrt(static_cast<double>(n));
      const Samples<2> data = sample<2>(random_points<2>(n, seed), [&](const Point<2>& p) {
        return std::exp(-(p - Point<2>(.5, .5)).squaredNorm() / (2 * width * width));
      });
      const RobustWeights found = robust_weights(data, "auto");
      if ((data.values.array() > .2).count() < 3) continue;
      for (Index i = 0; i < n; ++i)
        if (data.values(i) > .2) ++(found.factors.size() > 0 && found.factors[i] == 0 ? left_out : kept);
    }
    EXPECT_LE(left_out, kept / 4) << n;
  }
}

TEST(RobustWeights, AreThoseOfTheLoss) {
  Samples<2> data = noisy<2>(500, franke, .02);
  data.values(7) += 9;
  EXPECT_EQ(robust_weights(data, "squares").factors.size(), 0);
  for (const std::string loss : {"huber", "student"}) {
    const RobustWeights found = robust_weights(data, loss);
    EXPECT_LE(found.factors[7], .05) << loss;
    EXPECT_LE(found.factors.maxCoeff(), 1) << loss;
    EXPECT_GE((found.factors.array() > .99).count(), 300) << loss;
    EXPECT_NE(std::find(found.gross_errors.begin(), found.gross_errors.end(), 7), found.gross_errors.end());
  }
}

// Two records of one place: the other samples tell which of them is wrong, also if it is the only error of many
// samples.
TEST(RobustWeights, TellWhichOfTwoAtAPlaceIsWrong) {
  for (const Index n : {300, 1500, 5000})
    for (const double sigma : {0.0, .02})
      for (const Index errors : {1, 7}) {
        Samples<2> data = noisy<2>(n, franke, sigma);
        std::vector<Index> expected;
        for (Index k = 0; k < errors; ++k) expected.push_back(n + k);
        const Index all = n + errors;
        data.points.conservativeResize(2, all);
        data.values.conservativeResize(all, 1);
        for (Index k = 0; k < errors; ++k) {
          data.points.col(n + k) = data.points.col(n / 2 + 11 * k);
          data.values(n + k) = data.values(n / 2 + 11 * k) + (k % 2 == 0 ? 1.5 : -2);
        }
        EXPECT_EQ(robust_weights(data, "auto").gross_errors, expected) << n << ' ' << sigma;
      }
}

// Repeated measurements that scatter, but agree with what is around them.
TEST(RobustWeights, KeepsReplicates) {
  for (unsigned seed = 1; seed <= 3; ++seed) {
    Samples<2> data = noisy<2>(900, franke, 0, seed);
    data.points.rightCols(600) = data.points.leftCols(300).replicate(1, 2).eval();
    for (Index i = 300; i < 900; ++i) data.values(i) = data.values(i % 300);
    std::mt19937_64 random(seed);
    std::normal_distribution<double> error;
    for (double& value : data.values.reshaped()) value += .1 * error(random);
    EXPECT_TRUE(robust_weights(data, "auto").gross_errors.empty()) << seed;
  }
}

TEST(RobustWeights, TakesRepeatedPoints) {
  Samples<2> data = noisy<2>(40, franke, .02);
  const Samples<2> once = data;
  data.points = once.points.replicate(1, 20).eval();
  data.values = once.values.replicate(20, 1).eval();
  EXPECT_TRUE(robust_weights(data, "auto").gross_errors.empty());
}

TEST(ValueBeyondAllOthers, IsNamedWhereItMeansNone) {
  Eigen::VectorXd values = Eigen::VectorXd::LinSpaced(100, 2, 8);
  EXPECT_FALSE(value_beyond_all_others(values));
  values[3] = -9999;
  EXPECT_EQ(value_beyond_all_others(values), -9999);
  EXPECT_FALSE(value_beyond_all_others(values, -9999));
  values[3] = 777;
  EXPECT_FALSE(value_beyond_all_others(values));  // one, and not a usual one
  values[30] = 777;
  EXPECT_EQ(value_beyond_all_others(values), 777);
  EXPECT_FALSE(value_beyond_all_others(Eigen::Vector4d(0, 0, 1, 1)));
}

}  // namespace
}  // namespace csrbf::robust_weights_test
