#include "csrbf/core/disjoint_sets.hpp"

#include <gtest/gtest.h>

#include <random>

namespace csrbf::disjoint_sets_test {
namespace {

TEST(DisjointSets, AreRepresentedByTheirSmallestMember) {
  DisjointSets sets(5);
  for (std::uint32_t i = 0; i < 5; ++i) EXPECT_EQ(sets.find(i), i);
  sets.unite(4, 2);
  sets.unite(3, 4);
  EXPECT_EQ(sets.find(3), 2U);
  EXPECT_EQ(sets.find(4), 2U);
  EXPECT_EQ(sets.find(1), 1U);
  sets.unite(3, 0);
  EXPECT_EQ(sets.find(4), 0U);
}

TEST(DisjointSets, AgreeWithLabelsKeptByHand) {
  constexpr std::uint32_t n = 60;
  DisjointSets sets(n);
  std::vector<std::uint32_t> label(n);
  std::iota(label.begin(), label.end(), 0U);
  std::mt19937_64 random(2);
  for (int step = 0; step < 50; ++step) {
    const auto i = static_cast<std::uint32_t>(random() % n), j = static_cast<std::uint32_t>(random() % n);
    sets.unite(i, j);
    const std::uint32_t kept = std::min(label[i], label[j]), dropped = std::max(label[i], label[j]);
    for (std::uint32_t& l : label)
      if (l == dropped) l = kept;
    for (std::uint32_t k = 0; k < n; ++k) ASSERT_EQ(sets.find(k), label[k]);
  }
}

}  // namespace
}  // namespace csrbf::disjoint_sets_test
