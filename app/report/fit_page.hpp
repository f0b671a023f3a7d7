#pragma once

#include "report/page.hpp"

#include "csrbf/io/model.hpp"
#include "csrbf/io/samples.hpp"

namespace csrbf::app {

/// The function, and its errors at the samples.
void show(const NamedFunction& model, const SampleTable& samples, Page& page);

}  // namespace csrbf::app
