#pragma once

#include <string_view>
#include <vector>

namespace csrbf {

struct FitOptions;

enum class FitMethod {
  interpolate,
  least_squares,
  partition_of_unity,
  multilevel,
  pca_multiresolution,
  fixed_budget,
  error_bounded,
  moving_least_squares,
  along_tracks,
};

/// A method of fit(): its name, and which of FitOptions it uses besides those that all do.
struct FitMethodInfo {
  FitMethod method;
  const char* name;
  const char* what;       ///< in a few words, with its source
  bool centers;           ///< FitOptions::centers
  bool tolerance;         ///< FitOptions::tolerance
  bool degree;            ///< FitOptions::degree
  bool smoothing;         ///< FitOptions::smoothing
  bool kernel_parameter;  ///< FitOptions::kernel_parameter
  bool keeps_duplicates;  ///< bounds the error at each of several samples at one place; the others take their mean
};

/// All methods, in the order of FitMethod.
const std::vector<FitMethodInfo>& fit_method_table();

const FitMethodInfo& info_of(FitMethod method);

/// The method of that name; null: none, as for "auto".
const FitMethodInfo* find_fit_method(std::string_view name);

/// Throws InvalidInput for options that make no sense in so many dimensions, but for those of a sphere or a drift.
void check_options(const FitOptions& options, int dimension);

}  // namespace csrbf
