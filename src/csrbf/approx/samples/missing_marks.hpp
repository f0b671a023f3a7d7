#pragma once

#include "csrbf/core/types.hpp"

#include <optional>

namespace csrbf {

/// Whether it is a usual mark of what is missing, such as -9999.
bool is_usual_mark(double value);

/// A value that files have where there is none, such as -9999: of several samples, or a usual one, and farther from all
/// others than three times their range. `known`: one that is not meant.
std::optional<double> value_beyond_all_others(const Eigen::Ref<const Eigen::VectorXd>& values,
                                              std::optional<double> known = {});

}  // namespace csrbf
