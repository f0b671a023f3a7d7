#include "csrbf/surface/prepare/planar_winding.hpp"

#include <cmath>
#include <map>
#include <utility>

namespace csrbf {
namespace {

// Chosen by hand.
constexpr double block_cells = 16;  // along the side of a block
constexpr double far_blocks = 2.5;  // sides away, a block is one dipole: .1 of the angle that its curve is seen under

std::pair<Index, Index> lattice_cell(const Point<2>& x, double side) {
  return {static_cast<Index>(std::floor(x[0] / side)), static_cast<Index>(std::floor(x[1] / side))};
}

}  // namespace

PlanarWinding::PlanarWinding(const Points<2>& samples, const Points<2>& dipoles, double cell) : cell_(cell) {
  using Key = std::pair<Index, Index>;
  std::map<std::pair<Key, Key>, std::pair<Sum, double>> sums;  // of samples, by block and cell
  for (Index k = 0; k < samples.cols(); ++k) {
    const Point<2> x = samples.col(k);
    const std::pair<Key, Key> key{lattice_cell(x, block_cells * cell), lattice_cell(x, cell)};
    auto& [sum, count] = sums.try_emplace(key, Sum{Point<2>::Zero(), Point<2>::Zero()}, 0.0).first->second;
    sum.center += x;
    sum.dipole += dipoles.col(k);
    ++count;
  }
  const Key* block = nullptr;
  for (auto& [key, value] : sums) {
    value.first.center /= value.second;
    if (block == nullptr || *block != key.first) {
      blocks_.push_back({{Point<2>::Zero(), Point<2>::Zero()}, cells_.size(), cells_.size()});
      block = &key.first;
    }
    cells_.push_back(value.first);
    blocks_.back().end = cells_.size();
  }
  for (Block& b : blocks_) {
    for (std::size_t c = b.begin; c < b.end; ++c) {
      b.all.center += cells_[c].center / static_cast<double>(b.end - b.begin);
      b.all.dipole += cells_[c].dipole;
    }
  }
}

double PlanarWinding::angle(const Sum& sum, const Point<2>& to) {
  return to.dot(sum.dipole) / to.squaredNorm();
}

double PlanarWinding::angle(const Point<2>& x) const {
  const double far = far_blocks * block_cells * cell_;
  double result = 0;
  for (const Block& b : blocks_) {
    const Point<2> to = b.all.center - x;
    if (to.squaredNorm() > far * far) {
      result += angle(b.all, to);
      continue;
    }
    for (std::size_t c = b.begin; c < b.end; ++c) {
      const Point<2> to_cell = cells_[c].center - x;
      if (to_cell.squaredNorm() > 0.25 * cell_ * cell_) result += angle(cells_[c], to_cell);
    }
  }
  return result;
}

}  // namespace csrbf
