#include "csrbf/approx/samples/blended_field.hpp"

#include "approx/approx_testing.hpp"
#include "csrbf/approx/moving/moving_least_squares.hpp"

namespace csrbf::blended_field_test {
namespace {

std::shared_ptr<const Field<2>> smooth(unsigned seed) {
  return moving_least_squares<2>(sample<2>(random_points<2>(300, seed), franke), {.degree = 2})[0];
}

// 0 for x < .4, 1 for x > .6.
std::shared_ptr<const Field<2>> ramp() {
  Samples<2> data = sample<2>(random_points<2>(2000, 9), franke);
  for (Index i = 0; i < data.size(); ++i) data.values(i, 0) = std::clamp((data.points(0, i) - .4) / .2, 0.0, 1.0);
  return moving_least_squares<2>(data, {.degree = 0})[0];
}

TEST(BlendedField, HasTrueDerivatives) {
  const auto one = smooth(1), other = smooth(2), share = ramp();
  expect_true_derivatives<2>(BlendedField<2>(one, other, share), random_points<2>(60, 3), 1e-5, 1e-2);
  expect_true_derivatives<2>(BlendedField<2>(one, nullptr, share), random_points<2>(60, 3), 1e-5, 1e-2);
}

TEST(BlendedField, IsOneFieldWhereTheShareIsOneAndTheOtherWhereItIsZero) {
  const auto one = smooth(1), other = smooth(2), share = ramp();
  Points<2> x(2, 2);
  x << .1, .9, .5, .5;
  const Eigen::VectorXd f = BlendedField<2>(one, other, share).evaluate(x).value;
  EXPECT_EQ(f[0], other->evaluate(x).value[0]);
  EXPECT_NEAR(f[1], one->evaluate(x).value[1], 1e-12);
  EXPECT_EQ(BlendedField<2>(one, nullptr, share).evaluate(x).value[0], 0);
}

}  // namespace
}  // namespace csrbf::blended_field_test
