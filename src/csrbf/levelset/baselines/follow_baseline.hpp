#pragma once

#include "csrbf/core/field.hpp"
#include "csrbf/core/grid.hpp"
#include "csrbf/levelset/regions/force_source.hpp"
#include "csrbf/levelset/segment_options.hpp"

#include <memory>

namespace csrbf {

/// What a method found that the variational one is compared with.
template <int Dim>
struct BaselineResult {
  std::shared_ptr<const Field<Dim>> field;
  std::vector<std::uint8_t> labels;
  int iterations = 0;
  bool converged = false;
  std::vector<double> energy;  ///< as in SegmentReport
};

/// Follows such a method, finite_difference or collocation, from `start`; the settings have values in place of
/// `automatic`.
template <int Dim>
BaselineResult<Dim> follow_baseline(const Grid& grid, const SegmentSettings& settings, const Progress& progress,
                                    ForceSource& source, const std::vector<std::uint8_t>& start);

}  // namespace csrbf
