#include "csrbf/approx/unity/partition_of_unity.hpp"
#include "csrbf/approx/unity/partition_of_unity_field.hpp"

#include "approx/partition_testing.hpp"

namespace csrbf::partition_of_unity_definition_test {
namespace {

template <int Dim>
void expect_definition(const PartitionOfUnityOptions& options) {
  const auto fit = partition_of_unity<Dim>(sample<Dim>(random_points<Dim>(500, 1), waves<Dim>), options);
  const Points<Dim> x = random_points<Dim>(60, 2);
  const auto fields = fit.fields();
  const Eigen::VectorXd value = fields[0]->evaluate(x).value;
  for (Index i = 0; i < x.cols(); ++i) {
    const Box<Dim>& box = fit.data->cover.box();
    const Point<Dim> inside = x.col(i).cwiseMax(box.lo).cwiseMin(box.hi);
    EXPECT_NEAR(value[i], plain_value<Dim>(*fit.data, 0, inside), 1e-11) << Dim;
  }
}

TEST(PartitionOfUnity, IsTheWeightedMeanOfItsLocalFunctions) {
  expect_definition<1>({.kernel = "wendland-c2", .degree = 2, .samples_per_patch = 12});
  expect_definition<2>({.kernel = "gaussian", .degree = 3, .samples_per_patch = 30, .smoothing = 1e-3});
  expect_definition<3>({.kernel = "wendland-c4", .degree = -1, .samples_per_patch = 30});
  expect_definition<4>({.degree = 1, .samples_per_patch = 30, .centers_per_patch = 10});
  expect_definition<5>({.degree = 1, .samples_per_patch = 40});
  expect_definition<6>({.degree = 1, .samples_per_patch = 40, .centers_per_patch = 0});
  expect_definition<2>({.kernel = "powered-exponential", .degree = 0, .samples_per_patch = 12, .anisotropy = .8});
  expect_definition<3>({.degree = 1, .samples_per_patch = 30, .centers_per_patch = 10, .anisotropy = 1});
  expect_definition<2>({.degree = 2, .samples_per_patch = 30, .centers_per_patch = 0, .anisotropy = 1});
}

// Central differences of step h err by h^2 times fourth derivatives, which grow with the second ones, and by rounding.
template <int Dim>
void expect_derivatives(const PartitionOfUnityOptions& options) {
  constexpr double step = 1e-5;
  const auto fit = partition_of_unity<Dim>(sample<Dim>(random_points<Dim>(800, 1), waves<Dim>), options);
  const auto f = fit.fields()[0];
  const Points<Dim> inside = (0.1 + 0.8 * random_points<Dim>(40, 3).array()).matrix();
  for (const Points<Dim>& x : {inside, points_on_borders<Dim>(fit.data->cover, 40, 4)})
    expect_true_derivatives<Dim>(*f, x, step,
                                 1e-6 * (1 + f->evaluate(x, Derivatives::hessian).hessian.cwiseAbs().maxCoeff()));
}

TEST(PartitionOfUnity, HasTrueDerivatives) {
  expect_derivatives<1>({.kernel = "wendland-c6", .degree = 3, .samples_per_patch = 20});
  expect_derivatives<2>({.kernel = "wendland-c6", .degree = 2, .samples_per_patch = 40});
  expect_derivatives<3>({.kernel = "wendland-c6", .degree = 2, .samples_per_patch = 50});
  expect_derivatives<2>(
      {.kernel = "wendland-c6", .degree = 2, .samples_per_patch = 80, .anisotropy = 1, .smoothing = 1e-4});
  expect_derivatives<3>(
      {.kernel = "wendland-c6", .degree = 2, .samples_per_patch = 100, .anisotropy = .8, .smoothing = 1e-4});
  expect_derivatives<4>({.degree = 2, .samples_per_patch = 60, .centers_per_patch = 0});
  expect_derivatives<5>({.degree = 2, .samples_per_patch = 80, .centers_per_patch = 0});
  expect_derivatives<6>({.degree = 1, .samples_per_patch = 60, .centers_per_patch = 0});
}

TEST(PartitionOfUnity, HasDetailsOfTheSizeOfItsSmallestPatch) {
  const auto fit = partition_of_unity<2>(sample<2>(random_points<2>(500, 1), franke), {.degree = 1});
  EXPECT_EQ(fit.fields()[0]->feature_size(), fit.data->models.radius.minCoeff());
  EXPECT_LT(fit.fields()[0]->feature_size(), fit.data->models.radius.maxCoeff());
}

TEST(PartitionOfUnity, TakesOptionsAtTheEndsOfTheirRanges) {
  const PartitionOfUnityOptions plain{
      .degree = 1, .samples_per_patch = 30, .centers_per_patch = 5, .anisotropy = 0, .smoothing = 0};
  PartitionOfUnityOptions no_polynomial = plain, high = plain, one_sample = plain, no_centers = plain,
                          stretched = plain;
  no_polynomial.degree = -1;
  high.degree = 8;
  high.samples_per_patch = 100;
  one_sample.samples_per_patch = 1;
  no_centers.centers_per_patch = 0;
  stretched.anisotropy = 1;
  const Samples<2> samples = sample<2>(random_points<2>(200, 1), franke);
  for (const auto& options : {plain, no_polynomial, high, one_sample, no_centers, stretched})
    EXPECT_TRUE(partition_field<2>(samples, options)->evaluate(random_points<2>(50, 2)).value.allFinite());
}

TEST(PartitionOfUnity, TakesOneSampleOfAnyWeight) {
  const Samples<2> one{Point<2>(1, 2), Eigen::MatrixXd::Constant(1, 1, 5), Eigen::VectorXd::Constant(1, 3)};
  EXPECT_NEAR((*partition_field<2>(one))(Point<2>(0, 7)), 5, 1e-12);
}

}  // namespace
}  // namespace csrbf::partition_of_unity_definition_test
