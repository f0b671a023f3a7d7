#pragma once

#include "csrbf/core/field.hpp"
#include "csrbf/core/progress.hpp"
#include "csrbf/core/types.hpp"

#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace csrbf {

/// The value of a function outside the box of its samples.
enum class Extrapolation {
  /// trend or constant, whichever predicts left-out extremes of few samples better. Of many, linear as far outside the
  /// box as samples are usually apart, then constant.
  automatic,
  constant,  ///< its value at the nearest point of the box: bounded and continuous
  nan,       ///< NaN
  linear,    ///< its value and slope at the nearest point of the box
  trend,     ///< returns to the trend of the samples, as its covariance says; for interpolate, elsewhere as linear
};

/// auto, constant, nan, linear or trend, and back. Throws InvalidInput for other names.
std::string name_of(Extrapolation extrapolation);
Extrapolation extrapolation_of(const std::string& name);

struct FitOptions {
  /// auto, interpolate, least-squares, partition-of-unity, multilevel, pca-multiresolution, fixed-budget,
  /// error-bounded, moving-least-squares or along-tracks (moving least squares whose weights follow tracks). auto: for
  /// a tolerance partition-of-unity, of as many samples as it takes, or error-bounded where that does not meet it;
  /// fixed-budget for a budget of centres; interpolate with a kernel chosen by leave-one-out for few samples without
  /// noise; else partition-of-unity, or along-tracks where that predicts rough values on tracks better.
  std::string method = "auto";
  /// A name of kernels/kernel.hpp, or auto.
  std::string kernel = "auto";
  /// For kernels that have one and the method interpolate; NaN: the default of the kernel.
  double kernel_parameter = std::numeric_limits<double>::quiet_NaN();
  /// Budget of centres: for multilevel that of the last level, for error-bounded that of the first; 0: the method
  /// decides. Options that a method does not use are named in the warnings of the report.
  Index centers = 0;
  /// Largest error allowed at any sample, in the unit of the values; 0: no limit. A loose one saves time and memory.
  double tolerance = 0;
  /// 0: interpolate; larger: smoother; unset: chosen by cross-validation.
  std::optional<double> smoothing = {};
  /// Degree of the polynomial part; unset: chosen.
  std::optional<int> degree = {};
  /// Period of every axis, 0 for none (longitude: 360); empty: no axis is periodic.
  std::vector<double> periods = {};
  /// The axes of longitude and latitude, in degrees: distances are those on the sphere, so that neither the poles nor
  /// the meridian where longitudes jump matter. Longitudes may be any numbers, latitudes are from -90 to 90. Up to five
  /// axes in all. Gradients are per degree of longitude and latitude. Empty: none.
  std::vector<int> sphere = {};
  /// Axes that enter linearly (universal kriging, drift): f(x, z) = g(x) + beta z with covariates z, such as elevation
  /// for temperatures, and a function g of the other axes. beta is that of generalised least squares, for residuals
  /// whose covariance is estimated. Covariates are needed wherever f is evaluated.
  std::vector<int> drift = {};
  /// N x (k Dim), value by value: derivatives of the function at the samples, as data (Hermite); NaN: unknown. Empty:
  /// none.
  Eigen::MatrixXd gradients = {};
  /// Polylines in the plane (2 x vertices each) across which the function may jump: samples behind a fault do not
  /// count. For two coordinates.
  std::vector<Eigen::Matrix2Xd> faults = {};
  Extrapolation extrapolation = Extrapolation::automatic;
  /// auto: samples far from what those around them say (gross errors) are left out and reported; squares: none is;
  /// huber, student: all samples have less weight the farther they are (Huber 1964; Lange et al. 1989). auto keeps all
  /// where a tolerance, or smoothing 0, asks for them.
  std::string loss = "auto";
  /// auto, none, sqrt or log: values are fitted as they are, or as their square roots or logarithms, and transformed
  /// back to their mean. auto: where amounts that are not negative vary more where they are larger, so that one of
  /// these is much likelier (Box and Cox 1964; 30 to 20,000 samples of up to three coordinates, without weights, no
  /// other choice but auto). For sqrt, values must not be negative, for log positive; weights are those of the roots or
  /// logarithms. Not with a tolerance, a drift, derivatives or tiles.
  std::string transform = "auto";
  /// Samples with this value, such as -9999, have none and are left out.
  std::optional<double> missing = {};
  /// Whether methods that know no standard deviations get some: by a second fit, of the method auto, with as much time
  /// and memory as that takes. The deviation counts the difference of both.
  bool standard_deviation = false;
  /// Whether axes of different units may be scaled; false where all coordinates are lengths in one unit, as in images.
  bool scale_axes = true;
  Progress progress = {};
};

/// The names that FitOptions::loss accepts.
std::vector<std::string> fit_losses();

/// The names that FitOptions::transform accepts.
std::vector<std::string> fit_transforms();

/// The names that FitOptions::method accepts.
std::vector<std::string> fit_methods();

/// Of fits by a partition of unity.
struct PartitionReport {
  Index patches = 0;
  Index samples_per_patch = 0;
  double anisotropy = 0;  ///< of the metrics of patches, see LocalOptions
};

/// What a fit did: the options used, given or chosen, and its errors.
struct FitReport {
  std::string method, kernel;
  Index samples = 0;                ///< used
  Index samples_fitted = 0;         ///< of these; the others, if any, are within the tolerance nevertheless
  Index merged_duplicates = 0;      ///< samples that were merged with others at the same place
  Index missing = 0;                ///< samples left out because they had the value for none
  std::vector<Index> gross_errors;  ///< samples left out or given less than half their weight, by number from 0
  std::vector<Index> suspects;      ///< of few samples those that are far from the others around them, but kept
  Index centers = 0;                ///< radial functions
  Index levels = 1;
  int degree = -1;
  double support =
      0;  ///< of the (largest) radial functions, in the unit of the scaled points; 0: of each patch its own
  double smoothing = 0;
  double rmse = 0, max_error = 0;  ///< at the samples used
  double cross_validation_rmse = std::numeric_limits<double>::quiet_NaN();
  std::optional<PartitionReport> partition = {};
  std::vector<double> axis_scales;  ///< what the coordinates were divided by
  /// Unit vectors along which they were, first turned to them: one per axis scale; empty: the coordinates' own axes.
  std::vector<std::vector<double>> axes;
  std::vector<std::string>
      value_kernels;                    ///< of each value, where they were fitted on their own; `kernel` is the first
  std::vector<int> sphere, drift_axes;  ///< FitOptions::sphere and drift
  /// Of fits with a drift, per unit of its covariates: component by component, and their standard deviations.
  std::vector<double> drift, drift_deviations;
  /// Standard deviations of the noise of a sample of mean weight; of transformed values, where it grows with the value,
  /// the root mean square over the samples; empty: unknown.
  std::vector<double> noise;
  std::vector<std::string> transforms;  ///< none, sqrt or log, of each value; empty: none of any
  std::vector<std::string> warnings;
  double choose_seconds = 0, fit_seconds = 0;  ///< of this run: models do not keep them
};

/// A function fitted to samples: one field per component of their values.
template <int Dim>
struct Fit {
  std::vector<std::shared_ptr<const Field<Dim>>> components;
  /// Variance of the difference between a sample of mean weight and the component: the error of the function and the
  /// noise of the values together. For interpolate that of kriging (see KrigingVariance), 0 at samples without noise
  /// and growing between them; for partition-of-unity from local leave-one-out errors (see local_variance), outside the
  /// box growing with the distance as the values differ. Empty for the other methods and for interpolation of more than
  /// 4000 samples, but for FitOptions::standard_deviation, and where there are too few samples to estimate it.
  std::vector<std::shared_ptr<const Field<Dim>>> variances = {};
  /// The same without the noise, where that is not the same everywhere; else empty.
  std::vector<std::shared_ptr<const Field<Dim>>> function_variances = {};
  double variance_unit = 1;  ///< variances are in its square, which keeps those of huge and tiny values finite
  FitReport report = {};
  /// The samples' points, or some of them where the model is much smaller; null in older models.
  std::shared_ptr<const Points<Dim>> places = {};
};

}  // namespace csrbf
