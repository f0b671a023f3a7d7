#include "csrbf/levelset/objects/bent_shapes.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace csrbf::bent_shapes_test {
namespace {

TEST(BentShapes, OfSomeVoxelsAreThoseOfAll) {
  std::vector<Point<3>> all, some;
  for (int y = -40; y <= 40; ++y)
    for (int x = -40; x <= 40; ++x) {
      const double angle = std::atan2(x, y), end = std::max(0.0, std::abs(angle) - 1.1);
      if (std::hypot(std::hypot(x, y) - 30, 30 * end) > 1.6) continue;
      all.emplace_back(x, y, 0);
      if (all.size() % 4 == 0) some.emplace_back(x, y, 0);
    }
  const auto size = static_cast<double>(all.size());
  const BentShapes of_all = fit_bent_shapes(all, size, 1, 2), of_some = fit_bent_shapes(some, size, 1, 2);
  EXPECT_LT(of_all.rod, 0.05);
  EXPECT_LT(of_some.rod, 0.05);
}

}  // namespace
}  // namespace csrbf::bent_shapes_test
