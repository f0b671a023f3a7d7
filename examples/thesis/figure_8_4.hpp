#pragma once

#include "csrbf/core/field.hpp"
#include "figure.hpp"
#include "level_sets.hpp"

namespace csrbf::thesis {

/// The shape of Fig. 8.2 at 30 dB, iteration by iteration.
struct Evolution {
  std::vector<double> coefficient_changes;  ///< largest, in pixels
  std::vector<double> energy;               ///< sum of (I - C1)^2 inside and (I - C2)^2 outside, before each iteration
  std::vector<std::uint8_t> labels;
  std::shared_ptr<const Field<2>> field;
  double support = 0;   ///< pixels
  double largest = 0;   ///< |f| at the nodes
  double steepest = 0;  ///< |grad f| on the contour
};

/// `iterations` of the collocation with the wide delta of the thesis, under a bound or none; converged or not.
Evolution evolution(LevelSetBound bound, int iterations);

/// Figs. 8.4 and 8.5.
Figure figure_8_4();

}  // namespace csrbf::thesis
