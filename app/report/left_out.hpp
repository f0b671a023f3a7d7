#pragma once

#include "report/page.hpp"

#include "csrbf/io/model.hpp"
#include "csrbf/io/samples.hpp"

namespace csrbf::app {

/// Leaves out every fifth sample, fits the others with the same settings and shows how well they predict those left
/// out. Only where one more fit is quick; else it adds nothing.
void add_left_out(const NamedFunction& model, const SampleTable& samples, const FitOptions& options, Page& page);

}  // namespace csrbf::app
