#pragma once

#include "csrbf/core/field.hpp"
#include "csrbf/core/grid.hpp"
#include "csrbf/core/progress.hpp"
#include "csrbf/levelset/regions/force_source.hpp"

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace csrbf {

struct CollocationBaselineOptions {
  std::string kernel = "wendland-c2";
  double support = 4;         ///< radius in center spacings
  double center_spacing = 2;  ///< in voxels of the shortest edge
  bool local = false;         ///< delta so narrow that only the contour moves
  int iterations = 100;       ///< at most
  Progress progress = {};     ///< stage "evolve"
};

struct FiniteDifferenceBaselineOptions {
  double smoothness = 0;   ///< weight of the length of the contour
  int iterations = 100;    ///< at most ten times as many, of half a voxel each
  Progress progress = {};  ///< stage "evolve"
};

template <int Dim>
struct BaselineResult {
  std::vector<std::uint8_t> labels;
  std::shared_ptr<const Field<Dim>> field;
  int iterations = 0;
  bool converged = false;
  std::vector<double> energy;  ///< as in SegmentReport
};

/// segment() by the methods that it is compared with, from labels whose 1 is inside, with the forces of two regions
/// estimated anew in each iteration.
template <int Dim>
BaselineResult<Dim> segment_by_collocation(const Grid& grid, ForceSource& source,
                                           const CollocationBaselineOptions& options,
                                           const std::vector<std::uint8_t>& labels);
template <int Dim>
BaselineResult<Dim> segment_by_finite_difference(const Grid& grid, ForceSource& source,
                                                 const FiniteDifferenceBaselineOptions& options,
                                                 const std::vector<std::uint8_t>& labels);

}  // namespace csrbf
