#pragma once

#include "report/page.hpp"

#include "csrbf/core/grid.hpp"
#include "csrbf/core/image.hpp"

#include <map>

namespace csrbf::app {

/// An image before and after its holes were filled; `missing`: not 0 where there was one.
void show_filled(const Volume<double>& before, const Volume<double>& after, const std::vector<unsigned char>& missing,
                 Page& page);

/// Where two label images agree and differ, on the slices where they differ most.
void show_agreement(const Volume<float>& a, const Volume<float>& b, Page& page);

/// Values on a grid of one or two axes, with segments (pairs of ends) over a map, or the histogram of any others; the
/// first row of `values`.
void show_values(const Eigen::Ref<const Eigen::RowVectorXd>& values, const std::vector<Eigen::VectorXd>& axes,
                 const std::vector<std::string>& axis_names, const std::string& value_name, Page& page,
                 const Points<2>& segments = Points<2>(2, 0));

/// What was measured of a region in each frame.
struct TrackedMeasure {
  int label = 1;
  std::vector<double> sizes;  ///< volumes, or areas
};

/// Sizes of regions over time, and frames, by their numbers, with their contours: one at a time with a slider.
void show_track(const std::vector<TrackedMeasure>& measures, const std::string& size_name,
                const std::map<Index, RgbImage>& frames, Page& page);

}  // namespace csrbf::app
