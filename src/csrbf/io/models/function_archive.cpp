#include "csrbf/io/models/function_archive.hpp"

#include "csrbf/approx/function_fit.hpp"
#include "csrbf/approx/samples/many_variables.hpp"
#include "csrbf/core/error.hpp"
#include "csrbf/io/models/field_archive.hpp"
#include "csrbf/io/samples.hpp"

namespace csrbf {
namespace {

constexpr std::int64_t most_names = 1 << 20;  // a limit on damaged files

// Calls visit(name, member) for the numbers and names of a report.
template <class Report, class Partition, class Visit>
void for_each_member(Report& report, Partition& partition, const Visit& visit) {
  visit("method", report.method);
  visit("kernel", report.kernel);
  visit("samples", report.samples);
  visit("samples_fitted", report.samples_fitted);
  visit("merged_duplicates", report.merged_duplicates);
  visit("centers", report.centers);
  visit("levels", report.levels);
  visit("patches", partition.patches);
  visit("samples_per_patch", partition.samples_per_patch);
  visit("degree", report.degree);
  visit("support", report.support);
  visit("smoothing", report.smoothing);
  visit("rmse", report.rmse);
  visit("max_error", report.max_error);
  visit("cross_validation_rmse", report.cross_validation_rmse);
}

struct MemberReader {
  const Archive& archive;

  void operator()(const char* name, std::string& member) const { member = archive.text(name); }
  void operator()(const char* name, double& member) const { member = archive.number(name); }
  void operator()(const char* name, Index& member) const { member = archive.integer(name); }
  void operator()(const char* name, int& member) const {
    constexpr int most = std::numeric_limits<int>::max();
    member = static_cast<int>(archive.integer(name, -most, most));
  }
};

std::vector<int> axes_from(const Archive& archive, const std::string& name) {
  constexpr std::int32_t most = most_variables;
  const auto& axes = archive.array<std::int32_t>(name, -1, 1);
  for (const std::int32_t a : axes.reshaped())
    if (a < 0 || a >= most) archive.fail("an axis of " + name + " is damaged");
  return {axes.data(), axes.data() + axes.size()};
}

template <int Dim>
void set_components(Archive& archive, const Fit<Dim>& fit) {
  FieldWriter<Dim> writer;
  for (std::size_t i = 0; i < fit.components.size(); ++i)
    archive.set("component" + std::to_string(i), writer.field(*fit.components[i]));
  if (fit.places) archive.set("places", *fit.places);
  archive.set("variances", fit.variances.size());
  archive.set("variance_unit", fit.variance_unit);
  for (std::size_t i = 0; i < fit.variances.size(); ++i)
    archive.set("variance" + std::to_string(i), writer.field(*fit.variances[i]));
  if (!fit.function_variances.empty()) archive.set("function_variances", fit.function_variances.size());
  for (std::size_t i = 0; i < fit.function_variances.size(); ++i)
    archive.set("function_variance" + std::to_string(i), writer.field(*fit.function_variances[i]));
  writer.store_shared(archive);
}

template <int Dim>
Function make_function(const Archive& archive, int variables, std::int64_t components) {
  Fit<Dim> fit;
  FieldReader<Dim> reader(archive);
  for (std::int64_t i = 0; i < components; ++i)
    fit.components.push_back(reader.field(archive.part("component" + std::to_string(i))));
  const std::int64_t variances = archive.integer("variances", 0, components);
  for (std::int64_t i = 0; i < variances; ++i)
    fit.variances.push_back(reader.field(archive.part("variance" + std::to_string(i))));
  const bool has_own = archive.has("function_variances");  // where values are transformed
  for (std::int64_t i = 0; has_own && i < archive.integer("function_variances", variances, variances); ++i)
    fit.function_variances.push_back(reader.field(archive.part("function_variance" + std::to_string(i))));
  if (archive.has("variance_unit")) fit.variance_unit = archive.number("variance_unit");  // older models have none
  if (variances != 0 && variances != components) archive.fail("there is not one variance per component");
  fit.report = report_from(archive.part("report"));
  for (const std::vector<int>* axes : {&fit.report.sphere, &fit.report.drift_axes})
    for (const int a : *axes)
      if (a >= variables) archive.fail("an axis of the report is not one of the function");
  if (fit.report.sphere.size() != 0 && fit.report.sphere.size() != 2) archive.fail("the sphere is damaged");
  if (archive.has("places")) {
    const auto& places = archive.numbers("places", Dim, -1);
    if (places.cols() == 0) archive.fail("there are no places of samples");
    fit.places = std::make_shared<const Points<Dim>>(places);
  }
  if (!fit.report.noise.empty() && std::ssize(fit.report.noise) != components)
    archive.fail("there is not one noise per component");
  return Function(std::move(fit), variables);
}

// The function, whose dimension is known at run time only.
Function function_of(const Archive& archive, int variables, std::int64_t components) {
  switch (fitted_dimension(variables)) {
#define CSRBF_CASE(Dim) \
  case Dim:             \
    return make_function<Dim>(archive, variables, components);
    CSRBF_FOR_MANY_DIMS(CSRBF_CASE)
#undef CSRBF_CASE
    default:
      archive.fail("functions of " + std::to_string(variables) + " variables are not supported by this version");
  }
}

std::vector<std::string> names_or(std::vector<std::string> names, std::vector<std::string> defaults) {
  return names.empty() ? std::move(defaults) : std::move(names);
}

}  // namespace

void set_texts(Archive& archive, const std::string& name, const std::vector<std::string>& texts) {
  archive.set(name + "s", texts.size());
  for (std::size_t i = 0; i < texts.size(); ++i) archive.set(name + std::to_string(i), texts[i]);
}

std::vector<std::string> texts_of(const Archive& archive, const std::string& name) {
  std::vector<std::string> texts;
  for (std::int64_t i = 0, count = archive.integer(name + "s", 0, most_names); i < count; ++i)
    texts.push_back(archive.text(name + std::to_string(i)));
  return texts;
}

Archive report_to_archive(const FitReport& report) {
  Archive archive;
  archive.kind = "report";
  const PartitionReport partition = report.partition.value_or(PartitionReport{});
  for_each_member(report, partition, [&](const char* name, const auto& member) { archive.set(name, member); });
  archive.set("anisotropy", partition.anisotropy);
  archive.set("axis_scales", report.axis_scales);
  if (!report.axes.empty()) {
    std::vector<double> entries;
    for (const std::vector<double>& axis : report.axes) entries.insert(entries.end(), axis.begin(), axis.end());
    archive.set("axes", entries);
  }
  archive.set("missing", report.missing);
  archive.set("gross_errors", std::vector<double>(report.gross_errors.begin(), report.gross_errors.end()));
  archive.set("noise", report.noise);
  archive.set("sphere", std::vector<std::int32_t>(report.sphere.begin(), report.sphere.end()));
  archive.set("drift_axes", std::vector<std::int32_t>(report.drift_axes.begin(), report.drift_axes.end()));
  set_texts(archive, "value_kernel", report.value_kernels);
  if (!report.transforms.empty()) set_texts(archive, "transform", report.transforms);
  archive.set("drift", report.drift);
  archive.set("drift_deviations", report.drift_deviations);
  set_texts(archive, "warning", report.warnings);
  return archive;
}

FitReport report_from(const Archive& archive) {
  FitReport report;
  PartitionReport partition;
  for_each_member(report, partition, MemberReader{archive});
  if (archive.has("anisotropy")) partition.anisotropy = archive.number("anisotropy");  // older models have none
  if (partition.patches > 0) report.partition = partition;
  report.axis_scales = archive.column("axis_scales");
  if (archive.has("axes")) {
    const std::vector<double> entries = archive.column("axes");
    const auto dim = static_cast<std::ptrdiff_t>(report.axis_scales.size());
    if (dim == 0 || std::ssize(entries) % dim != 0) archive.fail("the axes are damaged");
    for (auto axis = entries.begin(); axis != entries.end(); axis += dim) report.axes.emplace_back(axis, axis + dim);
  }
  if (archive.has("gross_errors")) {  // older models have none of these
    report.missing = archive.integer("missing");
    for (const double row : archive.column("gross_errors")) {
      constexpr double most = 9007199254740992;  // 2^53: whole numbers up to there are exact
      if (!(row >= 0 && row <= most && row == std::floor(row)))
        archive.fail("a row of gross_errors is not a whole number");
      report.gross_errors.push_back(static_cast<Index>(row));
    }
    report.noise = archive.column("noise");
  }
  if (archive.has("drift")) {
    report.value_kernels = texts_of(archive, "value_kernel");
    report.sphere = axes_from(archive, "sphere");
    report.drift_axes = axes_from(archive, "drift_axes");
    report.drift = archive.column("drift");
    report.drift_deviations = archive.column("drift_deviations", std::ssize(report.drift));
  }
  if (archive.has("transforms")) report.transforms = texts_of(archive, "transform");  // where values are transformed
  report.warnings = texts_of(archive, "warning");
  return report;
}

Archive to_archive(const NamedFunction& named) {
  const Function& function = named.function;
  const auto fits = [](const auto& names, Index count) { return names.empty() || std::ssize(names) == count; };
  require(fits(named.coordinate_names, function.dimension()), "write_model", "coordinate_names",
          named.coordinate_names.size(), "there must be one per coordinate, or none");
  require(fits(named.value_names, function.components()), "write_model", "value_names", named.value_names.size(),
          "there must be one per component, or none");
  Archive archive;
  archive.kind = function_kind;
  archive.set("dimension", function.dimension());
  archive.set("components", function.components());
  set_texts(archive, "coordinate_name",
            names_or(named.coordinate_names, default_coordinate_names(function.dimension())));
  set_texts(archive, "value_name", names_or(named.value_names, default_value_names(function.components())));
  if (!named.crs.empty()) archive.set("crs", named.crs);
  archive.set("report", report_to_archive(function.report()));
  std::visit(
      [&](const auto& fit) {
        if constexpr (!std::is_same_v<std::decay_t<decltype(fit)>, std::monostate>) set_components(archive, fit);
      },
      function.any_fit());
  return archive;
}

NamedFunction function_from(const Archive& archive) {
  if (archive.kind != function_kind) archive.fail("this is a \"" + archive.kind + "\", not a fitted function");
  try {
    const std::int64_t components = archive.integer("components", 1, most_names);
    const auto variables = static_cast<int>(archive.integer("dimension", 1, most_names));
    NamedFunction named{function_of(archive, variables, components),
                        texts_of(archive, "coordinate_name"),
                        texts_of(archive, "value_name"),
                        {}};
    if (archive.has("crs")) named.crs = archive.text("crs");  // models without a map, and older ones, have none
    if (std::ssize(named.coordinate_names) != named.function.dimension() || std::ssize(named.value_names) != components)
      archive.fail("the names do not fit the function");
    return named;
  } catch (const InvalidInput& error) {
    archive.fail(std::string("the model is damaged: ") + error.what());
  }
}

}  // namespace csrbf
