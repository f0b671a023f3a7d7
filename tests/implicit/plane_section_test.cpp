#include "csrbf/implicit/plane_section.hpp"

#include "implicit/analytic_fields.hpp"

namespace csrbf::plane_section_test {
namespace {

constexpr double rounding = 1e-13;

// A cubic polynomial without symmetry.
AnalyticField cubic() {
  return {[](const AnalyticField::Variables& x) {
            return x[0] * x[1] * x[2] + 2.0 * x[0] * x[0] * x[1] - 3.0 * x[2] * x[2] + x[1] - 0.5 * x[0];
          },
          box_around(Point<3>::Zero(), Point<3>::Ones())};
}

TEST(PlaneSection, HasTheDerivativesAlongThePlane) {
  const AnalyticField field = cubic();
  const Point<3> origin(0.2, -0.3, 0.4);
  Eigen::Matrix<double, 3, 2> across;
  across << 1, 0.5, -0.2, 0.7, 0.3, 2;
  const PlaneSection<3> section(field, origin, across, {Point<2>(-1, -1), Point<2>(1, 1)});
  const Points<2> x = Points<2>::Random(2, 10);
  const Jet<2> jet = section.evaluate(x, Derivatives::hessian);
  for (Index i = 0; i < x.cols(); ++i) {
    const Points<3> p = origin + across * x.col(i);
    const Jet<3> expected = field.evaluate(p, Derivatives::hessian);
    EXPECT_NEAR(jet.value[i], expected.value[0], rounding);
    EXPECT_TRUE(jet.gradient.col(i).isApprox(across.transpose() * expected.gradient, rounding));
    EXPECT_TRUE(jet.hessian_matrix(i).isApprox(across.transpose() * expected.hessian_matrix(0) * across, rounding));
  }
}

TEST(PlaneSection, HasTheSameValuesOnGridsAsAtPoints) {
  const AnalyticField field = cubic();
  const Point<3> origin(0.2, -0.3, 0.4);
  std::array<Eigen::Matrix<double, 3, 2>, 3> planes;
  planes[0] << 0.5, 0, 0, 0, 0, -2;  // along axes, one backwards
  planes[1] << 0, 1, 0, 0, 1, 0;     // along axes in the other order
  planes[2] << 1, 0.5, -0.2, 0.7, 0.3, 2;
  for (const auto& across : planes) {
    const PlaneSection<3> section(field, origin, across, {Point<2>(-1, -1), Point<2>(1, 1)});
    const GridAxes<2> axes{Eigen::VectorXd::LinSpaced(5, -1, 1), Eigen::VectorXd::LinSpaced(3, 0, 0.7)};
    const Eigen::VectorXd values = section.evaluate_grid(axes);
    ASSERT_EQ(values.size(), 15);
    for (Index j = 0; j < 3; ++j)
      for (Index i = 0; i < 5; ++i) EXPECT_NEAR(values[i + 5 * j], section(Point<2>(axes[0][i], axes[1][j])), rounding);
  }
}

TEST(PlaneSection, MeasuresDetailInItsOwnUnits) {
  const AnalyticField field([](const AnalyticField::Variables& x) { return x[0]; },
                            box_around(Point<3>::Zero(), Point<3>::Ones()), Points<3>(3, 0), 0.6);
  Eigen::Matrix<double, 3, 2> across;
  across << 2, 0, 0, 3, 0, 0;
  EXPECT_DOUBLE_EQ(PlaneSection<3>(field, Point<3>::Zero(), across, {}).feature_size(), 0.2);
}

}  // namespace
}  // namespace csrbf::plane_section_test
