#include "csrbf/kernels/kernel.hpp"

#include "csrbf/core/error.hpp"
#include "kernels/kernel_testing.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

namespace csrbf::kernel_test {
namespace {

constexpr double rounding = 2e-14;  // some tens of roundings of numbers of order 1

TEST(Kernel, NamesOfOtherProgramsAreUnderstood) {
  const std::pair<const char*, const char*> names[] = {{"thin_plate_spline", "thin-plate"},
                                                       {"thin-plate-spline", "thin-plate"},
                                                       {"inverse_multiquadric", "inverse-multiquadric"},
                                                       {"inverse_quadratic", "inverse-quadratic"},
                                                       {"squared-exponential", "gaussian"},
                                                       {"exponential", "matern-c0"},
                                                       {"matern32", "matern-c2"},
                                                       {"quintic", "quintic"}};
  for (const auto& [theirs, ours] : names) {
    EXPECT_EQ(Kernel(theirs, 2).name(), ours);
    EXPECT_EQ(Kernel(theirs, 2).value(0.7), Kernel(ours, 2).value(0.7));
  }
}

TEST(Kernel, HasTheClosedFormsOfTheLiterature) {
  const auto expect = [](const Kernel& kernel, auto phi) {
    for (const double r : {.01, .25, .5, .75, .9375, 1.0})
      EXPECT_NEAR(kernel.value(r), phi(r), rounding) << kernel.name() << " " << r;
  };
  const auto pow = [](double x, double n) { return std::pow(x, n); };
  expect(Kernel("wu-c0", 3), [&](double r) { return pow(1 - r, 2) * (2 + r) / 2; });
  expect(Kernel("wu-c0", 5), [&](double r) { return pow(1 - r, 3) * (3 * r * r + 9 * r + 8) / 8; });
  expect(Kernel("wu-c0", 7), [&](double r) { return pow(1 - r, 4) * (5 * r * r * r + 20 * r * r + 29 * r + 16) / 16; });
  expect(Kernel("wu-c2", 3), [&](double r) { return pow(1 - r, 4) * (3 * r * r * r + 12 * r * r + 16 * r + 4) / 4; });
  expect(Kernel("wu-c2", 4),
         [&](double r) { return pow(1 - r, 5) * (5 * pow(r, 4) + 25 * pow(r, 3) + 48 * r * r + 40 * r + 8) / 8; });
  expect(Kernel("wu-c4", 2), [&](double r) {
    return pow(1 - r, 6) * (5 * pow(r, 5) + 30 * pow(r, 4) + 72 * pow(r, 3) + 82 * r * r + 36 * r + 6) / 6;
  });
  expect(Kernel("wu-c6", 1), [&](double r) {
    return pow(1 - r, 7) *
           (5 * pow(r, 6) + 35 * pow(r, 5) + 101 * pow(r, 4) + 147 * pow(r, 3) + 101 * r * r + 35 * r + 5) / 5;
  });
  expect(Kernel("buhmann-c1", 6),
         [&](double r) { return 1 + 12 * r * r * std::log(r) + 12 * r * r - 16 * r * r * r + 3 * pow(r, 4); });
  expect(Kernel("buhmann-c2", 3),
         [&](double r) { return 1 - 12 * r * r + 32 * r * r * r - 21 * pow(r, 4) + 12 * pow(r, 4) * std::log(r); });
  expect(Kernel("buhmann-c3", 3),
         [&](double r) { return 1 - 8.4 * r * r + 48 * pow(r, 3.5) - 63 * pow(r, 4) + 22.4 * pow(r, 4.5); });
  expect(Kernel("missing-wendland", 2), [&](double r) {
    const double e = std::sqrt(1 - r * r);
    return (2 * r * r + 1) * e + 3 * r * r * std::log(r / (1 + e));
  });
}

TEST(Kernel, HasTheClosedFormsOfTheGlobalKernels) {
  for (const double r : {1e-3, .1, .7, 1.0, 3.0, 20.0}) {
    const auto expect = [r](const Kernel& kernel, double phi) {
      EXPECT_NEAR(kernel.value(r) / phi, 1, rounding) << kernel.name() << " " << r;
    };
    expect(Kernel("gaussian", 2), std::exp(-r * r));
    expect(Kernel("powered-exponential", 2, 1), std::exp(-r));
    expect(Kernel("powered-exponential", 2, 2), std::exp(-r * r));
    expect(Kernel("matern-c0", 2), std::exp(-r));
    expect(Kernel("matern-c2", 2), (1 + r) * std::exp(-r));
    expect(Kernel("matern-c4", 2), (3 + 3 * r + r * r) * std::exp(-r) / 3);
    expect(Kernel("matern-c6", 2), (15 + 15 * r + 6 * r * r + r * r * r) * std::exp(-r) / 15);
    expect(Kernel("inverse-multiquadric", 2), 1 / std::sqrt(1 + r * r));
    expect(Kernel("inverse-multiquadric", 2, 2), 1 / std::pow(1 + r * r, 2));
    expect(Kernel("inverse-quadratic", 2), 1 / (1 + r * r));
    expect(Kernel("multiquadric", 2), -std::sqrt(1 + r * r));
    expect(Kernel("multiquadric", 2, 1.5), std::pow(1 + r * r, 1.5));
    expect(Kernel("linear", 2), -r);
    expect(Kernel("cubic", 2), r * r * r);
    expect(Kernel("quintic", 2), -std::pow(r, 5));
    expect(Kernel("septic", 2), std::pow(r, 7));
    expect(Kernel("polyharmonic", 2, 2.5), std::pow(r, 2.5));
    if (r == 1) continue;
    expect(Kernel("thin-plate", 2), r * r * std::log(r));
    expect(Kernel("thin-plate-r4", 2), -std::pow(r, 4) * std::log(r));
    expect(Kernel("polyharmonic", 2, 6), std::pow(r, 6) * std::log(r));
  }
}

// The rounding of the exponent counts as often as it is large.
TEST(Kernel, HasTheClosedFormOfThePoweredExponential) {
  for (const double b : {.3, .7, 1.4, 1.9})
    for (const double r : {1e-3, .1, .7, 1.0, 3.0, 20.0}) {
      const double power = std::pow(r, b);
      EXPECT_NEAR(Kernel("powered-exponential", 2, b).value(r) / std::exp(-power), 1, rounding * (1 + power)) << r;
    }
  EXPECT_EQ(Kernel("powered-exponential", 2).parameter(), 1.4);
  EXPECT_EQ(Kernel("matern", 2).parameter(), 1.5);
  EXPECT_EQ(Kernel("thin-plate", 2).smoothness(), 1);  // r^2 log r
}

TEST(Kernel, OfMaternByBesselFunctionsAgreesWithTheClosedForms) {
  constexpr double bessel = 1e-9;  // nu is not exactly a half integer
  for (const int half : {1, 3, 5, 7}) {
    const Kernel closed("matern-c" + std::to_string(half - 1), 3);
    const Kernel general("matern", 3, half / 2.0 + 1e-11);
    for (const double r : {1e-4, .01, .3, 1.0, 5.0, 40.0}) {
      EXPECT_NEAR(general.value(r), closed.value(r), bessel);
      EXPECT_NEAR(general.g(r) / closed.g(r), 1, bessel) << half << " " << r;
      EXPECT_NEAR(general.h(r) / closed.h(r), 1, bessel) << half << " " << r;
    }
  }
}

// Around r = 1e-8, where the limit at the center takes over; libc++ has no Bessel functions to compare with.
#ifdef __cpp_lib_math_special_functions
TEST(Kernel, OfMaternIsThatOfBesselFunctionsNextToTheCenter) {
  for (const double nu : {.3, .7, .9})
    for (const double r : {1e-10, 9e-9, 1.1e-8, 1e-6}) {
      const double bessel = 2 * std::pow(r / 2, nu) * std::cyl_bessel_k(nu, r) / std::tgamma(nu);
      EXPECT_NEAR(Kernel("matern", 2, nu).value(r), bessel, 1e-12) << nu << " " << r;
    }
}
#endif

TEST(Kernel, OfMaternAndItsDerivativesVanishFarAway) {
  for (const double nu : {.3, 1.0, 1.7, 2.0, 3.2})
    for (const double r : {690.0, 710.0, 1e4, 1e200}) {
      const Kernel kernel("matern", 2, nu);
      for (const double part : {kernel.value(r), kernel.g(r), kernel.h(r)}) EXPECT_NEAR(part, 0, 1e-280) << nu;
    }
}

TEST(Kernel, DerivativesAreThoseOfFiniteDifferences) {
  constexpr double step = 1e-4;
  for (const Named& named : all_kernels(1)) {
    const Kernel kernel(named.name, 1, named.parameter);
    const auto slope = [&](double r) { return r * kernel.g(r); };
    const auto difference = [](const auto& f, double r) {  // of order 4
      return (8 * (f(r + step) - f(r - step)) - f(r + 2 * step) + f(r - 2 * step)) / (12 * step);
    };
    for (const double r : {.02, .1, .4, .7, .9, .98, .999, 1.5}) {
      const double scale = 1 + std::abs(kernel.q(r)) + std::abs(kernel.g(r));
      constexpr double tolerance = 1e-7;  // of the difference quotient near the singularities at 0 and 1
      EXPECT_NEAR(slope(r), difference([&](double t) { return kernel.value(t); }, r), tolerance * scale)
          << label(named) << " " << r;
      if (kernel.compact() && r > .99 && r < 1.01) continue;
      const double second = kernel.q(r) + kernel.g(r);
      EXPECT_NEAR(second, difference(slope, r), 1e-5 * scale) << label(named) << " " << r;
      EXPECT_NEAR(kernel.q(r), r * r * kernel.h(r), rounding * scale);
      EXPECT_NEAR(kernel.laplacian(r), kernel.g(r) + kernel.q(r), rounding * scale);
    }
  }
}

// The derivatives of f(x) = phi(|x|) at 0: gradient 0 and Hessian g(0) I, for kernels that are smooth there.
TEST(Kernel, SecondDerivativeAtTheCenterIsG) {
  constexpr double step = 1e-3;
  for (const Named& named : all_kernels(2)) {
    const Kernel kernel(named.name, 2, named.parameter);
    EXPECT_TRUE(std::isfinite(kernel.value(0)) && std::isfinite(kernel.g(0)) && std::isfinite(kernel.h(0)));
    EXPECT_EQ(kernel.q(0), 0) << label(named);
    if (kernel.smoothness() < 2 || named.name == "polyharmonic" || named.parameter == 1.7) continue;
    const double second = 2 * (kernel.value(step) - kernel.value(0)) / (step * step);
    EXPECT_NEAR(kernel.g(0), second, .05 * (1 + std::abs(second))) << label(named);
    EXPECT_EQ(kernel.laplacian(0), 2 * kernel.g(0));
    EXPECT_NEAR(kernel.g(1e-9), kernel.g(0), 1e-3) << label(named);
  }
}

TEST(Kernel, DerivativesMissingAtTheCenterAreZeroByConvention) {
  for (const char* name :
       {"wendland-c0", "wu-c0", "matern-c0", "linear", "thin-plate", "missing-wendland", "buhmann-c1"})
    EXPECT_EQ(Kernel(name, 2).g(0), 0) << name;
  for (const char* name : {"wendland-c0", "wendland-c2", "wu-c0", "wu-c2", "matern-c0", "matern-c2", "linear", "cubic",
                           "thin-plate", "thin-plate-r4", "missing-wendland", "buhmann-c1", "powered-exponential"})
    EXPECT_EQ(Kernel(name, 2).h(0), 0) << name;
}

TEST(Kernel, IsOneAtTheCenterOrZeroForPowers) {
  for (const Named& named : all_kernels(3)) {
    const Kernel kernel(named.name, 3, named.parameter);
    const double expected = !kernel.has_scale() ? 0 : std::copysign(1.0, kernel.value(1e-3));
    EXPECT_EQ(kernel.value(0), expected) << label(named);
  }
}

TEST(Kernel, CompactOnesVanishFromOneOn) {
  for (const Named& named : all_kernels(2)) {
    const Kernel kernel(named.name, 2, named.parameter);
    EXPECT_EQ(kernel.compact(), kernel.value(1) == 0 && kernel.value(5) == 0) << label(named);
    if (!kernel.compact()) continue;
    for (const double r : {1.0, 1.0 + 1e-15, 2.0, 1e200, std::numeric_limits<double>::infinity()}) {
      EXPECT_EQ(kernel.value(r), 0);
      EXPECT_EQ(kernel.g(r), 0) << label(named);
      EXPECT_EQ(kernel.h(r), 0) << label(named);
      EXPECT_EQ(kernel.q(r), 0) << label(named) << " at " << r;
      EXPECT_EQ(kernel.laplacian(r), 0) << label(named) << " at " << r;
    }
  }
}

TEST(Kernel, BatchesOfAnySizeAgreeWithScalars) {
  for (const Named& named : all_kernels(1)) {
    const Kernel kernel(named.name, 1, named.parameter);
    for (const Index n : {0, 1, 7, 8, 13, 40}) {
      Eigen::VectorXd r2 = Eigen::VectorXd::LinSpaced(n, 0, 1.3);
      Eigen::MatrixXd out(n, 6);
      kernel.values(r2.data(), n, out.col(0).data());
      kernel.gradients(r2.data(), n, out.col(1).data(), out.col(2).data());
      kernel.hessians(r2.data(), n, out.col(3).data(), out.col(4).data(), out.col(5).data());
      for (Index i = 0; i < n; ++i) {
        const double r = std::sqrt(r2[i]);
        const double scale = 1 + std::abs(kernel.h(r)) + std::abs(kernel.g(r));
        for (const Index part : {0, 1, 3}) EXPECT_NEAR(out(i, part), kernel.value(r), rounding * scale) << label(named);
        for (const Index part : {2, 4}) EXPECT_NEAR(out(i, part), kernel.g(r), rounding * scale) << label(named);
        EXPECT_NEAR(out(i, 5), kernel.h(r), rounding * scale) << label(named);
      }
    }
  }
}

TEST(Kernel, KeepsNaN) {
  for (const Named& named : all_kernels(1)) {
    const Kernel kernel(named.name, 1, named.parameter);
    EXPECT_TRUE(std::isnan(kernel.value(std::nan("")))) << label(named);
  }
}

TEST(Kernel, OfSmoothnessMHasAtLeastThatManyDerivativesAtTheCenter) {
  // The slope phi' is an odd function of x: its jump at 0 is 2 phi'(0+), zero for smoothness >= 1.
  for (const Named& named : all_kernels(1)) {
    const Kernel kernel(named.name, 1, named.parameter);
    const double r = 1e-12;
    const bool continuous = std::abs(r * kernel.g(r)) < 1e-2;
    EXPECT_EQ(continuous, kernel.smoothness() >= 1) << label(named);
  }
}

std::string message_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "";
}

TEST(Kernel, IsRefusedInDimensionsWhereItIsNotPositiveDefinite) {
  EXPECT_EQ(message_of([] { Kernel("wu-c4", 5); }).substr(0, 72),
            "kernel = wu-c4: is positive definite only up to dimension 3, not in 5; u");
  const std::string message = message_of([] { Kernel("buhmann-c3", 4); });
  EXPECT_NE(message.find("wendland-c4"), std::string::npos);
  EXPECT_NE(message.find("buhmann-c2"), std::string::npos);
  EXPECT_EQ(message.find("wu-c6"), std::string::npos);
  for (int d = 1; d <= 8; ++d)
    for (const std::string& name : Kernel::names(d)) EXPECT_NO_THROW(Kernel(name, d));
}

TEST(Kernel, RejectsUnknownNamesListingTheKnown) {
  const std::string message = message_of([] { Kernel("gauss", 2); });
  EXPECT_EQ(message.find("kernel = gauss: unknown; use one of wendland-c0, wendland-c2"), 0U) << message;
}

TEST(Kernel, RejectsParametersOutOfRange) {
  EXPECT_EQ(message_of([] { Kernel("gaussian", 2, 3); }),
            "kernel: parameter of gaussian = 3: this kernel has none; leave it out");
  EXPECT_EQ(message_of([] { Kernel("matern", 2, 0); }),
            "kernel: parameter of matern = 0: must be positive and at most 50");
  EXPECT_EQ(message_of([] { Kernel("powered-exponential", 2, 2.5); }),
            "kernel: parameter of powered-exponential = 2.5: must be at most 2: larger ones are not positive definite");
  EXPECT_EQ(message_of([] { Kernel("multiquadric", 2, 2); }),
            "kernel: parameter of multiquadric = 2: must not be an integer, or the kernel is a polynomial");
  EXPECT_EQ(message_of([] { Kernel("cubic", 0); }),
            "kernel: dimension = 0: must be at least 1; give the dimension of the points");
}

}  // namespace
}  // namespace csrbf::kernel_test
