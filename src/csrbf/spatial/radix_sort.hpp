#pragma once

#include <cstdint>
#include <vector>

namespace csrbf {

/// A sort key and the index of its item.
struct Keyed {
  std::uint32_t key, index;
};

/// Sorts by key; equal keys keep their order. Keys must not exceed `limit`: the fewer bits it has, the faster. On all
/// threads, O(n) for each 11 bits; a single pass over items that are already sorted.
void radix_sort(std::vector<Keyed>& items, std::uint32_t limit = UINT32_MAX);

}  // namespace csrbf
