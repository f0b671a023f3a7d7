#pragma once

#include "csrbf/core/field.hpp"
#include "csrbf/core/progress.hpp"

#include <memory>
#include <optional>
#include <vector>

namespace csrbf {

template <int Dim>
class LevelSum;

/// How a level finds its coefficients.
enum class LevelSolve {
  interpolation,  ///< interpolates the residual at the centres, which are samples; one support for all of them
  ridge,          ///< least squares over all samples with the penalty lambda |c|^2
  native          ///< least squares with the penalty lambda c^T A c, with A the kernel matrix of the centres
};

/// What one level did. Errors are those of the sum of all levels so far, at the samples; merged duplicates count once.
struct LevelReport {
  Index centers = 0;  ///< those whose coefficients are 0 are not kept in the model
  double smallest_support = 0;
  double largest_support = 0;
  double lambda0 = 0;    ///< regularisation; 0: interpolation
  double rmse = 0;       ///< weighted root mean square over samples and components
  double max_error = 0;  ///< largest error of a component at any sample
};

/// A model, with a report on its levels.
template <int Dim>
struct LevelFit {
  std::vector<std::shared_ptr<const LevelSum<Dim>>> fields;  ///< one per component
  std::vector<LevelReport> levels;
  Index merged_duplicates = 0;
  bool converged = true;  ///< whether the tolerance, if given, holds at every sample

  [[nodiscard]] const LevelReport& last() const { return levels.back(); }
  /// One field per component.
  [[nodiscard]] std::vector<std::shared_ptr<const Field<Dim>>> model() const;
};

}  // namespace csrbf
