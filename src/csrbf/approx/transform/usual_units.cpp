#include "csrbf/approx/transform/usual_units.hpp"

#include <cmath>

namespace csrbf {

double unit_of(double largest) {
  constexpr double usual = 1e100;  // products of several neither overflow nor vanish
  if (!std::isfinite(largest) || largest == 0 || (largest <= usual && largest >= 1 / usual)) return 1;
  return std::ldexp(1.0, std::ilogb(largest));
}

void in_units(const Eigen::VectorXd& coordinates, double values, FitReport& report) {
  for (std::size_t a = 0; a < report.axis_scales.size(); ++a)
    report.axis_scales[a] *= coordinates[static_cast<Index>(a)];
  for (auto* list : {&report.noise, &report.drift, &report.drift_deviations})
    for (double& value : *list) value *= values;
  for (double* error : {&report.rmse, &report.max_error, &report.cross_validation_rmse}) *error *= values;
}

FitOptions in_units(FitOptions options, double unit, double values) {
  for (double& period : options.periods) period /= unit;
  options.gradients = options.gradients / values * unit;
  for (Eigen::Matrix2Xd& line : options.faults) line /= unit;
  options.tolerance /= values;
  if (options.missing) *options.missing /= values;
  return options;
}

}  // namespace csrbf
