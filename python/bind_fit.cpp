#include "fit_options.hpp"

#include "csrbf/approx/function.hpp"
#include "csrbf/approx/samples/robust_weights.hpp"
#include "csrbf/implicit/contour_lines.hpp"
#include "csrbf/io/model.hpp"
#include "csrbf/io/models/function_archive.hpp"
#include "csrbf/io/models/tile_store.hpp"
#include "csrbf/tiles/fit_tiles.hpp"

#include <memory>
#include <optional>

namespace csrbf::python {
namespace {

std::unique_ptr<NamedFunction> fit_arrays(const Array& points, const Array& values, const std::optional<Array>& weights,
                                          const std::optional<Array>& gradients, const py::dict& given,
                                          const py::object& listener) {
  FitOptions options = fit_options(given);
  if (given.contains("faults"))
    for (const py::handle& line : given["faults"]) {
      const auto vertices = line.cast<Array>();
      options.faults.emplace_back(columns(vertices, "faults"));
    }
  if (gradients) options.gradients = columns(*gradients, "derivatives").transpose();
  const auto x = columns(points, "points");
  const auto by_row = columns(values, "values");
  const auto w = weights ? vector(*weights, "weights") : Eigen::Map<const Eigen::VectorXd>(nullptr, 0);
  return run(listener, [&](const Progress& progress) {
    options.progress = progress;
    if (by_row.rows() == 1)  // the same memory as a column
      return std::make_unique<NamedFunction>(NamedFunction{
          fit_function(x, Eigen::Map<const Eigen::MatrixXd>(by_row.data(), by_row.cols(), 1), w, options)});
    return std::make_unique<NamedFunction>(NamedFunction{fit_function(x, by_row.transpose(), w, options)});
  });
}

// Row-major output arrays: (m, k), (m, k, d), (m, k, d, d).
struct Output {
  double* value = nullptr;
  double* gradient = nullptr;
  double* hessian = nullptr;
};

void fill(const Function::Values& from, Index d, Index first, const Output& to) {
  const Index k = from.value.cols();
  for (Index i = 0; i < from.value.rows(); ++i) {
    const Index row = first + i;
    for (Index c = 0; c < k; ++c) {
      to.value[k * row + c] = from.value(i, c);
      for (Index a = 0; to.gradient != nullptr && a < d; ++a)
        to.gradient[d * (k * row + c) + a] = from.gradient(i, d * c + a);
      if (to.hessian == nullptr) continue;
      double* matrix = to.hessian + d * d * (k * row + c);
      for (Index a = 0, entry = c * d * (d + 1) / 2; a < d; ++a)
        for (Index b = a; b < d; ++b, ++entry) matrix[d * a + b] = matrix[d * b + a] = from.hessian(i, entry);
    }
  }
}

py::tuple evaluate(const NamedFunction& f, const Array& at, int order) {
  const auto x = columns(at, "x");
  const Index d = f.function.dimension();
  const Index k = f.function.components();
  const Index m = x.cols();
  require(x.rows() == d, "evaluate", "x", x.rows(), "the points must have " + std::to_string(d) + " coordinates");
  const auto derivatives = static_cast<Derivatives>(std::clamp(order, 0, 2));
  py::array_t<double> value({m, k});
  py::array_t<double> gradient({order > 0 ? m : 0, k, d});
  py::array_t<double> hessian({order > 1 ? m : 0, k, d, d});
  const Output out{value.mutable_data(), order > 0 ? gradient.mutable_data() : nullptr,
                   order > 1 ? hessian.mutable_data() : nullptr};
  run([&](const Progress& progress) {
    in_parts(m, progress, [&](Index begin, Index count) {
      fill(f.function.evaluate(x.middleCols(begin, count), derivatives), d, begin, out);
    });
  });
  return py::make_tuple(value, gradient, hessian);
}

template <class Scalar>
py::array_t<Scalar> evaluate_grid(const NamedFunction& f, const std::vector<Array>& given) {
  std::vector<Eigen::VectorXd> axes;
  for (const Array& axis : given) axes.emplace_back(vector(axis, "axes"));
  Index nodes = 1;
  for (const Eigen::VectorXd& axis : axes) nodes *= axis.size();
  py::array_t<Scalar> values({nodes, f.function.components()});
  const Eigen::Map<Eigen::MatrixX<Scalar>> out(values.mutable_data(), f.function.components(), nodes);
  run([&](const Progress& progress) { f.function.evaluate_grid(axes, out, progress); });
  return values;
}

py::array_t<double> standard_deviation(const NamedFunction& f, const Array& at, const std::string& of) {
  require(of == "sample" || of == "function", "standard_deviation", "of", of, "must be sample or function");
  const DeviationOf what = of == "sample" ? DeviationOf::sample : DeviationOf::function;
  const auto x = columns(at, "x");
  py::array_t<double> result({x.cols(), f.function.components()});
  double* const out = result.mutable_data();
  run([&](const Progress& progress) {
    in_parts(x.cols(), progress, [&](Index begin, Index count) {
      const Eigen::MatrixXd part = f.function.standard_deviation(x.middleCols(begin, count), what).transpose();
      std::copy_n(part.data(), part.size(), out + part.rows() * begin);
    });
  });
  return result;
}

py::array_t<bool> covered(const NamedFunction& f, const Array& at, const std::string& mask) {
  const auto x = columns(at, "x");
  const Mask wanted = mask_of(mask);
  const std::vector<bool> found = run([&](const Progress& /*progress*/) { return f.function.covered(x, wanted); });
  py::array_t<bool> result(x.cols());
  std::copy(found.begin(), found.end(), result.mutable_data());
  return result;
}

py::list level_lines_of(const NamedFunction& f, const std::vector<double>& levels, double step, int resolution,
                        const std::string& mask) {
  require(f.function.dimension() == 2 && f.function.components() == 1, "level_lines", "values over variables",
          std::to_string(f.function.components()) + " over " + std::to_string(f.function.dimension()),
          "must be one over two");
  LevelLinesOptions options{.levels = levels, .step = step, .resolution = resolution};
  if (!mask.empty())
    options.wanted = [&](const PointsRef<2>& points) { return f.function.covered(points, mask_of(mask)); };
  const std::vector<LevelLine> lines = run([&](const Progress& progress) {
    options.progress = progress;
    return level_lines(*f.function.fit<2>().components.front(), options);
  });
  py::list result;
  for (const LevelLine& line : lines) {
    const Index n = line.points.cols();
    py::array_t<double> points({n + (line.closed ? 1 : 0), Index{2}});
    std::copy_n(line.points.data(), 2 * n, points.mutable_data());
    if (line.closed) std::copy_n(line.points.data(), 2, points.mutable_data() + 2 * n);
    result.append(py::make_tuple(line.level, points));
  }
  return result;
}

std::unique_ptr<NamedFunction> extrapolated(const NamedFunction& f, const std::string& extrapolation) {
  NamedFunction result = f;
  result.function = f.function.extrapolated(extrapolation_of(extrapolation));
  return std::make_unique<NamedFunction>(std::move(result));
}

py::bytes to_bytes(const NamedFunction& f) {
  return py::bytes(run([&](const Progress& /*progress*/) {
    require(tile_places(f.function).empty(), "pickle", "function", "in tiles", "pass on the name of its file instead");
    return format_archive(to_archive(f));
  }));
}

std::unique_ptr<NamedFunction> from_bytes(const std::string& bytes) {
  return run([&](const Progress& /*progress*/) {
    return std::make_unique<NamedFunction>(function_from(parse_archive(bytes, "pickle")));
  });
}

py::dict fit_in_tiles(const std::string& samples, const std::string& model, const std::string& folder, Index rank,
                      Index count, const std::vector<std::string>& columns, const py::dict& given,
                      const py::object& listener) {
  FitTileOptions options;
  read_entry(given, "tile_points", options.tile_points);
  read_entry(given, "memory", options.memory);
  options.folder = folder;
  options.columns = {.coordinates = columns.at(0), .values = columns.at(1), .weights = columns.at(2)};
  options.fit = fit_options(given);
  options.share = {rank, count};
  const FitTileReport report = run(listener, [&](const Progress& progress) {
    options.fit.progress = progress;
    return fit_tiles(samples, model, options);
  });
  py::dict result = to_dict(report.fit);
  result["tiles"] = report.tiles;
  result["tile_points"] = report.tile_points;
  result["tiles_continued"] = report.continued;
  result["dropped"] = report.dropped;
  result["coordinate_names"] = report.coordinate_names;
  result["value_names"] = report.value_names;
  return result;
}

}  // namespace

FitOptions fit_options(const py::dict& given) {
  FitOptions options;
  read_entry(given, "method", options.method);
  read_entry(given, "kernel", options.kernel);
  read_entry(given, "kernel_parameter", options.kernel_parameter);
  read_entry(given, "centers", options.centers);
  read_entry(given, "tolerance", options.tolerance);
  read_entry(given, "smoothing", options.smoothing);
  read_entry(given, "degree", options.degree);
  read_entry(given, "periods", options.periods);
  read_entry(given, "sphere", options.sphere);
  read_entry(given, "drift", options.drift);
  read_entry(given, "scale_axes", options.scale_axes);
  read_entry(given, "loss", options.loss);
  read_entry(given, "transform", options.transform);
  read_entry(given, "missing", options.missing);
  read_entry(given, "standard_deviation", options.standard_deviation);
  options.extrapolation = extrapolation_of(word_or(given, "extrapolation", "auto"));
  return options;
}

py::dict to_dict(const FitReport& r) {
  using namespace py::literals;
  const PartitionReport partition = r.partition.value_or(PartitionReport{});
  return py::dict(
      "method"_a = r.method, "kernel"_a = r.kernel, "samples"_a = r.samples, "samples_fitted"_a = r.samples_fitted,
      "merged_duplicates"_a = r.merged_duplicates, "centers"_a = r.centers, "levels"_a = r.levels,
      "patches"_a = partition.patches, "samples_per_patch"_a = partition.samples_per_patch, "degree"_a = r.degree,
      "support"_a = r.support, "anisotropy"_a = partition.anisotropy, "smoothing"_a = r.smoothing, "rmse"_a = r.rmse,
      "max_error"_a = r.max_error, "cross_validation_rmse"_a = r.cross_validation_rmse, "axis_scales"_a = r.axis_scales,
      "axes"_a = r.axes, "missing"_a = r.missing, "gross_errors"_a = r.gross_errors, "suspects"_a = r.suspects,
      "noise"_a = r.noise, "value_kernels"_a = r.value_kernels, "transforms"_a = r.transforms, "drift"_a = r.drift,
      "drift_axes"_a = r.drift_axes, "drift_deviations"_a = r.drift_deviations, "choose_seconds"_a = r.choose_seconds,
      "fit_seconds"_a = r.fit_seconds, "warnings"_a = r.warnings);
}

void bind_fit(py::module_& m) {
  py::class_<NamedFunction>(m, "Function")
      .def_property_readonly("dimension", [](const NamedFunction& f) { return f.function.dimension(); })
      .def_property_readonly("components", [](const NamedFunction& f) { return f.function.components(); })
      .def_property_readonly("report", [](const NamedFunction& f) { return to_dict(f.function.report()); })
      .def("report_of_rows",  // of samples that are these rows of a table
           [](const NamedFunction& f, const std::vector<Index>& rows) {
             FitReport report = f.function.report();
             number_rows(rows, report);
             return to_dict(report);
           })
      .def_property_readonly("bounds",
                             [](const NamedFunction& f) { return to_array(Eigen::MatrixXd(f.function.bounds())); })
      .def_property_readonly("sphere", [](const NamedFunction& f) { return f.function.report().sphere; })
      .def_readwrite("coordinate_names", &NamedFunction::coordinate_names)
      .def_readwrite("value_names", &NamedFunction::value_names)
      .def("evaluate", &evaluate)
      .def("evaluate_grid", &evaluate_grid<double>)
      .def("evaluate_grid_float32", &evaluate_grid<float>)
      .def("standard_deviation", &standard_deviation)
      .def("covered", &covered)
      .def("level_lines", &level_lines_of)
      .def("extrapolated", &extrapolated)
      .def("save", [](const NamedFunction& f,
                      const std::string& path) { run([&](const Progress& /*progress*/) { write_model(path, f); }); })
      .def("to_bytes", &to_bytes)
      .def_static("from_bytes", &from_bytes);
  m.def("fit", &fit_arrays);
  m.def("fit_tiles", &fit_in_tiles);
  m.def("is_function_file", [](const std::string& path) {
    return run([&](const Progress& /*progress*/) { return read_archive(path).kind == function_kind; });
  });
  m.def("read_function", [](const std::string& path) {
    return run([&](const Progress& /*progress*/) { return std::make_unique<NamedFunction>(read_function(path)); });
  });
}

}  // namespace csrbf::python
