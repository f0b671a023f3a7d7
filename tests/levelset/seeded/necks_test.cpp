#include "csrbf/levelset/seeded/necks.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace csrbf::necks_test {
namespace {

constexpr Index n = 96;

std::size_t at(Index x, Index y) {
  return static_cast<std::size_t>(x + n * y);
}

// Two discs of radius 15 at x = 25 and x = 70, and a bridge of that half width.
std::vector<std::uint8_t> dumbbell(Index half_width) {
  std::vector<std::uint8_t> labels(static_cast<std::size_t>(n * n), 0);
  for (Index y = 0; y < n; ++y)
    for (Index x = 0; x < n; ++x) {
      const auto u = static_cast<double>(x), v = static_cast<double>(y - 48);
      const bool bridge = x > 25 && x < 70 && std::abs(y - 48) <= half_width;
      labels[at(x, y)] = std::hypot(u - 25, v) < 15 || std::hypot(u - 70, v) < 15 || bridge ? 1 : 0;
    }
  return labels;
}

Grid grid_of_plane() {
  Grid grid;
  grid.axes = 2;
  grid.size = {n, n, 1};
  return grid;
}

TEST(Necks, AreCutBesideWhatIsMarked) {
  std::vector<std::uint8_t> marked(static_cast<std::size_t>(n * n), 0);
  marked[at(25, 48)] = 1;
  std::vector<std::uint8_t> labels = dumbbell(1);
  EXPECT_GT(cut_necks(labels, marked, grid_of_plane()), 0);
  EXPECT_EQ(labels[at(25, 48)], 1);
  EXPECT_EQ(labels[at(70, 48)], 0);
  labels = dumbbell(1);
  marked[at(70, 48)] = 1;
  EXPECT_EQ(cut_necks(labels, marked, grid_of_plane()), 0) << "both parts are marked";
  EXPECT_EQ(labels, dumbbell(1));
}

TEST(Necks, AreThinnerThanWhatTheyJoin) {
  std::vector<std::uint8_t> marked(static_cast<std::size_t>(n * n), 0);
  marked[at(25, 48)] = 1;
  std::vector<std::uint8_t> labels = dumbbell(7);
  EXPECT_EQ(cut_necks(labels, marked, grid_of_plane()), 0);
  EXPECT_EQ(labels, dumbbell(7));
}

TEST(MarkedParts, AreThoseOfEveryMark) {
  std::vector<std::uint8_t> labels = dumbbell(1), marked(labels.size(), 0);
  for (Index y = 0; y < n; ++y) labels[at(47, y)] = 0;
  marked[at(25, 48)] = 1;
  std::vector<std::uint8_t> left = labels;
  for (Index i = 0; i < n * n; ++i)
    if (i % n > 47) left[static_cast<std::size_t>(i)] = 0;
  EXPECT_EQ(marked_parts(labels, marked, grid_of_plane()), left);
  marked[at(70, 48)] = 1;
  EXPECT_EQ(marked_parts(labels, marked, grid_of_plane()), labels);
}

}  // namespace
}  // namespace csrbf::necks_test
