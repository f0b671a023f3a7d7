#pragma once

#include "csrbf/approx/fit_method.hpp"
#include "csrbf/approx/fit_options.hpp"
#include "csrbf/approx/samples/merge_duplicates.hpp"
#include "csrbf/approx/unity/partition_of_unity.hpp"
#include "csrbf/kernels/kernel.hpp"

namespace csrbf {

/// Samples up to which one system for all of them is solved. In four and more dimensions a patch needs hundreds of
/// samples, and smooth functions are met better by orders of magnitude if none of them is out of reach.
constexpr Index few_samples(int dimension) {
  return dimension < 4 ? 500 : 1000;
}

/// The options of fit() that a partition of unity has as well.
PartitionOfUnityOptions partition_options(const FitOptions& options);

/// The method that fit() begins with.
FitMethod choose_method(const FitOptions& options, Index samples, int dimension);

/// What was learned from the samples before they were scaled by its lengths: see AxisCovariance.
struct LearnedCovariance {
  Kernel kernel;
  double support = 1;
  double nugget = 0;
  int degree = 0;
  Eigen::VectorXd sigma2 = {};  ///< by planes of a lattice, see variance_by_planes(); empty: no lattice
  Replicates replicates = {};   ///< the scatter of samples at the same points
  Eigen::VectorXd growth = {};  ///< of the variances, see left_out_folds()
};

/// A fit in scaled coordinates.
template <int Dim>
struct MethodFields {
  std::vector<std::shared_ptr<const Field<Dim>>> components;
  std::vector<std::shared_ptr<const Field<Dim>>> variances;  ///< see Fit
  FitMethod method;                                          ///< the one used
  std::vector<double> noise = {};                            ///< see FitReport
  std::shared_ptr<const Field<Dim>> outside_gaps = nullptr;  ///< of patches: see FilledGaps; null: no gaps
};

/// Fits by `method`, or by the one that it gives way to: auto tries a partition of unity for a tolerance, and weights
/// that follow tracks for rough values. `learned`: null, or for the method interpolate. Fills in what the report says
/// of the model.
template <int Dim>
MethodFields<Dim> fit_by_method(const Samples<Dim>& samples, const FitOptions& options, FitMethod method,
                                const LearnedCovariance* learned, FitReport& report);

}  // namespace csrbf
