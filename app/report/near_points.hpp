#pragma once

#include "csrbf/core/types.hpp"

namespace csrbf::app {

/// Values known at points (3 x n), transferred to other places (3 x m): the mean over the nearest few; NaN where the
/// points are much further away than their own spacing.
Eigen::VectorXd values_near(const PointsRef<3>& points, const Eigen::VectorXd& values, const PointsRef<3>& places);

}  // namespace csrbf::app
