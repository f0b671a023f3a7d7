#pragma once

#include "csrbf/approx/fit_by_method.hpp"
#include "csrbf/approx/global/axis_covariance.hpp"

namespace csrbf {

/// What interpolate needs to know of a covariance, for points in units of its shortest length.
template <int Dim>
LearnedCovariance learned_covariance(const Samples<Dim>& samples, const Replicates& replicates,
                                     const AxisCovariance<Dim>& covariance);

/// The average of the fits by covariances that are all likely, in the coordinates of the samples. The report tells of
/// the first one. `growth`: of the variances, see left_out_folds(); empty: 1.
template <int Dim>
MethodFields<Dim> fit_by_covariances(const Samples<Dim>& samples, const Replicates& replicates,
                                     const FitOptions& options, const std::vector<AxisCovariance<Dim>>& likely,
                                     FitReport& report, const Eigen::VectorXd& growth = {});

/// The same of few samples, with variances that grow as left_out_folds() says if these are exact.
template <int Dim>
MethodFields<Dim> fit_few_by_covariances(const Samples<Dim>& samples, const Replicates& replicates,
                                         const FitOptions& options, const std::vector<AxisCovariance<Dim>>& likely,
                                         FitReport& report);

/// Where samples are too few to choose a covariance, nothing is known but that the function is like others: variances
/// become the mean squares of the errors of the fields if the covariances are right that are likely, of one length.
/// Up to Dim + 3 samples; of more it changes nothing.
template <int Dim>
void set_variances_of_few(const Samples<Dim>& samples, const Replicates& replicates, const FitOptions& options,
                          MethodFields<Dim>& fields);

/// The fit of one system for some of the samples, which are in units of the shortest length, and of patches for what
/// it leaves of all of them, where these predict that. In the plane and in space, unless samples lie on `lines`, gaps
/// are tried as by fill_gaps_by_covariance(), and patches alone hold there if they are clearly better; of gaps that
/// cannot be tried their variances hold.
template <int Dim>
MethodFields<Dim> fit_coarse_to_fine(const Samples<Dim>& samples, const std::vector<Index>& thinned, bool lines,
                                     const FitOptions& options, const LearnedCovariance& learned, FitReport& report);

/// In the gaps of patches between samples without noise, the fit of one system by a learned covariance in their place,
/// if these are smooth and samples left out of such gaps (left_out_gaps()) are not predicted twice as well by patches;
/// its variances are those that these samples ask for. Two systems of 1000 samples and one of 2000.
template <int Dim>
void fill_gaps_by_covariance(const Samples<Dim>& samples, const FitOptions& options, MethodFields<Dim>& fields);

}  // namespace csrbf
