#pragma once

#include "csrbf/core/types.hpp"

#include <vector>

namespace csrbf {

/// The winding number of closed curves in the plane, from samples of them. Samples in one cell of a lattice count as
/// one, and far blocks of cells too, so that dense samples cost little.
class PlanarWinding {
 public:
  /// `dipoles`: outward normals times the length of curve that each sample represents.
  PlanarWinding(const Points<2>& samples, const Points<2>& dipoles, double cell);

  /// The angle that the curves turn around x: 2 pi inside. What is within half a cell of x does not count.
  [[nodiscard]] double angle(const Point<2>& x) const;

 private:
  struct Sum {
    Point<2> center, dipole;
  };
  struct Block {
    Sum all;
    std::size_t begin, end;  // of its cells
  };

  [[nodiscard]] static double angle(const Sum& sum, const Point<2>& to);

  double cell_;
  std::vector<Sum> cells_;
  std::vector<Block> blocks_;
};

}  // namespace csrbf
