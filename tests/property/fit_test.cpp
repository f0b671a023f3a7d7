#include "csrbf/approx/fit.hpp"

#include "csrbf/kernels/kernel.hpp"

#include "property/property_testing.hpp"

#include <limits>

namespace csrbf::fit_test {
namespace {

// Places: in a box of any size anywhere, on a line, on a grid where distances tie, in clusters, many twice.
template <int Dim>
Points<Dim> random_places(Random& random, Index n) {
  Points<Dim> x = random.in_unit_cube<Dim>(n);
  const int kind = random.whole(0, 5);
  const auto side = static_cast<Index>(std::ceil(std::pow(static_cast<double>(n), 1.0 / Dim)));
  const Point<Dim> line = random.direction<Dim>();
  for (Index i = 0; i < n; ++i) {
    if (kind == 0) x.col(i) = x(0, i) * line;
    if (kind == 1)
      for (Index a = 0, rest = i; a < Dim; ++a, rest /= side) x(a, i) = static_cast<double>(rest % side);
    if (kind == 2) x.col(i) *= i % 3 == 0 ? 1e-7 : 1;
    if (kind == 3) x.col(i) = x.col(i - i % random.whole(1, 3));
  }
  if (random.one_in(8)) x.row(random.whole(0, Dim - 1)).setConstant(random.normal());
  if (random.one_in(4)) x.row(random.whole(0, Dim - 1)) *= random.magnitude(-9, 9);
  if (random.one_in(3)) x *= random.magnitude(-12, 12);
  if (random.one_in(4)) x.colwise() += random.magnitude(-3, 9) * random.direction<Dim>();
  return x;
}

Eigen::VectorXd random_values(Random& random, Index n) {
  Eigen::VectorXd v = Eigen::VectorXd::NullaryExpr(n, [&] { return random.normal(); });
  const int kind = random.whole(0, 7);
  for (Index i = 0; i < n; ++i) {
    if (kind == 0) v[i] = 42;
    if (kind == 1) v[i] = i % 17 == 0 ? 1e6 : 0;                                  // spikes
    if (kind == 2) v[i] = v[i] < 0 ? 0 : 1;                                       // two values
    if (kind == 3) v[i] *= std::numeric_limits<double>::denorm_min();             // hardly any
    if (kind == 4) v[i] *= random.magnitude(-200, 200);                           // of all magnitudes
    if (kind == 5) v[i] = std::sin(1e-2 * static_cast<double>(i)) + 1e-9 * v[i];  // no function of the place
  }
  if (random.one_in(4)) v *= random.magnitude(-150, 150);
  if (random.one_in(8)) v.array() += random.magnitude(0, 12);
  if (random.one_in(12))
    v[random.whole(0, static_cast<int>(n) - 1)] = random.any_of<double>({1e300, -1e300, 1e308, std::nan("")});
  return v;
}

template <int Dim>
Samples<Dim> random_samples(Random& random, int most) {
  const Index n = random.whole(1, most);
  Samples<Dim> samples{random_places<Dim>(random, n), random_values(random, n), {}};
  if (random.one_in(3)) {
    samples.weights = Eigen::VectorXd::NullaryExpr(n, [&] { return random.magnitude(-9, 9); });
    if (random.one_in(2)) samples.weights[0] = 0;
  }
  return samples;
}

FitOptions random_options(Random& random) {
  FitOptions options;
  if (random.one_in(2)) options.method = random.any_of(fit_methods());
  if (random.one_in(4)) options.kernel = random.any_of<std::string>({"wendland-c2", "wendland-c4", "thin-plate"});
  if (random.one_in(4)) options.centers = random.whole(1, 300);
  if (random.one_in(5)) options.tolerance = random.magnitude(-6, 1);
  if (random.one_in(3)) options.smoothing = random.one_in(2) ? 0 : random.magnitude(-9, 3);
  if (random.one_in(4)) options.degree = random.whole(-1, 3);
  options.scale_axes = random.one_in(2);
  return options;
}

template <int Dim>
Points<Dim> places_around(Random& random, const Box<Dim>& box) {
  Points<Dim> x = (box.extent().asDiagonal() * random.in_unit_cube<Dim>(40)).colwise() + box.lo;
  x.col(0) = box.lo - box.extent();
  return x;
}

template <int Dim>
void expect_sound(const Fit<Dim>& fit, Random& random) {
  ASSERT_EQ(fit.components.size(), 1U);
  const Field<Dim>& f = *fit.components[0];
  const Jet<Dim> jet = f.evaluate(places_around<Dim>(random, f.bounds()), Derivatives::gradient);
  EXPECT_TRUE(jet.value.allFinite());
  EXPECT_TRUE(jet.gradient.allFinite());
  (void)f(Point<Dim>::Constant(std::nan("")));
  EXPECT_TRUE(std::isfinite(fit.report.rmse) && std::isfinite(fit.report.max_error));
}

template <int Dim>
void any_samples(Random& random) {
  const Samples<Dim> samples = random_samples<Dim>(random, Dim > 3 ? 200 : 600);
  const FitOptions options = random_options(random);
  const Fit<Dim> result = fit<Dim>(samples, options);
  SCOPED_TRACE("method " + result.report.method + ", dimension " + std::to_string(Dim));
  expect_sound(result, random);
  if (options.tolerance > 0 && result.report.warnings.empty()) {
    EXPECT_LE(result.report.max_error, options.tolerance * (1 + 1e-9));  // rounding
  }
}

TEST(FitProperties, AnySamplesBecomeAFiniteFunctionOrAnError) {
  for_each_case(40, 4, [](Random& random) {
    switch (random.whole(1, 6)) {
      case 1:
        return any_samples<1>(random);
      case 2:
        return any_samples<2>(random);
      case 3:
        return any_samples<3>(random);
      case 4:
        return any_samples<4>(random);
      case 5:
        return any_samples<5>(random);
      default:
        return any_samples<6>(random);
    }
  });
}

}  // namespace
}  // namespace csrbf::fit_test
