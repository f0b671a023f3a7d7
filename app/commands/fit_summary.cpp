#include "commands/fit_summary.hpp"

#include "csrbf/core/joined.hpp"

namespace csrbf::app {
namespace {

// From 1, as in a file.
std::vector<Index> rows_of(std::vector<Index> samples) {
  for (Index& row : samples) ++row;
  return samples;
}

}  // namespace

FitOptions make_fit_options(const FitFlags& flags, Session& session) {
  FitOptions options;
  options.method = flags.method;
  options.kernel = flags.kernel;
  if (flags.kernel_parameter) options.kernel_parameter = *flags.kernel_parameter;
  options.centers = flags.centers;
  options.tolerance = flags.tolerance;
  options.smoothing = parse_smoothing(flags.smoothing);
  if (options.smoothing && !(*options.smoothing >= 0))
    throw UsageError("--smoothing " + flags.smoothing + ": must not be negative");
  options.degree = flags.degree;
  options.loss = flags.loss;
  options.transform = flags.transform;
  options.extrapolation = extrapolation_of(flags.extrapolation);
  options.progress = session.progress();
  return options;
}

void add_fit_report(const FitFlags& flags, const FitReport& r, Session& session) {
  session.add_time("prepare", r.choose_seconds);
  session.add_time("fit", r.fit_seconds);
  session.warn(r.warnings);
  session.options.update({{"method", r.method},
                          {"kernel", or_null(r.kernel)},
                          {"kernel_parameter", or_null(flags.kernel_parameter)},
                          {"centers", or_null(flags.centers > 0, flags.centers)},
                          {"tolerance", or_null(flags.tolerance > 0, flags.tolerance)},
                          {"smoothing", r.smoothing},
                          {"degree", or_null(r.degree >= 0, r.degree)},
                          {"loss", flags.loss},
                          {"transform", flags.transform},
                          {"extrapolation", flags.extrapolation}});
  const PartitionReport partition = r.partition.value_or(PartitionReport{});
  session.result.update({{"samples", r.samples},
                         {"samples_fitted", r.samples_fitted},
                         {"merged_duplicates", r.merged_duplicates},
                         {"gross_errors", rows_of(r.gross_errors)},
                         {"suspects", rows_of(r.suspects)},
                         {"method", r.method},
                         {"kernel", or_null(r.kernel)},
                         {"value_kernels", r.value_kernels},
                         {"transforms", r.transforms},
                         {"centers", r.centers},
                         {"levels", r.levels},
                         {"patches", partition.patches},
                         {"samples_per_patch", partition.samples_per_patch},
                         {"degree", r.degree},
                         {"support", r.support},
                         {"axis_scales", r.axis_scales},
                         {"axes", r.axes},
                         {"noise", r.noise},
                         {"anisotropy", partition.anisotropy},
                         {"smoothing", r.smoothing},
                         {"rmse", r.rmse},
                         {"max_error", r.max_error},
                         {"cross_validation_rmse", r.cross_validation_rmse}});
}

void say_fit(const FitReport& r, Session& session) {
  std::string method = r.method + ": ";
  if (r.centers > 0)
    method += counted(r.centers, "center") + (r.kernel.empty() ? "" : " of " + r.kernel);
  else
    method += "polynomials of degree " + std::to_string(r.degree);
  if (r.partition) method += " in " + counted(r.partition->patches, "patch");
  if (r.levels > 1) method += " on " + counted(r.levels, "level");
  session.say("method: " + method + ", smoothing " + rounded(r.smoothing, 3));
  if (!r.transforms.empty()) session.say("fitted on the scale: " + joined(r.transforms));
  std::string errors = "error at the samples: rms " + rounded(r.rmse, 3) + ", largest " + rounded(r.max_error, 3);
  if (std::isfinite(r.cross_validation_rmse))
    errors += "; of samples left out: rms " + rounded(r.cross_validation_rmse, 3);
  session.say(errors);
}

}  // namespace csrbf::app
