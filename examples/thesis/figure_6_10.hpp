#pragma once

#include "surfaces.hpp"

namespace csrbf::thesis {

/// Support sizes of furthest points as the thesis finds them, in diagonals of the cloud: distances to the own pole
/// (6.21) and to the nearest pole of all (6.22).
struct SupportSizes {
  Points<3> centers;
  Eigen::VectorXd own, nearest;
};

SupportSizes support_sizes(const PointCloud& cloud, Index centers);

/// Figs. 6.10 to 6.13.
Figure figure_6_10();

}  // namespace csrbf::thesis
