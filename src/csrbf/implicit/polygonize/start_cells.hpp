#pragma once

#include "csrbf/core/progress.hpp"
#include "csrbf/implicit/polygonize/brick_grid.hpp"
#include "csrbf/implicit/polygonize/level_sampler.hpp"

namespace csrbf::polygonization {

/// The cells of seed points after at most three Newton steps along the gradient; each cell once, along the Morton
/// curve. Seeds outside the lattice are ignored, several seeds in one cell count as one.
std::vector<Cell> cells_near_seeds(const CellLattice& lattice, LevelSampler& sampler, const PointsRef<3>& seeds);

/// Cells at the sign changes found by a scan of the whole lattice: of every corner if the longest side has at most
/// 266 cells, else of every s-th corner along each axis with the smallest s that leaves at most 266 steps.
std::vector<Cell> cells_by_scan(const CellLattice& lattice, LevelSampler& sampler, const Progress& progress);

}  // namespace csrbf::polygonization
