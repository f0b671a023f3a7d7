#pragma once

#include "csrbf/core/types.hpp"

#include <vector>

namespace csrbf {

/// So many samples at even steps along a curve through all. All of fewer.
inline std::vector<Index> even_samples(const std::vector<Index>& order, Index count) {
  const auto n = std::ssize(order);
  if (n <= count) return order;
  std::vector<Index> chosen;
  for (Index i = 0; i < count; ++i) chosen.push_back(order[static_cast<std::size_t>((2 * i + 1) * n / (2 * count))]);
  return chosen;
}

/// Every k-th pair of neighbours along a curve, `count` samples in all: even, and with short distances. All of fewer.
inline std::vector<Index> even_pairs(const std::vector<Index>& order, Index count) {
  const auto n = std::ssize(order);
  if (n <= count) return order;
  std::vector<Index> chosen;
  const Index pairs = count / 2;
  for (Index k = 0; k < pairs; ++k) {
    const auto first = static_cast<std::size_t>((2 * k + 1) * (n - 1) / (2 * pairs));
    chosen.push_back(order[first]);
    chosen.push_back(order[first + 1]);
  }
  return chosen;
}

}  // namespace csrbf
