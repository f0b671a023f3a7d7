#include "csrbf/approx/levels/fixed_budget.hpp"

#include "approx/approx_testing.hpp"
#include "csrbf/approx/levels/level_sum.hpp"

namespace csrbf::fixed_budget_test {
namespace {

TEST(FixedBudget, UsesAsManyCentresAsItMay) {
  const Samples<2> data = sample<2>(random_points<2>(1000, 1), franke);
  EXPECT_EQ(fixed_budget<2>(data, {.centers = 123}).last().centers, 123);
  EXPECT_EQ(fixed_budget<2>(data).last().centers, 100);
  EXPECT_EQ(fixed_budget<2>(data, {.centers = 5000}).last().centers, 1000);
}

// Budgets of 25 and 100; then the narrow supports keep the error where it is, and wide ones go on.
TEST(FixedBudget, ErrsLessTheMoreCentresItHasUntilItStalls) {
  const Samples<2> data = sample<2>(random_points<2>(4000, 1), franke);
  const auto error = [&](Index centers, double support) {
    return rms_error<2>(*fixed_budget<2>(data, {.centers = centers, .support = support}).fields[0], franke);
  };
  EXPECT_LT(error(100, 4), .5 * error(25, 4));
  EXPECT_LT(error(1600, 4), 1.5 * error(100, 4));
  EXPECT_LT(error(400, 12), .3 * error(100, 12));
  EXPECT_LT(error(400, 12), .3 * error(400, 4));
}

// Supports that follow the density of the samples: near the dense corner they are narrow.
TEST(FixedBudget, CoversTheBoxWithSupportsOfTheSizeOfTheCells) {
  Points<2> points = random_points<2>(3000, 1);
  points = points.array().cube();
  const BudgetCenters<2> chosen = budget_centers<2>(points, 200);
  const Points<2> x = random_points<2>(2000, 2);
  const Box<2> box = bounding_box<2>(points);
  for (Index q = 0; q < x.cols(); ++q) {
    if (!box.contains(x.col(q))) continue;
    bool covered = false;
    for (std::size_t j = 0; j < chosen.ids.size() && !covered; ++j)
      covered = (points.col(chosen.ids[j]) - x.col(q)).norm() <= chosen.scales[static_cast<Index>(j)] * (1 + 1e-12);
    EXPECT_TRUE(covered);
  }
}

template <int Dim>
void expect_fit() {
  const Samples<Dim> data = sample<Dim>(random_points<Dim>(800, 1), waves<Dim>);
  const auto fit = fixed_budget<Dim>(data, {.centers = 200});
  const double spread =
      std::sqrt((data.values.array() - data.values.mean()).square().sum() / static_cast<double>(data.size()));
  EXPECT_LT(fit.last().rmse, .3 * spread) << Dim;
  EXPECT_NEAR(largest_error<Dim>(*fit.fields[0], data), fit.last().max_error, 1e-9) << Dim;
}

TEST(FixedBudget, FitsInAllDimensions) {
  expect_fit<1>();
  expect_fit<2>();
  expect_fit<3>();
  expect_fit<4>();
  expect_fit<5>();
  expect_fit<6>();
}

TEST(FixedBudget, RefusesSupportsThatLeaveGaps) {
  const Samples<2> data = sample<2>(random_points<2>(10, 1), franke);
  try {
    fixed_budget<2>(data, {.support = 1});
    FAIL();
  } catch (const InvalidInput& error) {
    EXPECT_STREQ(
        error.what(),
        "fixed_budget: support = 1: must be above 1, or the supports do not cover the domain; 2 to 4 is usual");
  }
  EXPECT_THROW(fixed_budget<2>(data, {.centers = -1}), InvalidInput);
}

}  // namespace
}  // namespace csrbf::fixed_budget_test
