#include "csrbf/levelset/regions/slab_components.hpp"

#include "csrbf/levelset/regions/region_labels.hpp"

#include <gtest/gtest.h>

#include <random>

namespace csrbf::slab_components_test {
namespace {

TEST(SlabComponents, AreThoseOfTheWholeImage) {
  Grid grid;
  grid.size = {9, 7, 24};
  std::mt19937 random(3);
  for (const double share : {0.1, 0.3, 0.35, 0.6}) {
    std::bernoulli_distribution inside(share);
    std::vector<std::uint8_t> labels(static_cast<std::size_t>(grid.voxels()));
    for (std::uint8_t& label : labels) label = inside(random) ? 1 + random() % 2 : 0;
    const Index whole = count_components(labels, grid);
    for (const Index slices : {1, 3, 24}) {
      SlabComponents parts(9, 7);
      for (Index z = 0; z < 24; z += slices) parts.add(std::span(labels).subspan(z * 63, slices * 63));
      EXPECT_EQ(parts.count(), whole) << share << " in slabs of " << slices;
    }
  }
}

TEST(SlabComponents, JoinPartsThatMeetLater) {
  SlabComponents parts(3, 1);
  parts.add(std::vector<std::uint8_t>{1, 0, 1});
  EXPECT_EQ(parts.count(), 2);
  parts.add(std::vector<std::uint8_t>{1, 1, 1});
  EXPECT_EQ(parts.count(), 1);
}

}  // namespace
}  // namespace csrbf::slab_components_test
