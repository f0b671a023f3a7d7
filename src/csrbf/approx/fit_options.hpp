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
  /// With few samples trend or constant, whichever predicts the outermost samples from the others better. With many,
  /// linear for the usual distance between samples, then constant.
  automatic,
  constant,  ///< its value at the nearest point of the box: bounded and continuous
  nan,       ///< NaN
  linear,    ///< its value and slope at the nearest point of the box
  trend,     ///< returns to the trend of the samples (interpolate); other methods: as linear
};

/// auto, constant, nan, linear or trend, and back. Throws InvalidInput for other names.
std::string name_of(Extrapolation extrapolation);
Extrapolation extrapolation_of(const std::string& name);

struct FitOptions {
  /// auto, interpolate, least-squares, partition-of-unity, multilevel, pca-multiresolution, fixed-budget,
  /// error-bounded, moving-least-squares or along-tracks (moving least squares whose weights follow tracks).
  ///
  /// auto: with a tolerance, partition-of-unity of as many samples as it takes, or error-bounded if that does not meet
  /// it; with a budget of centres, fixed-budget. Otherwise few samples are fitted by interpolate with a covariance
  /// learned from them, and many by partition-of-unity, unless one system or along-tracks predicts left-out samples
  /// better.
  std::string method = "auto";
  /// A name of kernels/kernel.hpp, or auto.
  std::string kernel = "auto";
  /// For kernels that have one and the method interpolate; NaN: the default of the kernel.
  double kernel_parameter = std::numeric_limits<double>::quiet_NaN();
  /// Budget of centres: for multilevel that of the last level, for error-bounded that of the first; 0: the method
  /// decides. The warnings of the report name options that a method does not use.
  Index centers = 0;
  /// Largest error allowed at any sample, in the unit of the values; 0: no limit. A loose one saves time and memory.
  double tolerance = 0;
  /// 0: interpolate; larger: smoother; unset: chosen by cross-validation.
  std::optional<double> smoothing = {};
  /// Degree of the polynomial part; unset: chosen.
  std::optional<int> degree = {};
  /// Period of every axis, 0 for none (longitude: 360); empty: no axis is periodic.
  std::vector<double> periods = {};
  /// The axes of longitude and latitude in degrees; empty: none. Distances are then measured on the sphere, and neither
  /// the poles nor the meridian where longitudes jump matter. Longitudes may be any numbers, latitudes lie within -90
  /// and 90. Up to five axes in all. Gradients are per degree of longitude and latitude.
  std::vector<int> sphere = {};
  /// Covariates, axes that enter linearly (universal kriging): f(x, z) = g(x) + beta z, such as elevation for
  /// temperatures, with a function g of the other axes. beta is estimated by generalised least squares. Covariates are
  /// needed wherever f is evaluated.
  std::vector<int> drift = {};
  /// N x (k Dim), value by value: derivatives at the samples, used as data (Hermite); NaN: unknown. Empty: none.
  Eigen::MatrixXd gradients = {};
  /// Polylines in the plane (2 x vertices each) across which the function may jump: samples behind a fault do not
  /// count. For two coordinates.
  std::vector<Eigen::Matrix2Xd> faults = {};
  Extrapolation extrapolation = Extrapolation::automatic;
  /// auto: samples far from their neighbours (gross errors) are left out and reported; squares: every sample counts;
  /// huber, student: samples count less the farther they are (Huber 1964; Lange et al. 1989). With a tolerance, or
  /// smoothing 0, auto keeps all.
  std::string loss = "auto";
  /// none, sqrt, log: fits the values, their square roots or their logarithms, and transforms the result back to the
  /// mean. auto transforms non-negative amounts that vary more where they are larger, if that is much likelier (Box and
  /// Cox 1964; 30 to 20,000 unweighted samples of up to three coordinates, all other options automatic). Values must
  /// not be negative for sqrt, and be positive for log; weights belong to the transformed values. Not with a tolerance,
  /// a drift, derivatives or tiles.
  std::string transform = "auto";
  /// The value, such as -9999, that marks missing ones: such samples are left out.
  std::optional<double> missing = {};
  /// Whether methods without standard deviations get them from a second fit, by auto, at its time and memory. They
  /// include the difference of the two fits.
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

/// Details of a fit by a partition of unity.
struct PartitionReport {
  Index patches = 0;
  Index samples_per_patch = 0;
  double anisotropy = 0;  ///< of the distances in patches, see LocalOptions
};

/// What a fit did: the options used, given or chosen, and its errors.
struct FitReport {
  std::string method, kernel;
  Index samples = 0;                ///< used
  Index samples_fitted = 0;         ///< of these; with a tolerance the others meet it, too
  Index merged_duplicates = 0;      ///< samples merged with others at the same point
  Index missing = 0;                ///< samples left out because of FitOptions::missing
  std::vector<Index> gross_errors;  ///< samples left out or given less than half their weight, numbered from 0
  std::vector<Index> suspects;      ///< if samples are few: those far from their neighbours that were kept
  Index centers = 0;                ///< number of radial functions
  Index levels = 1;
  int degree = -1;
  /// Support of the radial functions, the largest if they differ, in the unit of the scaled points; 0: one per patch.
  double support = 0;
  double smoothing = 0;
  double rmse = 0, max_error = 0;  ///< at the samples used
  double cross_validation_rmse = std::numeric_limits<double>::quiet_NaN();
  std::optional<PartitionReport> partition = {};
  std::vector<double> axis_scales;  ///< numbers that the coordinates were divided by
  /// Unit vectors of the axes along which coordinates were scaled, one for each scale; empty: the axes of the
  /// coordinates.
  std::vector<std::vector<double>> axes;
  std::vector<std::string> value_kernels;  ///< of each value, if fitted on its own; `kernel` is that of the first
  std::vector<int> sphere, drift_axes;     ///< FitOptions::sphere and drift
  /// Coefficients of the drift, per unit of its covariates, component by component; and their standard deviations.
  std::vector<double> drift, drift_deviations;
  /// Standard deviation of the noise of a sample of mean weight, for each component; if values were transformed, so
  /// that it grows with the value, the root mean square over the samples. Empty: unknown.
  std::vector<double> noise;
  std::vector<std::string> transforms;  ///< none, sqrt or log, of each value; empty: none of them
  std::vector<std::string> warnings;
  double choose_seconds = 0, fit_seconds = 0;  ///< times of this run; not stored in models
};

/// A function fitted to samples, with one field per component of their values.
template <int Dim>
struct Fit {
  std::vector<std::shared_ptr<const Field<Dim>>> components;
  /// Variances of the difference between a new sample of mean weight and each component: the error of the function plus
  /// the noise of the sample. With interpolate they are kriging variances: 0 at samples without noise, growing between
  /// them. With partition-of-unity they come from local leave-one-out errors and grow in gaps and outside the box of
  /// the samples; along-tracks has them, too. Empty with other methods and with interpolate for more than 4000 samples
  /// and a compact kernel, unless FitOptions::standard_deviation is set, and if the samples are too few to estimate
  /// them.
  std::vector<std::shared_ptr<const Field<Dim>>> variances = {};
  /// Variances of the error of the function alone, if the noise differs from place to place; else empty.
  std::vector<std::shared_ptr<const Field<Dim>>> function_variances = {};
  double variance_unit = 1;  ///< variances are in its square, so that they stay finite for huge and tiny values
  FitReport report = {};
  /// Points of the samples, or some of them if the model is much smaller; null in older models.
  std::shared_ptr<const Points<Dim>> places = {};
};

}  // namespace csrbf
