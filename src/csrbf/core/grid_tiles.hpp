#pragma once

#include "csrbf/core/field.hpp"

namespace csrbf {

/// A block of nodes of a grid: those with begin[a] <= i_a < end[a].
template <int Dim>
struct GridTile {
  std::array<Index, Dim> begin, end;

  [[nodiscard]] Index size(int axis) const { return end[axis] - begin[axis]; }
  [[nodiscard]] Index nodes() const {
    Index product = 1;
    for (int a = 0; a < Dim; ++a) product *= size(a);
    return product;
  }
};

/// The tiles of a grid: roughly cubes of at most `nodes_per_tile` nodes.
template <int Dim>
class GridTiles {
 public:
  GridTiles(const GridAxes<Dim>& axes, Index nodes_per_tile) {
    constexpr double rounding = 1e-9;  // keeps exact roots, such as 8^(1/3), from being rounded down
    auto room = static_cast<double>(nodes_per_tile);
    for (std::size_t a = Dim; a-- > 0;) {
      size_[a] = axes[a].size();
      const double side = std::floor(std::pow(room, 1 / static_cast<double>(a + 1)) + rounding);
      side_[a] = std::clamp<Index>(static_cast<Index>(side), 1, std::max<Index>(1, size_[a]));
      room /= static_cast<double>(side_[a]);
    }
  }

  /// Number of tiles.
  [[nodiscard]] Index size() const {
    Index product = 1;
    for (std::size_t a = 0; a < Dim; ++a) product *= per_axis(a);
    return product;
  }
  [[nodiscard]] GridTile<Dim> operator[](Index i) const {
    GridTile<Dim> tile;
    for (std::size_t a = 0; a < Dim; ++a) {
      tile.begin[a] = i % per_axis(a) * side_[a];
      tile.end[a] = std::min(tile.begin[a] + side_[a], size_[a]);
      i /= per_axis(a);
    }
    return tile;
  }

  /// Number of nodes of the whole grid.
  [[nodiscard]] Index nodes() const {
    Index product = 1;
    for (const Index n : size_) product *= n;
    return product;
  }

  /// Calls row(node, first) for each row of a tile along the first axis: `node` holds the indices of its first node,
  /// which is number `first` of the grid.
  template <class Row>
  void for_each_row(const GridTile<Dim>& tile, const Row& row) const {
    std::array<Index, Dim> node = tile.begin;
    for (std::size_t a = 0; a < Dim;) {
      Index first = 0;
      for (std::size_t b = Dim; b-- > 0;) first = first * size_[b] + node[b];
      row(node, first);
      for (a = 1; a < Dim && ++node[a] == tile.end[a]; ++a) node[a] = tile.begin[a];
    }
  }

 private:
  [[nodiscard]] Index per_axis(std::size_t a) const { return (size_[a] + side_[a] - 1) / side_[a]; }

  std::array<Index, Dim> size_, side_;
};

}  // namespace csrbf
