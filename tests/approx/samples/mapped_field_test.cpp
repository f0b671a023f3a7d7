#include "csrbf/approx/samples/mapped_field.hpp"

#include "approx/approx_testing.hpp"
#include "csrbf/approx/fit.hpp"

namespace csrbf::mapped_field_test {
namespace {

TEST(MappedField, IsTheInnerOneInOtherCoordinates) {
  const Samples<2> data = sample<2>(random_points<2>(200, 1), franke);
  const auto inner = fit<2>(data, {.method = "interpolate"}).components[0];
  Eigen::Matrix2d map;
  map << 0.6, 0.2, -0.1, 0.5;
  const MappedField<2> field(inner, map);
  Points<2> x = map.inverse() * random_points<2>(20, 2);
  EXPECT_TRUE(field.evaluate(x).value.isApprox(inner->evaluate(Points<2>(map * x)).value, 1e-12));
  expect_true_derivatives<2>(field, x, 1e-4, 1e-3);
  const Box<2> inside = inner->bounds(), bounds = field.bounds();
  for (const Index k : {0, 1, 2, 3}) {
    const Point<2> corner((k & 1) != 0 ? inside.hi.x() : inside.lo.x(), (k & 2) != 0 ? inside.hi.y() : inside.lo.y());
    EXPECT_TRUE(bounds.inflated(1e-9).contains(map.inverse() * corner));
  }
}

}  // namespace
}  // namespace csrbf::mapped_field_test
