#pragma once

#include "csrbf/core/field.hpp"
#include "csrbf/levelset/segment.hpp"
#include "csrbf/levelset/variational.hpp"

#include <memory>

namespace csrbf {

template <int Dim>
struct BaselineResult {
  std::vector<std::uint8_t> labels;
  std::shared_ptr<const Field<Dim>> field;
  SegmentReport report;  ///< iterations, converged, energy
};

/// segment() by SegmentMethod::collocation or finite_difference, from labels whose 1 is inside, with the forces of two
/// regions estimated anew in each iteration.
template <int Dim>
BaselineResult<Dim> segment_by_baseline(const Grid& grid, const ForceSource& source, const SegmentOptions& options,
                                        double center_spacing, const std::vector<std::uint8_t>& labels);

}  // namespace csrbf
