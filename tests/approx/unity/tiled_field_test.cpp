#include "csrbf/approx/unity/tiled_field.hpp"

#include "implicit/polygonize_fields.hpp"

#include <cmath>

namespace csrbf::tiled_field_test {
namespace {

const TilePlan<3> two_tiles({{0, -1, -2, 0.5}}, 0.1);

std::shared_ptr<const Field<3>> constant(double value) {
  const auto f = [value](const Point<3>&, Point<3>& gradient) {
    gradient.setZero();
    return value;
  };
  return std::make_shared<Implicit>(f, cube(1), columns({Point<3>(0.2, 0, 0), Point<3>(0.8, 0, 0)}));
}

TEST(TiledField, IsOneFieldDeepInATileAndBlendsAtItsFaces) {
  const TiledField<3> field(two_tiles, {{constant(1), constant(2)}, {constant(10), constant(20)}}, cube(1), 0);
  EXPECT_EQ(field({0.39, 0, 0}), 1);
  EXPECT_EQ(field({0.61, 0, 0}), 10);
  EXPECT_DOUBLE_EQ(field({0.5, 0.3, 0}), 11);
  EXPECT_NEAR(field({0.401, 0, 0}), 2, 1e-3);  // the rim takes over
  EXPECT_NEAR(field({0.599, 0, 0}), 20, 1e-3);
}

TEST(TiledField, GradientsAreThoseOfTheValues) {
  const auto left = std::make_shared<Implicit>(sphere(1)), right = std::make_shared<Implicit>(sphere(0.9, {0.1, 0, 0}));
  const TiledField<3> field(two_tiles, {{left, left}, {right, right}}, cube(1), 0);
  const Points<3> x = columns({Point<3>(0.46, 0.3, 0.2), Point<3>(0.53, -0.2, 0.7), Point<3>(0.1, 0, 0)});
  const Jet<3> jet = field.evaluate(x, Derivatives::gradient);
  constexpr double h = 1e-6;
  for (Index i = 0; i < x.cols(); ++i)
    for (int axis = 0; axis < 3; ++axis) {
      const Point<3> step = h * Point<3>::Unit(axis);
      EXPECT_NEAR(jet.gradient(axis, i), (field(x.col(i) + step) - field(x.col(i) - step)) / (2 * h), 1e-7);
    }
}

// The value at a point does not depend on what else is in the block.
TEST(TiledField, BlocksDoNotMatter) {
  const auto left = std::make_shared<Implicit>(sphere(1)), right = std::make_shared<Implicit>(sphere(0.9));
  const TiledField<3> field(two_tiles, {{left, left}, {right, right}}, cube(1), 0);
  Points<3> x(3, 200);
  for (Index i = 0; i < x.cols(); ++i) x.col(i) << 0.3 + 0.002 * static_cast<double>(i), 0.1, std::sin(i);
  Eigen::VectorXd together(x.cols());
  field.evaluate_block(x, {together.data(), nullptr, nullptr});
  for (Index i = 0; i < x.cols(); ++i) EXPECT_EQ(field(x.col(i)), together[i]);
}

TEST(TiledField, SeedsAreThoseOfEachTileInItsOwnBox) {
  const TiledField<3> field(two_tiles, {{constant(1), nullptr}, {nullptr, constant(2)}}, cube(1), 0);
  ASSERT_EQ(field.seeds().cols(), 1);
  EXPECT_EQ(field.seeds()(0, 0), 0.2);
}

TEST(TiledField, ATileWithoutFieldsHasNoValue) {
  const TiledField<3> field(two_tiles, {{constant(1), constant(1)}, {}}, cube(1), 0);
  EXPECT_TRUE(std::isnan(field({0.9, 0, 0})));
  EXPECT_EQ(field({0.2, 0, 0}), 1);
}

}  // namespace
}  // namespace csrbf::tiled_field_test
