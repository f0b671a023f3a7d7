#pragma once

#include "csrbf/approx/samples/samples.hpp"
#include "csrbf/spatial/morton_order.hpp"
#include "csrbf/spatial/usual_extent.hpp"

#include <vector>

namespace csrbf {

/// Samples, the extents and the center of their points, and an order of these along a curve.
struct SpreadSamples {
  SampleView samples;
  Eigen::VectorXd extents, center;
  std::vector<Index> order;

  template <int Dim>
  explicit SpreadSamples(const Samples<Dim>& of)
      : samples(of),
        extents(usual_extent<Dim>(of.points)),
        center(bounding_box<Dim>(of.points).center()),
        order(morton_order<Dim>(of.points)) {}
};

}  // namespace csrbf
