#pragma once

#include "report/page.hpp"

#include "csrbf/io/model.hpp"
#include "csrbf/io/samples.hpp"

namespace csrbf::app {

/// The function, its errors at the samples and, where one more fit is quick, at samples left out of it. `options`:
/// those that it was fitted with.
void show(const NamedFunction& model, const SampleTable& samples, const FitOptions& options, Page& page);

}  // namespace csrbf::app
