#include "csrbf/implicit/polygonize/cell_lattice.hpp"

#include "csrbf/core/error.hpp"

namespace csrbf::polygonization {
namespace {

constexpr int default_margin = 4;  // cells around the box; chosen by hand
constexpr double rounding = 1e-9;  // cells: a side that exceeds a whole number of cells by less is not enlarged

Eigen::Array3d cells_in(const Box<3>& box, double size) {
  const Eigen::Array3d cells = box.extent().array() / size;
  require(cells.maxCoeff() < max_cells - 10, "polygonize", "bounds / cell size", cells.maxCoeff(),
          "must be below 2^20 cells; shrink the bounds or lower the resolution");
  return cells;
}

}  // namespace

CellLattice lattice_around(const Box<3>& box, double size) {
  CellLattice lattice;
  lattice.cells = (cells_in(box, size) - rounding).ceil().cast<int>() + 2 * default_margin + 2;
  lattice.spacing.setConstant(size);
  lattice.origin = box.center() - 0.5 * size * lattice.cells.matrix().cast<double>();
  return lattice;
}

CellLattice lattice_in(const Box<3>& box, double size) {
  const Cell inner = cells_in(box, size).round().cast<int>().max(1);
  CellLattice lattice;
  lattice.cells = inner + 2;
  lattice.spacing = box.extent().array() / inner.cast<double>();
  lattice.origin = box.lo - lattice.spacing;
  return lattice;
}

}  // namespace csrbf::polygonization
