#pragma once

#include "csrbf/approx/left_out/left_out_gaps.hpp"

#include <Eigen/Core>

namespace csrbf {

/// Factor, one for each component and 1 at least, by which variances of a fit of few samples are too small: fifths of
/// them are left out in turn and predicted by a `fit` to the others that learns all of its covariance anew. A
/// likelihood that chooses lengths of few samples finds them more regular than they are. None (1) where a fit of the
/// others fails. `samples`: distinct points.
template <int Dim>
Eigen::VectorXd left_out_folds(const Samples<Dim>& samples,
                               const std::function<FittedParts<Dim>(const Samples<Dim>&)>& fit);

}  // namespace csrbf
