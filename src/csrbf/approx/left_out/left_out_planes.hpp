#pragma once

#include "csrbf/approx/global/axis_covariance.hpp"
#include "csrbf/approx/samples/samples.hpp"

namespace csrbf {

/// sigma^2 of a covariance, one per component, by predictions of whole planes of a lattice from the samples that are
/// not in them. Where many samples share a coordinate, each is predicted well from those beside it in its plane, and
/// neither likelihood nor leave-one-out errors tell how wrong the function may be between planes. The largest mean over
/// the axes whose planes have four samples or more, and over gaps as wide as those between lines, tracks and clusters;
/// empty where there are none of these. Up to four planes of each axis and a dozen samples of each, from at most 200 of
/// the others.
template <int Dim>
Eigen::VectorXd variance_by_planes(const Samples<Dim>& samples, const AxisCovariance<Dim>& covariance);

}  // namespace csrbf
