#pragma once

#include "csrbf/approx/fit.hpp"

#include <variant>

namespace csrbf {

#define CSRBF_ALTERNATIVE(Dim) Fit<Dim>,
using FunctionFitVariant = std::variant<CSRBF_FOR_MANY_DIMS(CSRBF_ALTERNATIVE) std::monostate>;
#undef CSRBF_ALTERNATIVE

/// What a Function holds: a fit of any dimension.
struct FunctionFit : FunctionFitVariant {
  using FunctionFitVariant::FunctionFitVariant;
};

}  // namespace csrbf
