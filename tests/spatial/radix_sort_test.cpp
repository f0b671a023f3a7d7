#include "csrbf/spatial/radix_sort.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace csrbf::radix_sort_test {
namespace {

std::vector<Keyed> random_items(std::size_t count, std::uint32_t limit) {
  std::mt19937 random(1);
  std::uniform_int_distribution<std::uint32_t> key(0, limit);
  std::vector<Keyed> items(count);
  for (std::size_t i = 0; i < count; ++i) items[i] = {key(random), static_cast<std::uint32_t>(i)};
  return items;
}

// The second size is shared among several parts, the limits take no digit to three.
TEST(RadixSort, SortsAsTheStableSortOfTheLibrary) {
  for (const std::size_t count : {std::size_t{0}, std::size_t{1}, std::size_t{700}, std::size_t{100'001}})
    for (const std::uint32_t limit : {0U, 1U, 2000U, 2048U, 1U << 22, UINT32_MAX}) {
      std::vector<Keyed> items = random_items(count, limit), expected = items;
      radix_sort(items, limit);
      std::stable_sort(expected.begin(), expected.end(), [](const Keyed& a, const Keyed& b) { return a.key < b.key; });
      EXPECT_TRUE(std::equal(items.begin(), items.end(), expected.begin(), expected.end(),
                             [](const Keyed& a, const Keyed& b) { return a.key == b.key && a.index == b.index; }))
          << count << " " << limit;
    }
}

}  // namespace
}  // namespace csrbf::radix_sort_test
