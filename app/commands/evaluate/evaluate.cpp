#include "commands/evaluate/levels.hpp"
#include "report/image_page.hpp"

#include "csrbf/io/files/read_file.hpp"
#include "csrbf/io/models/tile_store.hpp"
#include "csrbf/io/samples.hpp"
#include "csrbf/io/volume.hpp"
#include "csrbf/io/vtk/formats.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace csrbf::app {
namespace {

struct Wanted {
  bool gradient = false;
  bool hessian = false;
  bool standard_deviation = false;
  DeviationOf deviation_of = DeviationOf::sample;

  [[nodiscard]] Derivatives derivatives() const {
    if (hessian) return Derivatives::hessian;
    return gradient ? Derivatives::gradient : Derivatives::none;
  }
};

// value, then value_x value_y, then value_x_x value_x_y value_y_y, then value_standard_deviation, each for all
// components.
std::vector<std::string> column_names(const NamedFunction& model, const Wanted& wanted) {
  std::vector<std::string> names = model.value_names;
  const std::vector<std::string>& axes = model.coordinate_names;
  if (wanted.gradient)
    for (const std::string& value : model.value_names)
      for (const std::string& axis : axes) names.push_back(value + "_" + axis);
  if (wanted.hessian)
    for (const std::string& value : model.value_names)
      for (std::size_t a = 0; a < axes.size(); ++a)
        for (std::size_t b = a; b < axes.size(); ++b) names.push_back(value + "_" + axes[a] + "_" + axes[b]);
  if (wanted.standard_deviation)
    for (const std::string& value : model.value_names) names.push_back(value + "_standard_deviation");
  return names;
}

template <class Scalar>
void make_labels(Volume<Scalar>& answers) {
  VolumeLayout layout = answers;
  layout.components = 1;
  Volume<Scalar> labels(layout);
  for (Index i = 0; i < layout.grid.voxels(); ++i) {
    Index largest = 0;
    const Scalar value = answers.frame().col(i).maxCoeff(&largest);
    labels.frame()(0, i) = answers.components > 1 ? static_cast<Scalar>(largest) : value > 0 ? 1 : 0;
  }
  answers = std::move(labels);
}

template <class Scalar>
void evaluate_columns(const NamedFunction& model, const Places& places, const Wanted& wanted, const Progress& progress,
                      Volume<Scalar>& answers) {
  // Places at a time, to bound the temporary memory; more where every slice reads the tiles of the model again. Chosen
  // by hand.
  const Index slice = Index{1} << (tile_places(model.function).empty() ? 20 : 23);
  for (Index begin = 0; begin < places.count; begin += slice) {
    report(progress, "evaluate", static_cast<double>(begin) / static_cast<double>(places.count));
    const Index n = std::min(slice, places.count - begin);
    const Eigen::MatrixXd points = places.points(begin, n);
    const Function::Values values = model.function.evaluate(points, wanted.derivatives());
    Index row = 0;
    const auto put = [&](const Eigen::MatrixXd& part) {
      answers.frame().block(row, begin, part.cols(), n) = part.transpose().template cast<Scalar>();
      row += part.cols();
    };
    put(values.value);
    if (wanted.gradient) put(values.gradient);
    if (wanted.hessian) put(values.hessian);
    if (wanted.standard_deviation) put(model.function.standard_deviation(points, wanted.deviation_of));
  }
}

// The last row becomes the first.
template <class Scalar>
void turn_rows(Volume<Scalar>& image) {
  const Index row = image.components * image.grid.size[0], rows = image.grid.size[1];
  for (Index y = 0; y < rows / 2; ++y)
    std::swap_ranges(image.values.begin() + y * row, image.values.begin() + (y + 1) * row,
                     image.values.begin() + (rows - 1 - y) * row);
}

// All columns at all places: an image with the columns as components.
template <class Scalar>
Volume<Scalar> evaluate_all(const NamedFunction& model, const Places& places, const Wanted& wanted, Index columns,
                            const Progress& progress) {
  VolumeLayout layout = places.layout;
  layout.components = columns;
  Volume<Scalar> answers(layout);
  const bool values_only = wanted.derivatives() == Derivatives::none && !wanted.standard_deviation;
  if (places.axes.empty() || !values_only) {
    evaluate_columns(model, places, wanted, progress, answers);
    return answers;
  }
  model.function.evaluate_grid(places.axes, answers.frame(), progress);
  if (places.rows_turn) turn_rows(answers);
  return answers;
}

// NaN where the mask wants no values.
template <class Scalar>
void mask_answers(const NamedFunction& model, const Places& places, const Mask& mask, Volume<Scalar>& answers) {
  constexpr Index slice = Index{1} << 20;
  for (Index begin = 0; begin < places.count; begin += slice) {
    const Index n = std::min(slice, places.count - begin);
    const std::vector<bool> covered = model.function.covered(places.points(begin, n), mask);
    for (Index i = 0; i < n; ++i)
      if (!covered[static_cast<std::size_t>(i)])
        answers.frame().col(begin + i).setConstant(std::numeric_limits<Scalar>::quiet_NaN());
  }
}

// The columns as VTK arrays. Gradients are vectors, with three components even in 2D, as VTK programs expect.
template <class Scalar>
std::vector<VtkArray> vtk_arrays(const NamedFunction& model, const Wanted& wanted,
                                 const std::vector<std::string>& columns, const Volume<Scalar>& answers) {
  const Index k = model.function.components(), d = model.function.dimension();
  std::vector<VtkArray> arrays;
  for (Index row = 0; row < answers.components;) {
    const bool is_gradient = wanted.gradient && row >= k && row < k + k * d;
    const Index rows = is_gradient ? d : 1;
    Eigen::MatrixXd values = Eigen::MatrixXd::Zero(rows == 2 ? 3 : rows, answers.grid.voxels());
    values.topRows(rows) = answers.frame().middleRows(row, rows).template cast<double>();
    const std::string name = is_gradient ? model.value_names[(row - k) / d] + "_gradient" : columns[row];
    arrays.push_back({name, answers.type, values.rows(), vtk_bytes(answers.type, values)});
    row += rows;
  }
  return arrays;
}

template <class Scalar>
void write_answers(const std::string& path, const NamedFunction& model, const Places& places, const Wanted& wanted,
                   const std::vector<std::string>& columns, const Volume<Scalar>& answers) {
  if (file_extension(path) == ".vti") {
    write_vti(path, answers.grid, vtk_arrays(model, wanted, columns, answers));
    return;
  }
  if (places.is_image) {
    write_volume(path, answers, columns);
    return;
  }
  const bool has_coordinates = !path.ends_with(".npy");
  write_table(path, {.coordinate_names = has_coordinates ? model.coordinate_names : std::vector<std::string>{},
                     .value_names = columns,
                     .coordinates = has_coordinates ? places.points(0, places.count) : Eigen::MatrixXd(0, places.count),
                     .values = answers.frame().transpose().template cast<double>(),
                     .crs = places.crs});
}

// Of the first `rows` columns.
template <class Scalar>
void report_values(const std::string& output, const Volume<Scalar>& answers, Index rows,
                   const std::vector<std::string>& columns, Session& session) {
  const auto values = answers.frame().topRows(rows);
  double lo = std::numeric_limits<double>::infinity(), hi = -lo;
  Index undefined = 0;
  for (Index i = 0; i < values.cols(); ++i) {
    bool defined = true;
    for (const double value : values.col(i)) {
      defined = defined && std::isfinite(value);
      if (!std::isfinite(value)) continue;
      lo = std::min(lo, value);
      hi = std::max(hi, value);
    }
    if (!defined) ++undefined;
  }
  const bool any = lo <= hi;
  session.result = {{"points", values.cols()},
                    {"columns", columns},
                    {"undefined", undefined},
                    {"min", or_null(any, lo)},
                    {"max", or_null(any, hi)}};
  if (undefined > 0)
    session.warn(counted(undefined, "point") +
                 " without a value: coordinates are missing, masked or outside the samples");
  session.say(output + ": " + counted(values.cols(), "point") +
              (any ? ", values from " + rounded_within(hi - lo, lo) + " to " + rounded_within(hi - lo, hi) : ""));
}

void warn_of_rounding(const NamedFunction& model, Session& session) {
  const Json& lo = session.result["min"];
  const Json& hi = session.result["max"];
  const double error = model.function.report().cross_validation_rmse;
  if (lo.is_null() || !std::isfinite(error)) return;
  const double largest = std::max(std::abs(lo.get<double>()), std::abs(hi.get<double>()));
  const double rounding = 0.5 * std::numeric_limits<float>::epsilon() * largest;
  if (rounding > error)
    session.warn((session.is_given("float32") ? "--float32" : "single precision") +
                 std::string(" rounds values by up to ") + rounded(rounding) +
                 ", more than the error of the function, about " + rounded(error) +
                 (session.is_given("float32") ? "; leave it out" : "; .nrrd and .nc hold double precision"));
}

std::vector<Fact> facts_of(const Json& result) {
  std::vector<Fact> facts = {{grouped(result["points"].get<Index>()), "places"}};
  if (!result["min"].is_number()) return facts;
  facts.push_back({readable(result["min"].get<double>()), "smallest value"});
  facts.push_back({readable(result["max"].get<double>()), "largest value"});
  return facts;
}

template <class Scalar>
void evaluate_as(const EvaluateCommand& command, const NamedFunction& model, const Places& places, Session& session) {
  const Wanted wanted{command.gradient, command.hessian, command.standard_deviation,
                      command.deviation_of == "function" ? DeviationOf::function : DeviationOf::sample};
  std::vector<std::string> columns = column_names(model, wanted);
  Volume<Scalar> answers = session.timed("evaluate", [&] {
    return evaluate_all<Scalar>(model, places, wanted, static_cast<Index>(columns.size()), session.progress());
  });
  if (command.labels) {
    make_labels(answers);
    columns = {"label"};
  }
  if (!command.mask.empty()) mask_answers(model, places, mask_of(command.mask), answers);
  report_values(command.output, answers, command.labels ? 1 : model.function.components(), columns, session);
  if (std::is_same_v<Scalar, float> && command.like.empty() && !command.labels) warn_of_rounding(model, session);
  session.add_to_page([&](Page& page) {
    page.facts = facts_of(session.result);
    show_values(answers.frame().row(0).template cast<double>(), places.axes, model.coordinate_names, columns.front(),
                page);
  });
  session.write([&] { write_answers(command.output, model, places, wanted, columns, answers); });
}

}  // namespace

void run(const EvaluateCommand& given, Session& session) {
  EvaluateCommand command = given;
  if (command.grid.empty() && session.is_given("grid")) command.grid = grid_without_numbers;
  if (command.levels.empty() && session.is_given("levels")) command.levels = about_ten_levels;
  if (command.levels.empty())
    check_places(command);
  else
    check_levels(command);
  if (command.labels && (command.gradient || command.hessian || command.standard_deviation))
    throw UsageError("--labels: labels have no derivatives or deviations; leave those flags out");
  session.expect_output(command.output);
  if (!command.mask.empty() && command.labels)
    throw UsageError("--mask: labels have no number for none; leave one of both out");
  if (!command.mask.empty()) (void)mask_of(command.mask);
  NamedFunction model = session.timed("read", [&] { return read_function(command.input); });
  if (!command.extrapolation.empty())
    model.function = model.function.extrapolated(extrapolation_of(command.extrapolation));
  const Places places = session.timed("read", [&] { return make_places(command, model, session); });
  session.input = {
      {"file", command.input}, {"dimension", model.function.dimension()}, {"components", model.function.components()}};
  session.options = {{"output", command.output},
                     {"points", or_null(command.points)},
                     {"like", or_null(command.like)},
                     {"gradient", command.gradient},
                     {"hessian", command.hessian},
                     {"standard_deviation", command.standard_deviation},
                     {"deviation_of", command.deviation_of},
                     {"labels", command.labels},
                     {"mask", or_null(command.mask)},
                     {"extrapolation", or_null(command.extrapolation)},
                     {"levels", or_null(command.levels)},
                     {"float32", command.float32}};
  session.options.update(places.options);
  try {
    if (!command.levels.empty()) return write_levels(command, model, places, session);
    if (places.is_image && places.layout.type == SampleType::float32)
      evaluate_as<float>(command, model, places, session);
    else
      evaluate_as<double>(command, model, places, session);
  } catch (const std::bad_alloc&) {
    if (!command.points.empty()) throw;
    throw SolverFailure("not enough memory for " + counted(places.count, "node") + ", " +
                        size_text(places.layout.grid) +
                        (command.like.empty() ? "; give a larger --cell, fewer nodes or a smaller --extent" : ""));
  }
}

}  // namespace csrbf::app
