#pragma once

#include "csrbf/implicit/polygonize/brick_grid.hpp"

namespace csrbf::polygonization {

/// Cubes of side `size` that fill a box, and four more on every side, for the box may be that of samples beside the
/// surface; another layer holds the caps. Throws InvalidInput for 2^20 cells along a side.
CellLattice lattice_around(const Box<3>& box, double size);

/// Cells of about that size, as close to cubes as fill the box exactly; another layer holds the caps. Throws the same.
CellLattice lattice_in(const Box<3>& box, double size);

}  // namespace csrbf::polygonization
