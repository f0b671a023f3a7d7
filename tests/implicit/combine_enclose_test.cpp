#include "csrbf/implicit/combine.hpp"
#include "implicit/analytic_fields.hpp"

#include <gtest/gtest.h>

namespace csrbf::combine_enclose_test {
namespace {

const Solid a = std::make_shared<const EnclosedBall>(1, Point<3>(-0.6, 0, 0));
const Solid b = std::make_shared<const EnclosedBall>(0.9, Point<3>(0.7, 0.1, 0));
const Solid c = std::make_shared<const EnclosedBall>(0.7, Point<3>(0, 0.2, 0.9));
const Box<3> around = box_around(Point<3>::Zero(), Point<3>(2.2, 1.6, 2));

TEST(CombineEnclose, HoldsForAllOperationsAndBlendings) {
  for (const Blending blending :
       {Blending::sharp, Blending::r_function, Blending::super_elliptic, Blending::log_sum_exp})
    for (const double sharpness : {1.0, 2.0, 3.0, 8.0})
      for (const Operation operation : {Operation::unite, Operation::intersect, Operation::subtract}) {
        CombineOptions options;
        options.blending = blending;
        options.radius = 0.15;
        options.sharpness = sharpness;
        EXPECT_TRUE(encloses(*combine(operation, {a, b, c}, options), around, 1))
            << name_of(blending) << " " << sharpness << " " << name_of(operation);
      }
  EXPECT_TRUE(encloses(*~a, around, 2));
}

TEST(CombineEnclose, IsThatOfOnePartWhereItIsAlone) {
  const Box<3> near_a = box_around({-1.5, 0, 0}, Point<3>::Constant(0.05));
  const Enclosure alone = a->enclose(near_a).value();
  CombineOptions rounded;
  rounded.blending = Blending::super_elliptic;
  for (const Solid& joined : {a | b, combine(Operation::unite, {a, b}, rounded)}) {
    const Enclosure found = joined->enclose(near_a).value();
    EXPECT_EQ(found.lo, alone.lo);
    EXPECT_EQ(found.hi, alone.hi);
    EXPECT_EQ(found.hessian_bound, alone.hessian_bound);
  }
}

TEST(CombineEnclose, KnowsNothingWhenAPartDoesNot) {
  const Solid unknown = std::make_shared<const AnalyticField>(ball(1));
  EXPECT_FALSE((a | unknown)->enclose(around).has_value());
}

}  // namespace
}  // namespace csrbf::combine_enclose_test
