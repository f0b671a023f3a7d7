#include "evaluation_places.hpp"
#include "verbs.hpp"

#include "csrbf/io/model.hpp"
#include "csrbf/io/read_file.hpp"
#include "csrbf/io/samples.hpp"
#include "csrbf/io/vti.hpp"

#include <algorithm>
#include <limits>

namespace csrbf::app {
namespace {

struct Wanted {
  bool gradient = false;
  bool hessian = false;
  bool standard_deviation = false;

  [[nodiscard]] Derivatives derivatives() const {
    if (hessian) return Derivatives::hessian;
    return gradient ? Derivatives::gradient : Derivatives::none;
  }
};

// value, then value_x value_y, then value_x_x value_x_y value_y_y, then value_standard_deviation, for all components
// each.
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

constexpr Index slice = Index{1} << 20;

// Values at the nodes of a grid, some layers of its last axis at a time.
Eigen::MatrixXd evaluate_grid(const NamedFunction& model, const Places& places, const Progress& progress) {
  std::vector<Eigen::VectorXd> axes = places.axes;
  const Eigen::VectorXd last = axes.back();
  const Index layer = places.count / last.size(), layers = std::max<Index>(1, slice / layer);
  Eigen::MatrixXd answers(model.function.components(), places.count);
  for (Index begin = 0; begin < last.size(); begin += layers) {
    report(progress, "evaluate", static_cast<double>(begin) / static_cast<double>(last.size()));
    axes.back() = last.segment(begin, std::min(layers, last.size() - begin));
    answers.middleCols(layer * begin, layer * axes.back().size()) = model.function.evaluate_grid(axes).transpose();
  }
  return answers;
}

// Replaces the values by labels: one row.
void make_labels(Eigen::MatrixXd& answers) {
  Eigen::MatrixXd labels(1, answers.cols());
  for (Index i = 0; i < answers.cols(); ++i) {
    Index largest = 0;
    const double value = answers.col(i).maxCoeff(&largest);
    labels(0, i) = answers.rows() > 1 ? static_cast<double>(largest) : value > 0 ? 1 : 0;
  }
  answers = std::move(labels);
}

// columns x places: the memory of an image with the columns as components.
Eigen::MatrixXd evaluate_all(const NamedFunction& model, const Places& places, const Wanted& wanted, Index columns,
                             const Progress& progress) {
  const bool values_only = wanted.derivatives() == Derivatives::none && !wanted.standard_deviation;
  if (!places.axes.empty() && values_only) return evaluate_grid(model, places, progress);
  Eigen::MatrixXd answers(columns, places.count);
  for (Index begin = 0; begin < places.count; begin += slice) {
    report(progress, "evaluate", static_cast<double>(begin) / static_cast<double>(places.count));
    const Index n = std::min(slice, places.count - begin);
    const Eigen::MatrixXd points = places.points(begin, n);
    const Function::Values values = model.function.evaluate(points, wanted.derivatives());
    Index row = 0;
    const auto put = [&](const Eigen::MatrixXd& part) {
      answers.block(row, begin, part.cols(), n) = part.transpose();
      row += part.cols();
    };
    put(values.value);
    if (wanted.gradient) put(values.gradient);
    if (wanted.hessian) put(values.hessian);
    if (wanted.standard_deviation) put(model.function.standard_deviation(points));
  }
  return answers;
}

// The columns as arrays of VTK. Gradients are vectors, of three components in the plane too, as its programs expect.
std::vector<VtkArray> vtk_arrays(const NamedFunction& model, const Wanted& wanted, SampleType type,
                                 const std::vector<std::string>& columns, const Eigen::MatrixXd& answers) {
  const Index k = model.function.components(), d = model.function.dimension();
  std::vector<VtkArray> arrays;
  for (Index row = 0; row < answers.rows();) {
    const bool is_gradient = wanted.gradient && row >= k && row < k + k * d;
    const Index rows = is_gradient ? d : 1;
    Eigen::MatrixXd values = Eigen::MatrixXd::Zero(rows == 2 ? 3 : rows, answers.cols());
    values.topRows(rows) = answers.middleRows(row, rows);
    const std::string name = is_gradient ? model.value_names[static_cast<std::size_t>((row - k) / d)] + "_gradient"
                                         : columns[static_cast<std::size_t>(row)];
    arrays.push_back({name, type, values.rows(), vtk_bytes(type, values)});
    row += rows;
  }
  return arrays;
}

void write_answers(const std::string& path, const NamedFunction& model, const Places& places, const Wanted& wanted,
                   const std::vector<std::string>& columns, const Eigen::MatrixXd& answers) {
  if (file_extension(path) == ".vti") {
    write_vti(path, places.layout.grid, vtk_arrays(model, wanted, places.layout.type, columns, answers));
    return;
  }
  if (places.is_image) {
    VolumeLayout layout = places.layout;
    layout.components = answers.rows();
    write_places(path, layout, answers);
    return;
  }
  const bool has_coordinates = !path.ends_with(".npy");
  write_table(path, {.coordinate_names = has_coordinates ? model.coordinate_names : std::vector<std::string>{},
                     .value_names = columns,
                     .coordinates = has_coordinates ? places.points(0, places.count) : Eigen::MatrixXd(0, places.count),
                     .values = answers.transpose()});
}

void tell_values(const std::string& output, const Eigen::MatrixXd& values, const std::vector<std::string>& columns,
                 Session& session) {
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
                    {"min", any ? Json(lo) : Json(nullptr)},
                    {"max", any ? Json(hi) : Json(nullptr)}};
  if (undefined > 0)
    session.warn(counted(undefined, "point") + " without a value: coordinates are missing or beyond the samples");
  session.say(output + ": " + counted(values.cols(), "point") +
              (any ? ", values from " + rounded(lo) + " to " + rounded(hi) : ""));
}

}  // namespace

void run(const EvaluateCommand& command, Session& session) {
  check_places(command);
  if (command.labels && (command.gradient || command.hessian || command.standard_deviation))
    throw UsageError("--labels: labels have no derivatives or deviations; leave those flags out");
  session.expect_output(command.output);
  const NamedFunction model = session.timed("read", [&] { return read_function(command.input); });
  const Places places = session.timed("read", [&] { return make_places(command, model); });
  session.input = {
      {"file", command.input}, {"dimension", model.function.dimension()}, {"components", model.function.components()}};
  session.options = {{"output", command.output},
                     {"points", command.points.empty() ? Json(nullptr) : Json(command.points)},
                     {"like", command.like.empty() ? Json(nullptr) : Json(command.like)},
                     {"gradient", command.gradient},
                     {"hessian", command.hessian},
                     {"standard_deviation", command.standard_deviation},
                     {"labels", command.labels}};
  session.options.update(places.options);
  const Wanted wanted{command.gradient, command.hessian, command.standard_deviation};
  std::vector<std::string> columns = column_names(model, wanted);
  Eigen::MatrixXd answers = session.timed("evaluate", [&] {
    return evaluate_all(model, places, wanted, static_cast<Index>(columns.size()), session.progress());
  });
  if (command.labels) {
    make_labels(answers);
    columns = {"label"};
  }
  const Index values = command.labels ? 1 : model.function.components();
  tell_values(command.output, answers.topRows(values), columns, session);
  session.write([&] { write_answers(command.output, model, places, wanted, columns, answers); });
}

}  // namespace csrbf::app
