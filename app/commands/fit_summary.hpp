#pragma once

#include "commands/commands.hpp"

#include "csrbf/approx/fit.hpp"

namespace csrbf::app {

/// The options that the flags ask for. Throws UsageError.
FitOptions make_fit_options(const FitFlags& flags, Session& session);

/// Adds the options used, including those chosen automatically, and result, times and warnings of the fit to the
/// report.
void add_fit_report(const FitFlags& flags, const FitReport& report, Session& session);

/// Adds the method and the errors to the summary.
void say_fit(const FitReport& report, Session& session);

}  // namespace csrbf::app
