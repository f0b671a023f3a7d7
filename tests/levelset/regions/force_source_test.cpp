#include "csrbf/levelset/regions/force_source.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace csrbf::force_source_test {
namespace {

// The force is 6 in every voxel, and the other region costs 12.
class ConstantForce final : public ForceSource {
 public:
  using ForceSource::ForceSource;
  void fit(std::span<const std::uint8_t> /*labels*/) override {}
  void undo() override {}
  double force(int /*k*/, double scale, std::span<float> force) const override {
    for (float& value : force) value = static_cast<float>(6 / scale);
    return 12;
  }
};

// Whatever the scale, 1 included.
TEST(ForceSource, AddsThePriorInUnitsOfTheScale) {
  const std::vector<float> prior{1, -1, 0.5F};
  const ConstantForce source(2, prior);
  for (const double scale : {1.0, 2.0, 3.0}) {
    std::vector<float> force(3);
    EXPECT_EQ(source.force_with_prior(1, scale, force), 12 / scale);
    for (std::size_t i = 0; i < 3; ++i) EXPECT_FLOAT_EQ(force[i], static_cast<float>(6 / scale) + prior[i]);
  }
}

}  // namespace
}  // namespace csrbf::force_source_test
