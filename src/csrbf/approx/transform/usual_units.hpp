#pragma once

#include "csrbf/approx/fit_options.hpp"

namespace csrbf {

/// A power of two by which numbers have a usual size; 1 if they have one.
double unit_of(double largest);

/// The report of a fit of samples divided by these units of coordinates (one per axis) and values, in those of the
/// samples themselves.
void in_units(const Eigen::VectorXd& coordinates, double values, FitReport& report);

/// Options for samples divided by both units.
FitOptions in_units(FitOptions options, double unit, double values);

}  // namespace csrbf
