#pragma once

#include "bindings.hpp"

#include "csrbf/approx/fit.hpp"

namespace csrbf::python {

/// Options by name; missing ones keep their defaults.
FitOptions fit_options(const py::dict& given);

py::dict to_dict(const FitReport& report);

}  // namespace csrbf::python
