#pragma once

#include "csrbf/core/types.hpp"

namespace csrbf::app {

/// Values that are known at points (3 x n), carried to other places (3 x m): the mean of the nearest few; NaN where the
/// points are further away than their own spacing lets expect.
Eigen::VectorXd values_near(const PointsRef<3>& points, const Eigen::VectorXd& values, const PointsRef<3>& places);

}  // namespace csrbf::app
