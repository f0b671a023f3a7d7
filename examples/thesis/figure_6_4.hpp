#pragma once

#include "surfaces.hpp"

namespace csrbf::thesis {

/// Points with normals on the ridge and valley lines of the surface through a cloud.
PointCloud on_ridges(const PointCloud& cloud, int resolution, double least_turning);

/// Figs. 6.4 and 6.19.
Figure figure_6_4();

/// Figs. 6.18 and 6.20.
Figure figure_6_18();

}  // namespace csrbf::thesis
