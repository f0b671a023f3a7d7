#pragma once

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <vector>

namespace csrbf {

/// Disjoint sets of the integers 0 .. n - 1, each represented by its smallest member.
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), 0U); }

  /// The smallest member of the set of i. Nearly constant time.
  std::uint32_t find(std::uint32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }

  /// One more integer, in a set of its own.
  std::uint32_t add() {
    parent_.push_back(static_cast<std::uint32_t>(parent_.size()));
    return parent_.back();
  }
  [[nodiscard]] std::size_t size() const { return parent_.size(); }

  /// Merges the sets of i and j.
  void unite(std::uint32_t i, std::uint32_t j) {
    i = find(i);
    j = find(j);
    parent_[std::max(i, j)] = std::min(i, j);
  }

 private:
  std::vector<std::uint32_t> parent_;
};

}  // namespace csrbf
