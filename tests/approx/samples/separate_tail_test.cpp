#include "csrbf/approx/samples/separate_tail.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace csrbf {
namespace {

std::mt19937_64 generator(unsigned seed) {
  return std::mt19937_64(1000 + seed);
}

TEST(SeparateTail, TailsOfOneDistributionAreNotSeparate) {
  for (const Index n : {150, 500, 2000})
    for (unsigned seed = 0; seed < 20; ++seed) {
      std::mt19937_64 random = generator(seed);
      std::normal_distribution<double> normal;
      const auto all_of = [&](const auto& draw) {
        Eigen::VectorXd sizes(n);
        for (double& size : sizes) size = std::abs(draw());
        return sizes;
      };
      EXPECT_FALSE(separate_tail(all_of([&] { return normal(random); })));
      std::exponential_distribution<double> laplace;
      EXPECT_FALSE(separate_tail(all_of([&] { return laplace(random); })));
      for (const double degrees : {1, 2, 3, 4}) {
        std::student_t_distribution<double> student(degrees);
        EXPECT_FALSE(separate_tail(all_of([&] { return student(random); }))) << degrees;
      }
      std::lognormal_distribution<double> lognormal(0, 1.5);
      EXPECT_FALSE(separate_tail(all_of([&] { return lognormal(random); })));
      EXPECT_FALSE(separate_tail(all_of([&] { return normal(random) * std::exp(normal(random)); })));
    }
}

TEST(SeparateTail, GrossErrorsAre) {
  constexpr Index n = 1000;
  for (const double share : {.01, .05, .1})
    for (unsigned seed = 0; seed < 10; ++seed) {
      std::mt19937_64 random = generator(seed);
      std::normal_distribution<double> normal;
      std::uniform_real_distribution<double> uniform;
      Eigen::VectorXd sizes(n);
      Index errors = 0;
      for (double& size : sizes) {
        const bool is_error = uniform(random) < share;
        errors += is_error ? 1 : 0;
        size = std::abs(normal(random)) + (is_error ? 20 + 30 * uniform(random) : 0);
      }
      const auto cut = separate_tail(sizes);
      ASSERT_TRUE(cut) << share << " " << seed;
      EXPECT_EQ((sizes.array() > *cut).count(), errors);
    }
}

TEST(SeparateTail, TakesAnySizes) {
  EXPECT_FALSE(separate_tail(Eigen::VectorXd(0)));
  EXPECT_FALSE(separate_tail(Eigen::VectorXd::Zero(100)));
  EXPECT_FALSE(separate_tail(Eigen::VectorXd::Ones(100)));
  EXPECT_FALSE(separate_tail(Eigen::Vector2d(0, 1e9)));
}

}  // namespace
}  // namespace csrbf
