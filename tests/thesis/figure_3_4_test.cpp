#include "thesis/figure_3_4.hpp"

#include "thesis/signals.hpp"

#include <gtest/gtest.h>

namespace csrbf::thesis::figure_3_4_test {
namespace {

constexpr double rounding = 1 + 1e-9;

TEST(Figure_3_4, TheSignalHasTheValuesOfItsFormula) {
  EXPECT_NEAR(wavy_signal(0), 0.75 * std::exp(-1.875) * std::sin(0.1), 1e-14);
  EXPECT_NEAR(wavy_signal(0.75), 2 * sinc(7.5) + 0.75 * std::sin(37.6) - 2 * std::exp(-7.5) * std::cos(41.25), 1e-14);
}

TEST(Figure_3_4, EverySampleIsWithinTheThreshold) {
  for (const double threshold : {0.3, 0.1, 0.01}) {
    const SignalLevels s = signal_levels(threshold);
    EXPECT_LE(s.max_errors.back(), threshold * rounding);
  }
}

TEST(Figure_3_4, TheErrorFallsFromTheFirstToTheLastLevel) {
  const SignalLevels s = signal_levels(0.1);
  ASSERT_GE(s.levels.cols(), 3);
  EXPECT_LT(rms(s.levels.rightCols(1), s.truth), rms(s.levels.col(0), s.truth) / 4);
}

TEST(Figure_3_5, NoiseHasTheSignalToNoiseRatioAskedFor) {
  const Eigen::VectorXd signal = Eigen::VectorXd::Constant(100000, 2);
  Eigen::VectorXd noisy = signal;
  EXPECT_NEAR(add_noise(noisy, 20, 1), 0.2, 1e-12);
  EXPECT_NEAR(rms(noisy, signal), 0.2, 0.002);
}

TEST(Figure_3_6, BetweenTooLowAndTooHighThereIsABestThreshold) {
  const std::vector<double> thresholds{0.005, 0.01, 0.02, 0.04, 0.08, 0.16, 0.32, 0.64};
  for (const double snr : {21.0, 27.0, 30.0}) {
    const ThresholdCurve curve = threshold_curve(snr, thresholds, 15);
    const double best = curve.errors[curve.best()];
    EXPECT_LT(1.05 * best, curve.errors.front()) << snr;
    EXPECT_LT(5 * best, curve.errors.back()) << snr;
    // About twice the noise; the thresholds are a factor of 2 apart, the curve is flat around its minimum.
    EXPECT_GT(thresholds[curve.best()], 0.7 * curve.noise) << snr;
    EXPECT_LT(thresholds[curve.best()], 5 * curve.noise) << snr;
  }
}

TEST(Figure_3_6, WithTheBestThresholdTheErrorIsBelowTheNoise) {
  const std::vector<double> thresholds{0.01, 0.02, 0.04, 0.08, 0.16, 0.32};
  for (const double snr : {15.0, 21.0, 27.0}) {
    const ThresholdCurve curve = threshold_curve(snr, thresholds, 5);
    EXPECT_LT(curve.errors[curve.best()], 0.95 * curve.noise) << snr;
  }
}

}  // namespace
}  // namespace csrbf::thesis::figure_3_4_test
