#include "commands/fit_summary.hpp"
#include "report/fit_page.hpp"

#include <utility>

namespace csrbf::app {
namespace {

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
  if (samples.dropped > 0)
    session.warn(counted(samples.dropped, "row") + " without a finite number in every column left out");
}

}  // namespace

void run(const FitCommand& command, Session& session) {
  FitOptions options = make_fit_options(command.fit, session);
  session.expect_output("--output", command.output, ".csrbf", "models");
  if (command.resume) session.resume(command.input, command.output);
  SampleTable samples = session.timed("read", [&] {
    return read_samples(command.input, {command.coordinates, command.values, command.weights});
  });
  options.periods = parse_periods(command.periods, samples);
  options.missing = command.missing;
  report_input(command.input, samples, session);

  NamedFunction model{fit_function(samples.coordinates, samples.values, samples.weights, options),
                      std::move(samples.coordinate_names), std::move(samples.value_names)};
  const FitReport& report = model.function.report();
  session.options = {{"output", command.output},
                     {"coordinates", model.coordinate_names},
                     {"values", model.value_names},
                     {"weights", or_null(command.weights)},
                     {"missing", or_null(command.missing)},
                     {"periods", or_null(!options.periods.empty(), options.periods)}};
  session.result = {{"dimension", model.function.dimension()}, {"components", model.function.components()}};
  add_fit_report(command.fit, report, session);
  session.say(command.output + ": function of " + counted(model.function.dimension(), "variable") + " from " +
              counted(report.samples, "sample") +
              (report.merged_duplicates > 0 ? ", " + counted(report.merged_duplicates, "duplicate") + " merged" : ""));
  session.result["missing"] = report.missing;
  say_fit(report, session);
  session.add_to_page([&](Page& page) { show(model, samples, options, page); });
  session.write([&] { write_model(command.output, model); });
}

}  // namespace csrbf::app
