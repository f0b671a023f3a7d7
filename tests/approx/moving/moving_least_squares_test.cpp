#include "csrbf/approx/moving/moving_least_squares.hpp"

#include "approx/approx_testing.hpp"

namespace csrbf::moving_least_squares_test {
namespace {

constexpr double rounding = 1e-10;  // local fits of condition up to about 1e5

// (1 + x_0 + 2 x_1 + ...)^degree.
template <int Dim>
double power(const Point<Dim>& p, int degree) {
  double sum = 1;
  for (int axis = 0; axis < Dim; ++axis) sum += (axis + 1) * p[axis];
  return std::pow(sum, degree);
}

template <int Dim>
void expect_reproduction(int most) {
  const Points<Dim> x = random_points<Dim>(40, 3);
  for (int degree = 0; degree <= most; ++degree) {
    const auto function = [&](const Point<Dim>& p) { return power<Dim>(p, degree); };
    const auto f = moving_least_squares<Dim>(sample<Dim>(random_points<Dim>(500, 1), function), {.degree = degree})[0];
    const Eigen::VectorXd value = f->evaluate(x).value;
    for (Index i = 0; i < x.cols(); ++i)
      EXPECT_NEAR(value[i], function(x.col(i)), rounding * std::pow(22, degree)) << Dim << " " << degree;
  }
}

TEST(MovingLeastSquares, ReproducesPolynomialsOfItsDegree) {
  expect_reproduction<1>(4);
  expect_reproduction<2>(4);
  expect_reproduction<3>(3);
  expect_reproduction<4>(2);
  expect_reproduction<5>(2);
  expect_reproduction<6>(1);
}

TEST(MovingLeastSquares, IsShepardsMethodForDegreeZero) {
  const Samples<2> data = sample<2>(random_points<2>(300, 1), franke);
  const auto f = moving_least_squares<2>(data, {.degree = 0})[0];
  const Points<2> x = random_points<2>(100, 3);
  const Eigen::VectorXd value = f->evaluate(x).value;
  EXPECT_LE(value.maxCoeff(), data.values.maxCoeff());
  EXPECT_GE(value.minCoeff(), data.values.minCoeff());
}

TEST(MovingLeastSquares, HasTrueDerivatives) {
  const Samples<2> plane = sample<2>(random_points<2>(400, 1), franke);
  for (int degree = 0; degree <= 3; ++degree)
    expect_true_derivatives<2>(*moving_least_squares<2>(plane, {.degree = degree})[0], random_points<2>(30, 3), 1e-6,
                               2e-4);
  const Samples<3> space = sample<3>(random_points<3>(600, 1), waves<3>);
  expect_true_derivatives<3>(*moving_least_squares<3>(space, {.degree = 2})[0], random_points<3>(20, 3), 1e-6, 1e-4);
}

// Degree m on a quasi-uniform set: order m + 1.
TEST(MovingLeastSquares, ConvergesWithItsOrder) {
  for (int degree = 1; degree <= 3; ++degree) {
    double before = 0;
    double order = 0;
    for (const Index n : {17, 33, 65}) {
      const auto f = moving_least_squares<2>(sample<2>(unit_grid(n), franke), {.degree = degree})[0];
      const double error = rms_error<2>(*f, franke);
      order = std::log2(before / error);
      before = error;
    }
    EXPECT_GE(order, degree + 1 - .3) << degree;
  }
}

TEST(MovingLeastSquares, LowersTheDegreeWhereSamplesDoNotDetermineIt) {
  Points<2> line(2, 50);
  line.row(0) = random_points<1>(50, 1);
  line.row(1).setConstant(.5);
  const auto f = moving_least_squares<2>(sample<2>(line, [](const Point<2>& p) { return 4 * p[0]; }))[0];
  EXPECT_TRUE(std::isfinite((*f)(Point<2>(.4, .5))));
  EXPECT_NEAR((*f)(Point<2>(.4, .5)), 1.6, .2);
}

TEST(MovingLeastSquares, IsTheNearestValueFarAway) {
  Samples<1> data{Points<1>(1, 3), Eigen::Vector3d(5, 6, 7), {}};
  data.points << 0, 1, 2;
  const auto f = moving_least_squares<1>(data)[0];
  EXPECT_EQ((*f)(Point<1>(1000)), 7);
  EXPECT_EQ(f->evaluate(Point<1>(-1000), Derivatives::gradient).gradient(0), 0);
}

TEST(MovingLeastSquares, IgnoresSamplesOfWeightZeroAndMergesDuplicates) {
  Samples<2> data = sample<2>(random_points<2>(200, 1), [](const Point<2>& p) { return p[0]; });
  data.weights = Eigen::VectorXd::Ones(200);
  data.weights[7] = 0;
  data.values(7) = 1e9;
  data.points.col(8) = data.points.col(9);
  data.values(8) = data.values(9);
  const auto f = moving_least_squares<2>(data)[0];
  EXPECT_NEAR((*f)(data.points.col(7)), data.points(0, 7), rounding);
}

TEST(MovingLeastSquares, RefusesBadOptions) {
  const Samples<2> data = sample<2>(random_points<2>(10, 1), franke);
  EXPECT_THROW(moving_least_squares<2>(data, {.degree = -1}), InvalidInput);
  EXPECT_THROW(moving_least_squares<2>(data, {.degree = 6}), InvalidInput);
  EXPECT_THROW(moving_least_squares<2>(data, {.support = 0}), InvalidInput);
  EXPECT_THROW(moving_least_squares<2>(data, {.neighbors = -1}), InvalidInput);
  EXPECT_THROW(moving_least_squares<2>(data, {.kernel = "gaussian"}), InvalidInput);
  EXPECT_THROW(moving_least_squares<2>(data, {.kernel = "wendland-c0"}), InvalidInput);
}

}  // namespace
}  // namespace csrbf::moving_least_squares_test
