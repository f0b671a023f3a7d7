#include "csrbf/levelset/regions/bin_probabilities.hpp"

#include "levelset/intensity_testing.hpp"

#include <gtest/gtest.h>

namespace csrbf::bin_probabilities_test {
namespace {

BinProbabilities probabilities(const RegionModel& model, const IntensityBins& bins) {
  BinProbabilities p;
  bin_probabilities(model, bins, p);
  return p;
}

// Integral of the density over [a, b] by the midpoint rule.
double integral(const RegionModel& model, double a, double b) {
  constexpr int steps = 20000;
  const bool one_sided = model.law == IntensityLaw::rayleigh || model.law == IntensityLaw::gamma;
  double sum = 0;
  for (int i = 0; i < steps; ++i) {
    const double x = a + (b - a) * (i + .5) / steps;
    if (!one_sided || x > model.location) sum += std::exp(log_density(model, x));
  }
  return sum * (b - a) / steps;
}

class EveryLaw : public testing::TestWithParam<RegionModel> {
 protected:
  const RegionModel model = GetParam();
  const IntensityBins bins{-1.1, 2.9, 40};
};

TEST_P(EveryLaw, SumsToOne) {
  EXPECT_NEAR(probabilities(model, bins).values.sum(), 1, 2e-6);
}

TEST_P(EveryLaw, HasTheIntegralsOfTheDensityInTheInnerBins) {
  const BinProbabilities p = probabilities(model, bins);
  constexpr double tolerance = 3e-6;  // the contamination, and the midpoint rule at cusps
  for (Index k = 1; k + 1 < bins.count; ++k) {
    const double a = bins.lo + static_cast<double>(k) * bins.width();
    EXPECT_NEAR(p.values[k], integral(model, a, a + bins.width()), tolerance) << k;
  }
}

TEST_P(EveryLaw, HasTheTailsInTheEndBins) {
  const BinProbabilities p = probabilities(model, bins);
  const double far = 60 * model.scale;
  EXPECT_NEAR(p.values[0], integral(model, bins.lo - far, bins.lo + bins.width()), 1e-4);
  EXPECT_NEAR(p.values[39], integral(model, bins.hi - bins.width(), bins.hi + far), 1e-4);
}

TEST_P(EveryLaw, HasTheDerivativesOfItsProbabilities) {
  const BinProbabilities p = probabilities(model, bins);
  constexpr double h = 1e-4;
  constexpr double tolerance = 5e-5;  // the quadrature, for shape 12
  const auto difference = [&](double location, double scale, double shape) {
    const auto moved = [&](double sign) {
      RegionModel m = model;
      m.location += sign * h * location * m.scale;
      m.scale *= std::exp(sign * h * scale);
      m.shape *= std::exp(sign * h * shape);
      return probabilities(m, bins).values;
    };
    return Eigen::VectorXd((moved(1) - moved(-1)) / (2 * h));
  };
  const bool centred = model.law == IntensityLaw::gaussian || model.law == IntensityLaw::generalized_gaussian;
  const bool shaped = model.law == IntensityLaw::gamma || model.law == IntensityLaw::generalized_gaussian;
  if (centred) {
    EXPECT_LT((p.derivatives.col(0) - difference(1, 0, 0)).lpNorm<Eigen::Infinity>(), tolerance);
  }
  EXPECT_LT((p.derivatives.col(1) - difference(0, 1, 0)).lpNorm<Eigen::Infinity>(), tolerance);
  if (shaped) {
    EXPECT_LT((p.derivatives.col(2) - difference(0, 0, 1)).lpNorm<Eigen::Infinity>(), tolerance);
  }
}

INSTANTIATE_TEST_SUITE_P(
    OfBins, EveryLaw,
    testing::Values(RegionModel{IntensityLaw::gaussian, .63, .4, 2}, RegionModel{IntensityLaw::gaussian, -1.2, 2, 2},
                    RegionModel{IntensityLaw::generalized_gaussian, .63, .4, 2},
                    RegionModel{IntensityLaw::generalized_gaussian, .73, .3, 1},
                    RegionModel{IntensityLaw::generalized_gaussian, .651, .01, .6},
                    RegionModel{IntensityLaw::generalized_gaussian, .63, .9, 12},
                    RegionModel{IntensityLaw::rayleigh, -1.1, .8, 2}, RegionModel{IntensityLaw::rayleigh, .2, .5, 2},
                    RegionModel{IntensityLaw::gamma, -1.1, .4, 2.5}, RegionModel{IntensityLaw::gamma, -.5, .3, 1.2},
                    RegionModel{IntensityLaw::gamma, -3, .1, 40}));

TEST(BinProbabilities, AreRightWhereTheDensityIsSharperThanABin) {
  // Laplace: half of 1 - exp(-d / scale) lies within d on either side.
  const IntensityBins bins{0, 10, 10};
  const RegionModel model{IntensityLaw::generalized_gaussian, 4.3, .05, 1};
  const BinProbabilities p = probabilities(model, bins);
  EXPECT_NEAR(p.values[4], 1 - .5 * std::exp(-.3 / .05) - .5 * std::exp(-.7 / .05), 2e-6);
  EXPECT_NEAR(p.values[3], .5 * std::exp(-.3 / .05), 2e-6);
}

TEST(BinProbabilities, AreNeverZero) {
  const IntensityBins bins{0, 1000, 250};
  for (const IntensityLaw law :
       {IntensityLaw::gaussian, IntensityLaw::generalized_gaussian, IntensityLaw::rayleigh, IntensityLaw::gamma}) {
    const BinProbabilities p = probabilities({law, 0, 2, 3}, bins);
    EXPECT_GE(p.values.minCoeff(), BinProbabilities::contamination / 250);
    EXPECT_LE(p.values.maxCoeff(), 1);
    EXPECT_TRUE(p.derivatives.allFinite());
  }
}

TEST(BinProbabilities, OfOneBinAreOne) {
  EXPECT_EQ(probabilities({IntensityLaw::gaussian, 0, 1, 2}, {0, 1, 1}).values[0], 1);
}

}  // namespace
}  // namespace csrbf::bin_probabilities_test
