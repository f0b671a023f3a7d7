#include "model.hpp"
#include "options.hpp"

#include "csrbf/io/models/function_archive.hpp"
#include "csrbf/io/models/surface_archive.hpp"

#include <emscripten.h>

namespace csrbf::wasm {
namespace {

// NaN, which JSON has not, as null.
Json or_null(double value) {
  return std::isfinite(value) ? Json(value) : Json();
}

Json to_json(const FitReport& r) {
  const PartitionReport partition = r.partition.value_or(PartitionReport{});
  return {{"method", r.method},
          {"kernel", r.kernel},
          {"samples", r.samples},
          {"samplesFitted", r.samples_fitted},
          {"mergedDuplicates", r.merged_duplicates},
          {"missing", r.missing},
          {"grossErrors", r.gross_errors},
          {"suspects", r.suspects},
          {"centers", r.centers},
          {"levels", r.levels},
          {"patches", partition.patches},
          {"degree", r.degree},
          {"smoothing", or_null(r.smoothing)},
          {"rmse", or_null(r.rmse)},
          {"maxError", or_null(r.max_error)},
          {"crossValidationRmse", or_null(r.cross_validation_rmse)},
          {"axisScales", r.axis_scales},
          {"axes", r.axes},
          {"drift", r.drift},
          {"driftDeviations", r.drift_deviations},
          {"noise", r.noise},
          {"chooseSeconds", r.choose_seconds},
          {"fitSeconds", r.fit_seconds},
          {"warnings", r.warnings}};
}

FitOptions read_fit_options(Options& given) {
  FitOptions options{.progress = progress()};
  given.read("method", options.method);
  given.read("kernel", options.kernel);
  given.read("kernelParameter", options.kernel_parameter);
  given.read("centers", options.centers);
  given.read("tolerance", options.tolerance);
  given.read_smoothing(options.smoothing);
  given.read("degree", options.degree);
  given.read("loss", options.loss);
  given.read("transform", options.transform);
  given.read("extrapolation", options.extrapolation, extrapolation_of);
  given.read("periods", options.periods);
  given.read("sphere", options.sphere);
  given.read("drift", options.drift);
  given.read("missing", options.missing);
  given.read("scaleAxes", options.scale_axes);
  given.read("standardDeviation", options.standard_deviation);
  return options;
}

// The surface that a function is, if any.
std::shared_ptr<const Field<3>> surface_of(const Function& function) {
  if (function.dimension() != 3 || function.components() != 1) return nullptr;
  return function.fit<3>().components.front();
}

void fit_arrays(const double* points, int dimension, int count, const double* values, int components,
                const double* weights, const char* options, Answer& answer) {
  Options given(options, "fit");
  const FitOptions wanted = read_fit_options(given);
  given.expect_all_known();
  const Eigen::Map<const Eigen::MatrixXd> x(points, dimension, count), by_row(values, components, count);
  const Eigen::Map<const Eigen::VectorXd> w(weights, weights != nullptr ? count : 0);
  NamedFunction function{fit_function(x, by_row.transpose(), w, wanted)};
  answer.json["report"] = to_json(function.function.report());
  Model model{.surface = surface_of(function.function)};
  model.function = std::move(function);
  add_model(answer, std::move(model));
}

void expect_dimension(const Model& model, int dimension) {
  const int expected = model.function ? model.function->function.dimension() : 3;
  require(dimension == expected, "evaluate", "dimension", dimension,
          "the points must have " + std::to_string(expected) + " coordinates");
}

void evaluate_function(const Function& f, const Eigen::Ref<const Eigen::MatrixXd>& x, bool with_gradient,
                       Answer& answer) {
  const Index d = f.dimension(), k = f.components(), m = x.cols();
  const Function::Values found = f.evaluate(x, with_gradient ? Derivatives::gradient : Derivatives::none);
  if (!with_gradient) return answer.add("value", Eigen::MatrixXd(found.value.transpose()));
  Eigen::MatrixXd gradient(d * k, m);
  for (Index i = 0; i < m; ++i) gradient.col(i) = found.gradient.row(i).transpose();
  answer.add("gradient", std::move(gradient));
}

void evaluate_model(const Model& model, const Eigen::Map<const Eigen::MatrixXd>& x, bool with_gradient,
                    Answer& answer) {
  expect_dimension(model, static_cast<int>(x.rows()));
  if (model.function) return evaluate_function(model.function->function, x, with_gradient, answer);
  const Eigen::Map<const Points<3>> in_space(x.data(), 3, x.cols());
  Jet<3> jet = model.surface->evaluate(in_space, with_gradient ? Derivatives::gradient : Derivatives::none);
  if (with_gradient)
    answer.add("gradient", std::move(jet.gradient));
  else
    answer.add("value", std::move(jet.value));
}

void deviation(const Model& model, const Eigen::Map<const Eigen::MatrixXd>& x, const std::string& of, Answer& answer) {
  require(of == "sample" || of == "function", "standardDeviation", "of", of, "must be sample or function");
  if (!model.function) throw InvalidInput("standardDeviation: a surface has none");
  expect_dimension(model, static_cast<int>(x.rows()));
  const Eigen::MatrixXd found =
      model.function->function.standard_deviation(x, of == "sample" ? DeviationOf::sample : DeviationOf::function);
  answer.add("value", Eigen::MatrixXd(found.transpose()));
}

void to_bytes(const Model& model, Answer& answer) {
  const std::string bytes =
      format_archive(model.function ? to_archive(*model.function) : surface_to_archive(*model.surface));
  answer.add("bytes", std::vector<std::uint8_t>(bytes.begin(), bytes.end()));
}

void from_bytes(std::string_view bytes, Answer& answer) {
  const Archive archive = parse_archive(bytes, "model");
  Model model;
  if (archive.kind == function_kind) {
    model.function = function_from(archive);
    model.surface = surface_of(model.function->function);
    answer.json["report"] = to_json(model.function->function.report());
  } else {
    model.surface = surface_from(archive);
  }
  add_model(answer, std::move(model));
}

}  // namespace

void add_model(Answer& answer, Model model) {
  Json description = {{"dimension", 3}, {"components", 1}};
  Eigen::MatrixXd bounds(3, 2);
  if (model.function) {
    const Function& function = model.function->function;
    description = {{"dimension", function.dimension()}, {"components", function.components()}};
    bounds = function.bounds();
  } else {
    const Box<3> box = model.surface->bounds();
    bounds << box.lo, box.hi;
  }
  description["bounds"] = std::vector<double>(bounds.data(), bounds.data() + bounds.size());
  description["address"] = reinterpret_cast<std::uintptr_t>(new Model(std::move(model)));
  answer.json["model"] = std::move(description);
}

}  // namespace csrbf::wasm

extern "C" {

using csrbf::wasm::Answer;
using csrbf::wasm::Model;

// `points`: `dimension` numbers each; `values`: `components` numbers for each point; `weights`: null for none.
EMSCRIPTEN_KEEPALIVE Answer* csrbf_fit(const double* points, int dimension, int count, const double* values,
                                       int components, const double* weights, const char* options) {
  return csrbf::wasm::answer([&](Answer& answer) {
    csrbf::wasm::fit_arrays(points, dimension, count, values, components, weights, options, answer);
  });
}
EMSCRIPTEN_KEEPALIVE Answer* csrbf_evaluate(const Model* model, const double* points, int dimension, int count,
                                            int with_gradient) {
  return csrbf::wasm::answer([&](Answer& answer) {
    csrbf::wasm::evaluate_model(*model, {points, dimension, count}, with_gradient != 0, answer);
  });
}
EMSCRIPTEN_KEEPALIVE Answer* csrbf_deviation(const Model* model, const double* points, int dimension, int count,
                                             const char* of) {
  return csrbf::wasm::answer([&](Answer& answer) {
    csrbf::wasm::deviation(*model, {points, dimension, count}, of, answer);
  });
}
EMSCRIPTEN_KEEPALIVE Answer* csrbf_to_bytes(const Model* model) {
  return csrbf::wasm::answer([&](Answer& answer) { csrbf::wasm::to_bytes(*model, answer); });
}
EMSCRIPTEN_KEEPALIVE Answer* csrbf_from_bytes(const char* bytes, int count) {
  return csrbf::wasm::answer([&](Answer& answer) {
    csrbf::wasm::from_bytes({bytes, static_cast<std::size_t>(count)}, answer);
  });
}
EMSCRIPTEN_KEEPALIVE void csrbf_delete(const Model* model) {
  delete model;
}
}
