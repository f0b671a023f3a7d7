#pragma once

#include <cstdint>
#include <vector>

namespace csrbf {

/// A number to sort by and what it belongs to.
struct Keyed {
  std::uint32_t key, index;
};

/// Sorts by key; equal keys keep their order. Keys must be below `limit` or equal to it: the fewer bits it has, the
/// faster. On all threads, O(n) for each 11 bits; one look at items that are sorted already.
void radix_sort(std::vector<Keyed>& items, std::uint32_t limit = UINT32_MAX);

}  // namespace csrbf
