#pragma once

#include "figure.hpp"
#include "slice.hpp"

#include <vector>

namespace csrbf::thesis {

/// fixed_budget of a slice with budgets in shares of the number of samples.
struct BudgetErrors {
  double share = 0;
  double centers = 0;
  SliceErrors errors = {};
  double seconds = 0;
  Eigen::VectorXd reconstructed = {};
};

std::vector<BudgetErrors> budget_errors(const SampledSlice& sampled, const std::vector<double>& shares);

/// Figs. 3.14 and 3.15.
Figure figure_3_14();

}  // namespace csrbf::thesis
