#pragma once

#include "csrbf/approx/fit_options.hpp"
#include "csrbf/approx/samples/samples.hpp"

#include <optional>
#include <vector>

namespace csrbf {

/// Which of the samples given are fitted, and how much they count.
template <int Dim>
struct SelectedSamples {
  std::optional<Samples<Dim>> samples = {};  ///< unset: all, as they are given
  Index missing = 0;
  std::vector<Index> gross_errors = {}, suspects = {};  ///< rows of those given, see RobustWeights
};

/// Leaves out samples whose value is options.missing, and gross errors or what the loss makes of them; none where the
/// options say that all are to be met.
template <int Dim>
SelectedSamples<Dim> select_samples(const Samples<Dim>& given, const FitOptions& options);

}  // namespace csrbf
