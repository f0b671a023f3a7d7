#include "csrbf/approx/global/choose_kernel.hpp"

#include "approx/interpolate_testing.hpp"
#include "csrbf/approx/basis/expansion.hpp"
#include "csrbf/approx/global/interpolate.hpp"
#include "csrbf/approx/global/kriging_variance.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <ctime>

namespace csrbf::choose_kernel_test {
namespace {

// The case peaks_500: SciPy's best kernel without a shape parameter has 1.2e-3.
TEST(ChooseKernel, InterpolatesPeaksTo1e5WithoutBeingTold) {
  Samples<2> samples{6 * random_points<2>(500, 12345), Eigen::MatrixXd(500, 1), {}};
  samples.points.array() -= 3;
  for (Index i = 0; i < 500; ++i) samples.values(i, 0) = wide_peaks(samples.points.col(i));
  const Interpolation<2> fit = interpolate(samples);
  Points<2> x = 6 * .98 * random_points<2>(1000, 2);
  x.array() += .06 - 3;
  EXPECT_LT(rmse<2>(*fit.components[0], wide_peaks, x), 1e-5);
}

TEST(ChooseKernel, PrefersRoughKernelsForRoughData) {
  const auto cone = [](const Point<2>& p) { return (p - Point<2>(.4, .6)).norm() + std::abs(p[0] - p[1]); };
  const KernelChoice rough = choose_kernel(sample<2>(cone, 200));
  const KernelChoice smooth = choose_kernel(sample<2>(wave<2>, 200));
  EXPECT_LE(rough.kernel.smoothness(), 2) << rough.kernel.name();
  EXPECT_GE(smooth.kernel.smoothness(), 6) << smooth.kernel.name();
  EXPECT_LT(smooth.leave_one_out, 1e-5);
}

TEST(ChooseKernel, TakesNoTimeForAConstant) {
  const Samples<2> samples = sample<2>([](const Point<2>&) { return 5.0; }, 800);
  const std::clock_t start = std::clock();
  const KernelChoice choice = choose_kernel(samples, {.smoothing = {}, .smoothing_patch = 800});
  EXPECT_LT(static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC, 2);  // seconds; looking at all takes over ten
  EXPECT_LT(choice.leave_one_out, 1e-9);
}

TEST(ChooseKernel, ChoosesASupportNearTheBestOne) {
  const Samples<2> samples = sample<2>(franke, 150);
  const Points<2> x = random_points<2>(500, 3);
  for (const char* name : {"gaussian", "inverse-multiquadric", "matern-c4", "wendland-c6"}) {
    const double chosen = rmse<2>(*interpolate(samples, {.kernel = name}).components[0], franke, x);
    double best = 1;
    for (double support = .05; support < 4; support *= 1.15)
      best =
          std::min(best, rmse<2>(*interpolate(samples, {.kernel = name, .support = support}).components[0], franke, x));
    EXPECT_LT(chosen, 1.5 * best) << name;
  }
}

TEST(ChooseKernel, GivesNeighbourhoodsTheSayOfAll) {
  const Samples<2> samples = sample<2>(franke, 500);
  const KernelChoice all = choose_kernel(samples, {.names = {"matern-c6"}, .patch = 500});
  const KernelChoice some = choose_kernel(samples, {.names = {"matern-c6"}, .patch = 150});
  EXPECT_GT(some.support, all.support / 4);
  EXPECT_LT(some.support, all.support * 4);
}

}  // namespace
}  // namespace csrbf::choose_kernel_test
