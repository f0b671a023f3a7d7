#include "csrbf/approx/global/restricted_likelihood.hpp"

#include "approx/approx_testing.hpp"

#include <Eigen/Dense>

namespace csrbf::restricted_likelihood_test {
namespace {

using Parameters = RestrictedLikelihood::Parameters;

RestrictedLikelihood likelihood_of(const Samples<2>& data, const Replicates& replicates = {}) {
  return {{data.points, data.values, data.weights}, replicates};
}

Samples<2> noisy(Index n) {
  Samples<2> data = sample<2>(random_points<2>(n, 1), franke);
  std::mt19937_64 random(5);
  std::normal_distribution<double> error(0, .1);
  for (double& value : data.values.reshaped()) value += error(random);
  data.weights = Eigen::VectorXd::LinSpaced(n, .5, 2);
  return data;
}

const Parameters place{Point<2>(std::log(.2), std::log(.4)), std::log(.05)};

// Covariance of the values without sigma^2.
Eigen::MatrixXd covariance(const Samples<2>& data, const Kernel& kernel) {
  const Point<2> lengths = place.log_lengths.array().exp();
  Eigen::MatrixXd K(data.size(), data.size());
  for (Index i = 0; i < data.size(); ++i)
    for (Index j = 0; j < data.size(); ++j)
      K(i, j) = kernel.value((data.points.col(i) - data.points.col(j)).cwiseQuotient(lengths).norm()) +
                (i == j ? std::exp(place.log_nugget) / data.weight(i) : 0);
  return K;
}

TEST(RestrictedLikelihood, IsThatOfItsDefinition) {
  const Samples<2> data = noisy(40);
  const Kernel kernel("matern-c2", 2);
  const Eigen::MatrixXd K = covariance(data, kernel), inverse = K.inverse();
  for (const int degree : {0, 1}) {
    Eigen::MatrixXd G = Eigen::MatrixXd::Ones(40, 1 + 2 * degree);
    if (degree == 1) G.rightCols(2) = data.points.transpose();
    const Eigen::MatrixXd information = G.transpose() * inverse * G;
    const Eigen::MatrixXd P = inverse - inverse * G * information.inverse() * G.transpose() * inverse;
    const double free = static_cast<double>(40 - G.cols());
    const double sigma2 = data.values.col(0).dot(P * data.values.col(0)) / free;
    const double expected = .5 * (free * std::log(sigma2) + std::log(K.determinant()) +
                                  std::log(information.determinant() / (G.transpose() * G).determinant()));
    const RestrictedLikelihood likelihood = likelihood_of(data);
    EXPECT_NEAR(likelihood.value(kernel, degree, place), expected, 1e-8) << degree;
    const auto v = likelihood.with_derivatives(kernel, degree, place);
    EXPECT_NEAR(v.value, expected, 1e-8);
    const Eigen::ArrayXd errors = (P * data.values.col(0)).array() / P.diagonal().array();
    EXPECT_NEAR(v.leave_one_out, std::sqrt((data.weights.array() * errors.square()).sum() / data.weights.sum()), 1e-8);
  }
}

TEST(RestrictedLikelihood, HasTheDerivativesOfItsValue) {
  Samples<2> data = noisy(40);
  data.values.conservativeResize(40, 2);
  data.values.col(1) = 3 * data.points.row(0).transpose();
  const RestrictedLikelihood likelihood = likelihood_of(data, {Eigen::Vector2d(.3, .5), 20});
  const Kernel kernel("matern-c4", 2);
  const auto v = likelihood.with_derivatives(kernel, 1, place);
  constexpr double h = 1e-5;
  const auto slope = [&](const Parameters& step) {
    const auto at = [&](double t) {
      return likelihood.value(kernel, 1,
                              {place.log_lengths + t * step.log_lengths, place.log_nugget + t * step.log_nugget});
    };
    return (at(h) - at(-h)) / (2 * h);
  };
  EXPECT_NEAR(v.d_log_lengths[0], slope({Point<2>(1, 0), 0}), 1e-4);
  EXPECT_NEAR(v.d_log_lengths[1], slope({Point<2>(0, 1), 0}), 1e-4);
  EXPECT_NEAR(v.d_log_nugget, slope({Point<2>(0, 0), 1}), 1e-4);
}

// The likelihood of repeated samples is that of their means and of the differences to these.
TEST(RestrictedLikelihood, TakesReplicatesForNoise) {
  Samples<2> data = noisy(40), repeated = data;
  repeated.weights.resize(0);
  repeated.points.conservativeResize(Eigen::NoChange, 80);
  repeated.values.conservativeResize(80, Eigen::NoChange);
  repeated.points.rightCols(40) = data.points;
  for (Index i = 0; i < 40; ++i) repeated.values(40 + i, 0) = data.values(39 - i, 0) + .1;
  const Kernel kernel("matern-c2", 2);
  MergedSamples<2> merged = merge_duplicates(repeated);
  ASSERT_EQ(merged.replicates.count, 40);
  const RestrictedLikelihood of_means = likelihood_of(merged.samples, merged.replicates);
  const RestrictedLikelihood of_all = likelihood_of(repeated);
  Parameters other = place;
  other.log_nugget = std::log(.8);
  EXPECT_NEAR(of_means.value(kernel, 0, other) - of_means.value(kernel, 0, place),
              of_all.value(kernel, 0, other) - of_all.value(kernel, 0, place), 1e-7);
}

TEST(RestrictedLikelihood, HasNoLinearTrendOnALine) {
  Samples<2> data = noisy(40);
  EXPECT_EQ(likelihood_of(data).largest_degree(), 1);
  data.points.row(1) = 2 * data.points.row(0);
  EXPECT_EQ(likelihood_of(data).largest_degree(), 0);
}

}  // namespace
}  // namespace csrbf::restricted_likelihood_test
