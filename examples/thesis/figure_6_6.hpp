#pragma once

#include "center_choices.hpp"
#include "surfaces.hpp"

namespace csrbf::thesis {

/// The errors of both contributions with the same budget of centres, chosen in one of the ways.
struct ChoiceErrors {
  CenterChoice choice;
  double centers = 0;
  MeasuredSurface composite = {};  ///< section 6.1
  MeasuredSurface medial = {};     ///< section 6.2
};

std::vector<ChoiceErrors> choice_errors(const PointCloud& cloud, const std::vector<Index>& budgets);

/// Figs. 6.6 and 6.7.
Figure figure_6_6();

}  // namespace csrbf::thesis
