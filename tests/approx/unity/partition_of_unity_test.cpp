#include "csrbf/approx/unity/partition_of_unity.hpp"
#include "csrbf/approx/unity/partition_of_unity_field.hpp"

#include "approx/partition_testing.hpp"
#include "csrbf/core/parallel.hpp"

#include <Eigen/Geometry>

#include <numbers>

namespace csrbf::partition_of_unity_test {
namespace {

constexpr double rounding = 1e-13;      // of values of size 1, summed with positive weights
constexpr double local_systems = 1e-9;  // of values of size 1, through local systems of condition up to 1e6

template <int Dim>
void expect_constant(double constant) {
  const Samples<Dim> data = sample<Dim>(random_points<Dim>(400, 1), [&](const Point<Dim>&) { return constant; });
  const auto f = partition_field<Dim>(data, {.degree = 1, .samples_per_patch = 40});
  const Jet<Dim> jet = f->evaluate(random_points<Dim>(200, 2), Derivatives::gradient);
  EXPECT_LE((jet.value.array() - constant).abs().maxCoeff(), rounding * constant) << Dim;
  EXPECT_LE(jet.gradient.cwiseAbs().maxCoeff(), 100 * rounding * constant) << Dim;  // over the size of a patch
}

TEST(PartitionOfUnity, IsConstantForConstantValues) {
  expect_constant<1>(7);
  expect_constant<2>(7);
  expect_constant<3>(7);
  expect_constant<4>(7);
  expect_constant<5>(7);
  expect_constant<6>(7);
  expect_constant<3>(1e30);
}

TEST(PartitionOfUnity, IsConstantForConstantValuesWithoutOptions) {
  for (const double constant : {0.0, 7.0, -1e-30}) {
    const Samples<2> data = sample<2>(random_points<2>(3000, 1), [&](const Point<2>&) { return constant; });
    const auto f = partition_field<2>(data);
    EXPECT_LE((f->evaluate(random_points<2>(500, 2)).value.array() - constant).abs().maxCoeff(),
              local_systems * std::abs(constant));
  }
}

// (1 + x_0 + 2 x_1 + ...)^degree, over its largest value.
template <int Dim>
double power(const Point<Dim>& p, int degree) {
  double sum = 1;
  double most = 1;
  for (int a = 0; a < Dim; ++a) {
    sum += (a + 1) * p[a];
    most += a + 1;
  }
  return std::pow(sum / most, degree);
}

template <int Dim>
void expect_reproduction(int most) {
  for (int degree = 0; degree <= most; ++degree) {
    const auto function = [&](const Point<Dim>& p) { return power<Dim>(p, degree); };
    const Samples<Dim> data = sample<Dim>(random_points<Dim>(600, 1), function);
    for (const Index centers : {0, 1000}) {
      const Index wanted = std::max<Index>(12, 4 * Polynomials<Dim>::size(degree));
      const auto f =
          partition_field<Dim>(data, {.degree = degree, .samples_per_patch = wanted, .centers_per_patch = centers});
      const Points<Dim> inside = (0.1 + 0.8 * random_points<Dim>(300, 2).array()).matrix();
      EXPECT_LE(largest_error<Dim>(*f, sample<Dim>(inside, function)), local_systems)
          << Dim << " " << degree << " " << centers;
    }
  }
}

TEST(PartitionOfUnity, ReproducesPolynomialsOfItsDegree) {
  expect_reproduction<1>(6);
  expect_reproduction<2>(4);
  expect_reproduction<3>(3);
  expect_reproduction<4>(2);
  expect_reproduction<5>(1);
  expect_reproduction<6>(1);
}

TEST(PartitionOfUnity, IsConstantForOneSample) {
  Samples<3> one{Point<3>(1, 2, 3), Eigen::MatrixXd::Constant(1, 1, 5), {}};
  const auto f = partition_field<3>(one);
  EXPECT_NEAR((*f)(Point<3>(1, 2, 3)), 5, rounding * 10);
  EXPECT_NEAR((*f)(Point<3>(-100, 7, 1e9)), 5, rounding * 10);
}

TEST(PartitionOfUnity, MeetsTwoSamples) {
  Samples<2> two{Points<2>(2, 2), Eigen::Vector2d(5, 6), {}};
  two.points << 0, 1, 0, 3;
  const auto f = partition_field<2>(two);
  EXPECT_NEAR((*f)(two.points.col(0)), 5, local_systems);
  EXPECT_NEAR((*f)(two.points.col(1)), 6, local_systems);
}

template <int Dim>
void expect_lines() {
  const Point<Dim> direction = Point<Dim>::LinSpaced(1, 2);
  Points<Dim> line = direction * random_points<1>(500, 1);
  const auto along = [&](const Point<Dim>& p) { return std::sin(4 * p.dot(direction)); };
  const auto f = partition_field<Dim>(sample<Dim>(line, along));
  const Points<Dim> between = direction * (.02 + .96 * random_points<1>(500, 2).array()).matrix();
  EXPECT_LE(largest_error<Dim>(*f, sample<Dim>(between, along)), 1e-5) << Dim;
  EXPECT_TRUE(f->evaluate(random_points<Dim>(500, 3)).value.allFinite());
}

TEST(PartitionOfUnity, TakesSamplesOnALine) {
  expect_lines<2>();
  expect_lines<3>();
}

TEST(PartitionOfUnity, TakesSamplesOnAPlane) {
  Eigen::Matrix<double, 3, 2> plane;
  plane << 1, .2, -.3, 1, .5, .7;
  const auto f = partition_field<3>(sample<3>(plane * random_points<2>(2000, 1), waves<3>));
  const Points<3> between = plane * (.05 + .9 * random_points<2>(500, 2).array()).matrix();
  EXPECT_LE(largest_error<3>(*f, sample<3>(between, waves<3>)), 1e-4);
}

template <int Dim>
void expect_continuity() {
  constexpr double gap = 1e-9;
  const auto fit = partition_of_unity<Dim>(sample<Dim>(random_points<Dim>(1000, 1), waves<Dim>), {.degree = 2});
  const auto f = fit.fields()[0];
  const Points<Dim> border = points_on_borders<Dim>(fit.data->cover, 100, 4);
  for (int a = 0; a < Dim; ++a) {
    const Points<Dim> below = border.colwise() - gap * Point<Dim>::Unit(a);
    const Points<Dim> above = border.colwise() + gap * Point<Dim>::Unit(a);
    const Jet<Dim> left = f->evaluate(below, Derivatives::hessian);
    const Jet<Dim> right = f->evaluate(above, Derivatives::hessian);
    EXPECT_LE((left.value - right.value).cwiseAbs().maxCoeff(), 1e-7);
    EXPECT_LE((left.gradient - right.gradient).cwiseAbs().maxCoeff(), 1e-6);
    EXPECT_LE((left.hessian - right.hessian).cwiseAbs().maxCoeff(), 1e-5);  // times derivatives of up to 1e3
  }
}

TEST(PartitionOfUnity, HasContinuousSecondDerivativesAcrossCells) {
  expect_continuity<1>();
  expect_continuity<2>();
  expect_continuity<3>();
}

TEST(PartitionOfUnity, ContinuesWithTheValueAtTheNearestPointOfTheBox) {
  const auto fit = partition_of_unity<2>(sample<2>(random_points<2>(1000, 1), franke));
  const auto f = fit.fields()[0];
  const Box<2> box = f->bounds();
  Points<2> outside(2, 6);
  outside << -3, .5, 9, 1e200, -1e-6, .25, .5, 7, -4, .5, .75, -1e-6;
  Points<2> nearest = outside.cwiseMax(box.lo.replicate(1, 6)).cwiseMin(box.hi.replicate(1, 6));
  const Jet<2> jet = f->evaluate(outside, Derivatives::hessian);
  const Jet<2> edge = f->evaluate(nearest, Derivatives::hessian);
  EXPECT_EQ(jet.value, edge.value);
  for (Index i = 0; i < outside.cols(); ++i)
    for (int a = 0; a < 2; ++a) {
      const bool moved = outside(a, i) != nearest(a, i);
      EXPECT_EQ(jet.gradient(a, i), moved ? 0 : edge.gradient(a, i));
      EXPECT_EQ(jet.hessian_matrix(i)(a, a), moved ? 0 : edge.hessian_matrix(i)(a, a));
    }
  EXPECT_NE(jet.gradient.cwiseAbs().maxCoeff(), 0);
}

TEST(PartitionOfUnity, IsUndefinedAtUndefinedPoints) {
  const auto f = partition_field<2>(sample<2>(random_points<2>(2000, 1), franke));
  Points<2> x = random_points<2>(1000, 2);
  const Eigen::VectorXd expected = f->evaluate(x).value;
  x(0, 10) = std::numeric_limits<double>::quiet_NaN();
  x(1, 20) = std::numeric_limits<double>::infinity();
  const Eigen::VectorXd value = f->evaluate(x).value;
  for (Index i = 0; i < x.cols(); ++i)
    if (i == 10 || i == 20) {
      EXPECT_TRUE(std::isnan(value[i]));
    } else {
      EXPECT_EQ(value[i], expected[i]);
    }
}

// The same numbers whatever else is evaluated with a point, and in whatever order. With derivatives, kernels are
// evaluated by other formulas.
TEST(PartitionOfUnity, DoesNotDependOnTheCompanyOfAPoint) {
  const auto f = partition_field<3>(sample<3>(random_points<3>(2000, 1), waves<3>));
  const Points<3> x = random_points<3>(3000, 2);
  EXPECT_EQ(f->evaluation_order(x).size(), 3000U);
  const Jet<3> together = f->evaluate(x, Derivatives::hessian);
  const Eigen::VectorXd values = f->evaluate(x).value;
  EXPECT_LE((values - together.value).cwiseAbs().maxCoeff(), local_systems);
  for (Index i = 0; i < x.cols(); i += 100) {
    const Jet<3> alone = f->evaluate(x.col(i), Derivatives::hessian);
    EXPECT_EQ(alone.value[0], together.value[i]);
    EXPECT_EQ(alone.gradient.col(0), together.gradient.col(i));
    EXPECT_EQ(alone.hessian.col(0), together.hessian.col(i));
    EXPECT_EQ((*f)(x.col(i)), values[i]);
  }
}

TEST(PartitionOfUnity, DoesNotDependOnTheNumberOfThreads) {
  const Samples<2> data = sample<2>(random_points<2>(5000, 1), franke);
  const Points<2> x = random_points<2>(3000, 2);
  set_thread_count(1);
  const Eigen::VectorXd one = partition_field<2>(data)->evaluate(x).value;
  set_thread_count(2);
  const Eigen::VectorXd two = partition_field<2>(data)->evaluate(x).value;
  set_thread_count(0);
  EXPECT_EQ(one, two);
}

// Multiplying by powers of two is exact, so nothing at all may change.
TEST(PartitionOfUnity, DoesNotDependOnTheUnitsOfPointsAndValues) {
  const Samples<3> data = sample<3>(random_points<3>(2000, 1), waves<3>);
  const auto f = partition_field<3>(data);
  const Points<3> x = random_points<3>(500, 2);
  const Eigen::VectorXd value = f->evaluate(x).value;
  const PartitionOfUnityOptions stretched{.degree = 1, .samples_per_patch = 20, .anisotropy = .8};
  const Eigen::VectorXd stretched_value = partition_field<3>(data, stretched)->evaluate(x).value;
  for (const int exponent : {-100, 100}) {
    Samples<3> scaled = data;
    scaled.points *= std::ldexp(1, exponent);
    EXPECT_EQ(partition_field<3>(scaled, stretched)->evaluate(std::ldexp(1, exponent) * x).value, stretched_value);
    EXPECT_EQ(partition_field<3>(scaled)->evaluate(std::ldexp(1, exponent) * x).value, value) << exponent;
  }
  for (const int exponent : {-664, 664}) {  // about 1e-200 and 1e200
    Samples<3> scaled = data;
    scaled.values *= std::ldexp(1, exponent);
    EXPECT_EQ(partition_field<3>(scaled)->evaluate(x).value, std::ldexp(1, exponent) * value) << exponent;
  }
}

TEST(PartitionOfUnity, DoesNotDependOnTheUnitOfWeights) {
  Samples<2> data = sample<2>(random_points<2>(2000, 1), franke);
  data.weights = (0.5 + random_points<1>(2000, 5).transpose().array()).matrix();
  const PartitionOfUnityOptions options{.degree = 2, .smoothing = 0.1};
  const Points<2> x = random_points<2>(500, 2);
  const Eigen::VectorXd value = partition_field<2>(data, options)->evaluate(x).value;
  for (const double factor : {1e-300, 1e-10, 1e300}) {
    Samples<2> scaled = data;
    scaled.weights *= factor;
    EXPECT_LE((partition_field<2>(scaled, options)->evaluate(x).value - value).cwiseAbs().maxCoeff(), local_systems);
  }
}

// Cells move by rounding only: their samples are the same but for ties.
TEST(PartitionOfUnity, MovesWithItsPoints) {
  Points<2> points = random_points<2>(2000, 1);
  points = (points * 0x1p30).array().round() * 0x1p-30;  // so that moving them is exact
  const Samples<2> data = sample<2>(points, franke);
  Samples<2> moved = data;
  const Point<2> shift(64, -4096);
  moved.points.colwise() += shift;
  const Points<2> x = random_points<2>(500, 2);
  const Points<2> y = x.colwise() + shift;
  EXPECT_LE((partition_field<2>(moved)->evaluate(y).value - partition_field<2>(data)->evaluate(x).value)
                .cwiseAbs()
                .maxCoeff(),
            1e-6);
}

// Cells are aligned with the axes, so a rotation changes them, and the field by its error.
TEST(PartitionOfUnity, TurnsWithItsPointsButForItsError) {
  const Eigen::Matrix2d turn = Eigen::Rotation2Dd(std::numbers::pi / 5).toRotationMatrix();
  const Samples<2> data = sample<2>(random_points<2>(4000, 1), franke);
  Samples<2> turned = data;
  turned.points = turn * data.points;
  const Points<2> x = (0.1 + 0.8 * random_points<2>(500, 2).array()).matrix();
  const Points<2> y = turn * x;
  const Eigen::VectorXd a = partition_field<2>(data)->evaluate(x).value;
  const Eigen::VectorXd b = partition_field<2>(turned)->evaluate(y).value;
  const double error = largest_error<2>(*partition_field<2>(data), sample<2>(x, franke));
  EXPECT_LE((a - b).cwiseAbs().maxCoeff(), 20 * error);
}

TEST(PartitionOfUnity, FitsComponentsAsIfTheyWereAlone) {
  Samples<2> both = sample<2>(random_points<2>(1000, 1), franke);
  const Samples<2> second = sample<2>(both.points, waves<2>);
  const Samples<2> first = both;
  both.values.conservativeResize(Eigen::NoChange, 2);
  both.values.col(1) = second.values;
  const PartitionOfUnityOptions options{.kernel = "wendland-c4", .degree = 2, .samples_per_patch = 30};
  const auto fields = partition_of_unity<2>(both, options).fields();
  ASSERT_EQ(fields.size(), 2U);
  const Points<2> x = random_points<2>(300, 2);
  EXPECT_EQ(fields[0]->evaluate(x).value, partition_field<2>(first, options)->evaluate(x).value);
  EXPECT_EQ(fields[1]->evaluate(x).value, partition_field<2>(second, options)->evaluate(x).value);
}

TEST(PartitionOfUnity, IgnoresSamplesOfWeightZero) {
  Samples<2> data = sample<2>(random_points<2>(1000, 1), franke);
  data.weights = Eigen::VectorXd::Ones(1000);
  for (const Index i : {3, 77, 500}) {
    data.weights[i] = 0;
    data.values(i) = 1e6;
  }
  EXPECT_LE(rms_error<2>(*partition_field<2>(data), franke), 1e-3);
  EXPECT_LE(rms_error<2>(*partition_field<2>(data, {.degree = 2, .smoothing = 1e-6}), franke), 1e-3);
  EXPECT_LE(rms_error<2>(*partition_field<2>(data, {.degree = 3, .centers_per_patch = 0}), franke), 1e-2);
}

TEST(PartitionOfUnity, ReportsWhatItDid) {
  const auto fit = partition_of_unity<2>(
      sample<2>(random_points<2>(1000, 1), franke),
      {.kernel = "wendland-c2", .degree = 1, .samples_per_patch = 25, .centers_per_patch = 9, .smoothing = 0.5});
  EXPECT_EQ(fit.report.local.kernel, "wendland-c2");
  EXPECT_EQ(fit.report.local.degree, 1);
  EXPECT_EQ(fit.report.local.samples, 25);
  EXPECT_EQ(fit.report.local.centers, 9);
  EXPECT_EQ(fit.report.local.smoothing, 0.5);
  EXPECT_EQ(fit.report.patches, fit.data->cover.size());
  EXPECT_EQ(fit.report.centers, 9 * fit.report.patches);
  EXPECT_GT(fit.report.cross_validation_rmse, 0);
}

TEST(PartitionOfUnity, RefusesInvalidSamples) {
  const Samples<2> good = sample<2>(random_points<2>(50, 1), franke);
  const auto refused = [](const Samples<2>& data, const std::string& part) {
    expect_refusal([&] { partition_of_unity<2>(data); }, "partition_of_unity: " + part);
  };
  refused({Points<2>(2, 0), Eigen::MatrixXd(0, 1), {}}, "samples = none");
  Samples<2> bad = good;
  bad.values(3) = std::numeric_limits<double>::quiet_NaN();
  refused(bad, "values = NaN or infinity");
  bad = good;
  bad.points(1, 3) = std::numeric_limits<double>::infinity();
  refused(bad, "points = NaN or infinity");
  bad = good;
  bad.weights = Eigen::VectorXd::Constant(50, -1);
  refused(bad, "weights = negative or not finite");
  bad.weights.setZero();
  refused(bad, "weights = all zero");
}

TEST(PartitionOfUnity, RefusesInvalidOptions) {
  const Samples<2> data = sample<2>(random_points<2>(50, 1), franke);
  const auto refused = [&](const PartitionOfUnityOptions& options, const std::string& part) {
    expect_refusal([&] { partition_of_unity<2>(data, options); }, part);
  };
  refused({.kernel = "wendland-c9"}, "wendland-c2");
  refused({.kernel = "thin-plate"}, "partition_of_unity: kernel = thin-plate: is only conditionally");
  refused({.degree = -2}, "partition_of_unity: degree = -2");
  refused({.degree = 9}, "partition_of_unity: degree = 9");
  refused({.samples_per_patch = 0}, "partition_of_unity: samples_per_patch = 0");
  refused({.centers_per_patch = -1}, "partition_of_unity: centers_per_patch = -1");
  refused({.anisotropy = 1.1}, "partition_of_unity: anisotropy = 1.1");
  refused({.anisotropy = std::numeric_limits<double>::quiet_NaN()}, "partition_of_unity: anisotropy = nan");
  refused({.smoothing = -1}, "partition_of_unity: smoothing = -1");
  refused({.smoothing = std::numeric_limits<double>::quiet_NaN()}, "partition_of_unity: smoothing = nan");
}

TEST(PartitionOfUnity, CanBeCancelled) {
  const Samples<2> data = sample<2>(random_points<2>(5000, 1), franke);
  std::vector<double> fractions;
  const auto listen = [&](std::string_view, double fraction) { return fractions.push_back(fraction), true; };
  (void)partition_of_unity<2>(data, {.progress = listen});
  EXPECT_TRUE(std::is_sorted(fractions.begin(), fractions.end()));
  EXPECT_EQ(fractions.front(), 0);
  EXPECT_EQ(fractions.back(), 1);
  const auto stop = [](std::string_view, double fraction) { return fraction < .5; };
  EXPECT_THROW(partition_of_unity<2>(data, {.progress = stop}), Cancelled);
}

}  // namespace
}  // namespace csrbf::partition_of_unity_test
