#pragma once

#include "csrbf/approx/fit_method.hpp"
#include "csrbf/approx/fit_options.hpp"
#include "csrbf/approx/samples/samples.hpp"
#include "csrbf/core/field.hpp"

#include <memory>
#include <vector>

namespace csrbf {

inline constexpr const char* tolerance_missed = "the tolerance does not hold at every sample";

/// Fits by a method that adds up levels of centres, or has one: least_squares, multilevel, pca_multiresolution,
/// fixed_budget or error_bounded. One field per component. Fills in what the report says of the model.
template <int Dim>
std::vector<std::shared_ptr<const Field<Dim>>> fit_in_levels(const Samples<Dim>& samples, const FitOptions& options,
                                                             FitMethod method, FitReport& report);

}  // namespace csrbf
