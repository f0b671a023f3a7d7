#pragma once

#include "csrbf/approx/unity/cover.hpp"
#include "csrbf/core/field.hpp"

#include <memory>
#include <vector>

namespace csrbf {

/// Fields that have a constant in every cell of a cover, with smooth steps between: `values` (fields x cells).
template <int Dim>
std::vector<std::shared_ptr<const Field<Dim>>> cell_constants(Cover<Dim> cover, const Eigen::MatrixXd& values);

}  // namespace csrbf
