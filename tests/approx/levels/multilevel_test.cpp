#include "csrbf/approx/levels/multilevel.hpp"

#include "approx/approx_testing.hpp"
#include "core/error_testing.hpp"
#include "csrbf/approx/levels/least_squares.hpp"
#include "csrbf/approx/levels/level_builder.hpp"
#include "csrbf/approx/levels/level_sum.hpp"
#include "csrbf/kernels/kernel.hpp"

namespace csrbf::multilevel_test {
namespace {

constexpr double met = 1e-10;  // interpolation conditions, relative to values of order one

const std::vector<Index> grids = {5, 9, 17, 33};

// RMS errors of interpolating Franke's function on the grids with one support.
template <class Support>
std::vector<double> single_level_errors(const char* kernel, const Support& support_of_spacing) {
  std::vector<double> errors;
  for (const Index n : grids) {
    const Samples<2> data = sample<2>(unit_grid(n), franke);
    LevelBuilder<2> builder(data, "test", {});
    builder.add(Kernel(kernel, 2), data.points,
                Eigen::VectorXd::Constant(1, support_of_spacing(1 / static_cast<double>(n - 1))),
                LevelSolve::interpolation, {});
    errors.push_back(rms_error<2>(*builder.finish().fields[0], franke));
  }
  return errors;
}

std::vector<double> multilevel_errors(const char* kernel) {
  std::vector<double> errors;
  for (const Index n : grids) {
    const auto fit = multilevel<2>(sample<2>(unit_grid(n), franke), {.kernel = kernel, .coarsest = 25});
    errors.push_back(rms_error<2>(*fit.fields[0], franke));
  }
  return errors;
}

double last_order(const std::vector<double>& errors) {
  return std::log2(errors[errors.size() - 2] / errors.back());
}

TEST(Multilevel, IsTheConstantForConstantData) {
  const auto fit = multilevel<2>(sample<2>(random_points<2>(100, 1), [](const Point<2>&) { return 7.25; }));
  EXPECT_EQ((*fit.fields[0])(Point<2>(.3, .4)), 7.25);
  EXPECT_EQ((*fit.fields[0])(Point<2>(30, 40)), 7.25);
  EXPECT_EQ(fit.last().max_error, 0);
}

TEST(Multilevel, FitsOneSample) {
  const auto fit = multilevel<3>(sample<3>(random_points<3>(1, 1), [](const Point<3>&) { return 2.0; }));
  EXPECT_EQ((*fit.fields[0])(Point<3>(0, 0, 0)), 2);
}

template <int Dim>
void expect_interpolation() {
  const Samples<Dim> data = sample<Dim>(random_points<Dim>(400, 1), waves<Dim>);
  const auto fit = multilevel<Dim>(data);
  EXPECT_LT(largest_error<Dim>(*fit.fields[0], data), met) << Dim;
  EXPECT_LT(fit.last().max_error, met) << Dim;
  EXPECT_EQ(fit.last().centers, 400);
  for (std::size_t level = 1; level < fit.levels.size(); ++level) {
    EXPECT_LE(fit.levels[level].smallest_support, fit.levels[level - 1].smallest_support);
    EXPECT_GT(fit.levels[level].centers, fit.levels[level - 1].centers);
  }
}

TEST(Multilevel, MeetsTheDataInAllDimensions) {
  expect_interpolation<1>();
  expect_interpolation<2>();
  expect_interpolation<3>();
  expect_interpolation<4>();
  expect_interpolation<5>();
  expect_interpolation<6>();
}

TEST(Multilevel, MeetsClusteredDataWithSeveralComponents) {
  Samples<2> data = sample<2>(random_points<2>(600, 1), franke);
  data.points.leftCols(300) = .5 + 1e-3 * data.points.leftCols(300).array();
  data.values.conservativeResize(Eigen::NoChange, 2);
  for (Index i = 0; i < 600; ++i) {
    data.values(i, 0) = franke(data.points.col(i));
    data.values(i, 1) = peaks(data.points.col(i));
  }
  const auto fit = multilevel<2>(data);
  ASSERT_EQ(fit.model().size(), 2);
  EXPECT_LT(largest_error<2>(*fit.fields[0], data, 0), met);
  EXPECT_LT(largest_error<2>(*fit.fields[1], data, 1), 10 * met);
}

TEST(Multilevel, HasTrueDerivatives) {
  const auto fit = multilevel<2>(sample<2>(unit_grid(9), franke), {.kernel = "wendland-c4"});
  expect_true_derivatives<2>(*fit.fields[0], random_points<2>(30, 3), 1e-5, 1e-5);
}

TEST(Multilevel, FollowsScalesShiftsAndTheUnitsOfTheValues) {
  const Samples<2> data = sample<2>(random_points<2>(200, 1), franke);
  const Points<2> x = random_points<2>(50, 3);
  const Eigen::VectorXd value = multilevel<2>(data).fields[0]->evaluate(x).value;
  Samples<2> moved = data;
  moved.points = (1000 * data.points).colwise() + Point<2>(300, -200);
  moved.values = 1e6 * data.values.array() + 5e6;
  const Points<2> there = (1000 * x).colwise() + Point<2>(300, -200);
  const Eigen::VectorXd found = multilevel<2>(moved).fields[0]->evaluate(there).value;
  EXPECT_LT(((found.array() - 5e6) / 1e6 - value.array()).abs().maxCoeff(), 1e-8);
}

// A support proportional to the spacing stalls, a fixed one and the multilevel scheme converge.
TEST(Multilevel, ConvergesWhereASingleNarrowSupportStalls) {
  const auto stationary = single_level_errors("wendland-c2", [](double h) { return 5 * h; });
  const auto fixed = single_level_errors("wendland-c2", [](double) { return 1.0; });
  const auto multi = multilevel_errors("wendland-c2");
  const double fixed_expected[] = {2.9e-2, 5.4e-3, 3.7e-4, 2.9e-5};
  const double multilevel_expected[] = {2.9e-2, 5.5e-3, 4.7e-4, 5.3e-5};
  for (std::size_t i = 0; i < grids.size(); ++i) {
    EXPECT_LT(fixed[i], 3 * fixed_expected[i]) << grids[i];
    EXPECT_LT(multi[i], 3 * multilevel_expected[i]) << grids[i];
  }
  EXPECT_LT(last_order(stationary), 1);
  EXPECT_GT(last_order(multi), 2.5);
  EXPECT_LT(multi.back(), stationary.back() / 20);
}

// The native space of the C2k kernel of the plane is H^(k + 3/2) (Wendland 1995): the error falls as h^(k + 3/2) at
// least.
TEST(Multilevel, ConvergesFasterWithSmootherKernelsOfFixedSupport) {
  const char* kernels[] = {"wendland-c0", "wendland-c2", "wendland-c4", "wendland-c6"};
  for (int k = 0; k < 4; ++k)
    EXPECT_GE(last_order(single_level_errors(kernels[k], [](double) { return 1.0; })), k + 1.5) << kernels[k];
}

TEST(Multilevel, StopsAtTheToleranceOrTheNumberOfCentres) {
  const Samples<2> data = sample<2>(random_points<2>(2000, 1), franke);
  const auto fit = multilevel<2>(data, {.tolerance = .01});
  EXPECT_TRUE(fit.converged);
  EXPECT_LE(largest_error<2>(*fit.fields[0], data), .01);
  EXPECT_LT(fit.last().centers, 2000);
  const auto few = multilevel<2>(data, {.centers = 200, .tolerance = 1e-9});
  EXPECT_FALSE(few.converged);
  EXPECT_EQ(few.last().centers, 200);
}

TEST(Multilevel, SmoothsNoiseByLeastSquares) {
  Samples<2> data = sample<2>(random_points<2>(3000, 1), franke);
  std::mt19937_64 random(5);
  std::normal_distribution<double> noise(0, .05);
  for (double& value : data.values.reshaped()) value += noise(random);
  const auto fit = multilevel<2>(data, {.centers = 100, .solve = LevelSolve::ridge});
  EXPECT_LT(rms_error<2>(*fit.fields[0], franke), .02);
}

TEST(Multilevel, MergesDuplicates) {
  Samples<2> data = sample<2>(random_points<2>(50, 1), franke);
  data.points.col(49) = data.points.col(0);
  data.values(0) = 1;
  data.values(49) = 3;
  const auto fit = multilevel<2>(data);
  EXPECT_EQ(fit.merged_duplicates, 1);
  EXPECT_NEAR((*fit.fields[0])(data.points.col(0)), 2, met);
}

TEST(Multilevel, ReportsProgressAndCanBeCancelled) {
  const Samples<2> data = sample<2>(random_points<2>(500, 1), franke);
  EXPECT_THROW(multilevel<2>(data, {.progress = [](std::string_view stage, double) { return stage != "levels"; }}),
               Cancelled);
}

TEST(Multilevel, RefusesBadSamplesAndOptions) {
  const Samples<2> data = sample<2>(random_points<2>(10, 1), franke);
  Samples<2> bad = data;
  bad.values(3) = std::nan("");
  EXPECT_EQ(invalid_input_message([&] { multilevel<2>(bad); }),
            "multilevel: values = NaN or infinity: every value must be finite; remove the other samples");
  EXPECT_EQ(invalid_input_message([&] {
              multilevel<2>(Samples<2>{Points<2>(2, 0), Eigen::MatrixXd(0, 1), {}});
            }),
            "multilevel: samples = none: at least one sample is needed");
  EXPECT_EQ(invalid_input_message([&] { multilevel<2>(data, {.max_levels = 0}); }),
            "multilevel: max_levels = 0: must be at least 1");
  EXPECT_EQ(invalid_input_message([&] { multilevel<2>(data, {.kernel = "gaussian"}); }),
            "LevelBuilder: kernel = gaussian: fits by levels need a compactly supported kernel; choose wendland-c2 or "
            "another one");
}

}  // namespace
}  // namespace csrbf::multilevel_test
