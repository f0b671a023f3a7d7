#pragma once

#include <string>

namespace csrbf {

/// The scale on which values are fitted: z = v, sqrt(v) or log(v) (Box and Cox 1964). Amounts that cannot be negative,
/// such as concentrations or rain, vary more where there is much, and evenly on one of the other scales.
enum class Transform { none, square_root, logarithm };

/// none, sqrt or log.
std::string name_of(Transform transform);

/// z of a value.
double transformed(Transform transform, double value);

/// The logarithm of dz/dv, up to a constant.
double log_slope(Transform transform, double value);

/// The mean of values whose z has this mean and this standard deviation (the noise), and its derivatives by z. Where
/// roots are fitted, a smooth function below 0 is so by an overshoot: values end at the least there is.
struct MeanValue {
  double value, slope, bend;
};
MeanValue mean_value(Transform transform, double z, double noise);

/// The mean squared difference of values to mean_value(z, noise), where z has this mean and this variance.
double squared_error(Transform transform, double z, double variance, double noise);

/// The standard deviation of the noise of a value where z is `z`.
double noise_of_value(Transform transform, double z, double noise);

}  // namespace csrbf
