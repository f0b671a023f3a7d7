#include "commands/fit_summary.hpp"
#include "inputs/describe_table.hpp"
#include "inputs/tile_flags.hpp"
#include "report/fit_page.hpp"

#include "csrbf/approx/samples/robust_weights.hpp"
#include "csrbf/core/joined.hpp"
#include "csrbf/io/images/geotiff.hpp"
#include "csrbf/io/sample_columns.hpp"
#include "csrbf/tiles/fit_tiles.hpp"

#include <algorithm>

namespace csrbf::app {
namespace {

constexpr const char* column_remedy = "choose the columns with numbers: --coordinates, --values";

std::vector<double> parse_periods(const std::string& text, const SampleTable& samples) {
  if (text.empty()) return {};
  const Eigen::VectorXd periods = parse_list(text, ',', "--periods");
  if (periods.size() != samples.coordinates.rows() || !(periods.minCoeff() >= 0))
    throw UsageError("--periods " + text + ": expected " + std::to_string(samples.coordinates.rows()) +
                     " lengths, one per coordinate, 0 for those that are not periodic");
  return {periods.begin(), periods.end()};
}

void report_input(const std::string& path, const SampleTable& samples, Session& session) {
  session.input = {{"file", path},
                   {"samples", samples.coordinates.cols()},
                   {"coordinates", samples.coordinate_names},
                   {"values", samples.value_names},
                   {"weights", samples.weights.size() > 0},
                   {"dropped", samples.dropped}};
  if (!samples.crs.empty()) session.input["crs"] = samples.crs;
  if (samples.dropped > 0)
    session.warn(counted(samples.dropped, "row") + " without a finite number in every column left out");
  session.warn(column_warnings(samples));
}

// By their names or the reference system, and their range: plain numbers may be anything.
bool are_longitude_and_latitude(const SampleTable& samples) {
  const std::vector<std::string>& names = samples.coordinate_names;
  if (names.size() < 2) return false;
  const bool northward = is_latitude(names[0]) && is_longitude(names[1]);
  const bool are_named = northward || (is_longitude(names[0]) && is_latitude(names[1]));
  if (!are_named && !(names.size() == 2 && is_geographic(samples.crs).value_or(false))) return false;
  const auto range = [&](Index row, double lo, double hi) {
    return samples.coordinates.row(row).minCoeff() >= lo && samples.coordinates.row(row).maxCoeff() <= hi;
  };
  return range(northward ? 1 : 0, -180, 360) && range(northward ? 0 : 1, -90, 90);
}

void tell_columns(const SampleTable& samples, const std::string& weights, Session& session) {
  session.say("coordinates: " + joined(samples.coordinate_names) + "; " +
              (samples.value_names.size() > 1 ? "values: " : "value: ") + joined(samples.value_names) +
              (weights.empty() ? "" : "; weights: " + weights) +
              (samples.crs.empty() ? "" : "; on a map: " + short_crs(samples.crs)));
  if (!are_longitude_and_latitude(samples) || session.is_given("sphere") || session.is_given("periods")) return;
  session.warn("the coordinates are degrees of longitude and latitude, which the fit takes as lengths in a plane" +
               std::string(session.has_flag("sphere") ? "; --sphere fits on the sphere" : ""));
}

// The coefficients of the covariates, and that they are needed from now on.
void say_drift(const NamedFunction& model, const SampleTable& samples, Session& session) {
  const FitReport& report = model.function.report();
  const std::size_t q = samples.drift.size();
  session.result["drift"] = Json::array();
  std::string text;
  for (std::size_t k = 0; k < report.drift.size(); ++k) {
    const std::string& covariate = model.coordinate_names[static_cast<std::size_t>(samples.drift[k % q])];
    const std::string& value = model.value_names[k / q];
    session.result["drift"].push_back({{"value", value},
                                       {"covariate", covariate},
                                       {"coefficient", report.drift[k]},
                                       {"standard_deviation", report.drift_deviations[k]}});
    text += (k > 0 ? ", " : "") + value + " by " + covariate + " " + rounded(report.drift[k], 4) + " +- " +
            rounded(report.drift_deviations[k], 2);
  }
  session.say("drift: " + text + "; evaluate needs these columns too");
}

// What tiles do not do.
void expect_tile_flags(const FitCommand& command, const Session& session) {
  if (command.fit.centers > 0) refuse_in_tiles("--centers", "leave it out: each tile chooses its settings");
  if (!command.periods.empty()) refuse_in_tiles("--periods", "leave it out");
  if (!command.sphere.empty()) refuse_in_tiles("--sphere", "leave it out");
  if (!command.derivatives.empty()) refuse_in_tiles("--derivatives", "leave it out");
  if (!command.faults.empty()) refuse_in_tiles("--faults", "leave it out");
  if (!command.drift.empty()) refuse_in_tiles("--drift", "leave it out");
  if (!make_selection(command.points).is_all()) refuse_in_tiles("--class and --returns", "select the points first");
  expect_tile_files(command.input, command.output, session);
}

void run_in_tiles(const FitCommand& command, const FitOptions& fit, Session& session) {
  expect_tile_flags(command, session);
  FitTileOptions options;
  options.memory = tile_memory(command.tiles);
  options.tile_points = tile_points(command.tiles);
  options.folder = tile_folder(command.tiles, command.output);
  options.columns = {.coordinates = command.coordinates,
                     .values = command.values,
                     .weights = command.weights,
                     .remedy = column_remedy};
  options.fit = fit;
  options.fit.missing = command.missing;
  options.share = tile_share(command.tiles, session);
  options.warn = [&](const std::string& text) { session.warn(text); };
  const FitTileReport done = fit_tiles(command.input, command.output, options);
  session.input = {
      {"file", command.input},      {"samples", done.fit.samples},         {"coordinates", done.coordinate_names},
      {"values", done.value_names}, {"weights", !command.weights.empty()}, {"dropped", done.dropped}};
  session.options = {{"output", command.output},
                     {"coordinates", done.coordinate_names},
                     {"values", done.value_names},
                     {"weights", or_null(command.weights)},
                     {"missing", or_null(command.missing)}};
  add_tile_options(done.tile_points, options.share, options.folder, session);
  session.result = {{"dimension", done.coordinate_names.size()},
                    {"components", done.value_names.size()},
                    {"tiles", done.tiles},
                    {"tiles_continued", done.continued}};
  add_fit_report(command.fit, done.fit, session);
  if (done.dropped > 0) session.warn(counted(done.dropped, "row") + " without numbers, or a value, left out");
  session.say(command.output + ": function of " + counted(std::ssize(done.coordinate_names), "variable") + " from " +
              counted(done.fit.samples, "sample") + " in " + counted(done.tiles, "tile"));
  session.say("coordinates: " + joined(done.coordinate_names) +
              (done.value_names.size() > 1 ? "; values: " : "; value: ") + joined(done.value_names));
  say_fit(done.fit, session);
  check_tile_memory(command.tiles, session);
}

// The samples that have values, for the pictures.
SampleTable without_missing(SampleTable samples, double missing) {
  std::vector<Index> kept;
  for (Index i = 0; i < samples.values.rows(); ++i)
    if ((samples.values.row(i).array() != missing).all()) kept.push_back(i);
  samples.coordinates = samples.coordinates(Eigen::all, kept).eval();
  samples.values = samples.values(kept, Eigen::all).eval();
  if (samples.weights.size() > 0) samples.weights = samples.weights(kept).eval();
  if (samples.gradients.size() > 0) samples.gradients = samples.gradients(kept, Eigen::all).eval();
  return samples;
}

}  // namespace

void run(const FitCommand& command, Session& session) {
  FitOptions options = make_fit_options(command.fit, session);
  options.standard_deviation = command.standard_deviation;
  session.expect_output("--output", command.output, ".csrbf", "models");
  if (works_in_tiles(command.tiles)) return run_in_tiles(command, options, session);
  const PointSelection selection = make_selection(command.points);
  SampleTable samples = session.timed("read", [&] {
    return read_samples(command.input, {command.coordinates, command.values, command.weights, command.sphere,
                                        command.derivatives, command.drift, selection, column_remedy});
  });
  options.periods = parse_periods(command.periods, samples);
  options.missing = command.missing;
  if (!command.faults.empty())
    options.faults = session.timed("read", [&] { return read_faults(command.faults, samples.coordinate_names); });
  options.gradients = samples.gradients;
  options.sphere = samples.sphere;
  options.drift = samples.drift;
  if (!command.sphere.empty() && options.sphere.size() != 2)
    throw UsageError("--sphere " + command.sphere + ": expected two columns, longitude and latitude");
  report_input(command.input, samples, session);

  NamedFunction model{fit_function(samples.coordinates, samples.values, samples.weights, options),
                      samples.coordinate_names, samples.value_names, samples.crs};
  FitReport report = model.function.report();
  if (!samples.rows.empty()) number_rows(samples.rows, report);
  session.options = {{"output", command.output},
                     {"coordinates", model.coordinate_names},
                     {"values", model.value_names},
                     {"weights", or_null(command.weights)},
                     {"missing", or_null(command.missing)},
                     {"periods", or_null(!options.periods.empty(), options.periods)},
                     {"sphere", or_null(command.sphere)},
                     {"derivatives", or_null(command.derivatives)},
                     {"faults", or_null(command.faults)},
                     {"drift", or_null(command.drift)},
                     {"class", or_null(command.points.classes)},
                     {"returns", command.points.returns}};
  session.result = {{"dimension", model.function.dimension()}, {"components", model.function.components()}};
  add_fit_report(command.fit, report, session);
  session.say(command.output + ": function of " + counted(model.function.dimension(), "variable") + " from " +
              counted(report.samples, "sample") +
              (report.merged_duplicates > 0 ? ", " + counted(report.merged_duplicates, "duplicate") + " merged" : ""));
  tell_columns(samples, command.weights, session);
  session.result["missing"] = report.missing;
  if (!report.drift.empty()) say_drift(model, samples, session);
  say_fit(report, session);
  session.add_to_page([&](Page& page) {
    if (command.missing) samples = without_missing(std::move(samples), *command.missing);
    show(model, samples, options, page);
  });
  session.write([&] { write_model(command.output, model); });
}

}  // namespace csrbf::app
