#include "csrbf/approx/function.hpp"

#include "csrbf/approx/fit_method.hpp"
#include "csrbf/approx/function_fit.hpp"
#include "csrbf/approx/outside/extrapolate.hpp"
#include "csrbf/approx/samples/many_variables.hpp"
#include "csrbf/approx/samples/sphere_field.hpp"
#include "csrbf/core/numbers/number_text.hpp"
#include "csrbf/core/parallel.hpp"
#include "csrbf/spatial/convex_hull.hpp"
#include "csrbf/spatial/kd_tree.hpp"

#include <cmath>
#include <numbers>
#include <type_traits>

namespace csrbf {
namespace {

const std::string dimensions_text = "must be 1 to " + std::to_string(most_variables) + "; choose fewer coordinates";

// Calls use(fit) with the fit held.
template <class Use>
auto visit_fit(const FunctionFit& fits, const Use& use) {
  using Result = decltype(use(std::get<0>(fits)));
  return std::visit(
      [&](const auto& fit) -> Result {
        if constexpr (std::is_same_v<std::decay_t<decltype(fit)>, std::monostate>) {
          throw InvalidInput("Function: empty");
        } else {
          return use(fit);
        }
      },
      fits);
}

void require_variables(const Eigen::Ref<const Eigen::MatrixXd>& x, int variables) {
  require(x.rows() == variables, "evaluate", "dimension of the points", x.rows(),
          "must be " + std::to_string(variables) + ", that of the function");
}

// The points x as they are in memory, or in many variables with zeros for those that there are not.
template <int Dim>
auto points_of(const Eigen::Ref<const Eigen::MatrixXd>& x) {
  if constexpr (Dim > largest_dimension)
    return with_zeros<Dim>(x);
  else
    return Eigen::Map<const Points<Dim>, 0, Eigen::OuterStride<>>(x.data(), Dim, x.cols(),
                                                                  Eigen::OuterStride<>(x.outerStride()));
}

template <int Dim>
Eigen::MatrixXd deviation(const Fit<Dim>& fit, const Eigen::Ref<const Eigen::MatrixXd>& x, DeviationOf of) {
  const auto points = points_of<Dim>(x);
  require(!fit.variances.empty(), "standard_deviation", "method", fit.report.method,
          fit.report.samples == 1 ? "samples at a single place tell none; give more"
                                  : "this fit has none; give standard_deviation to fit as well, or more samples");
  Eigen::MatrixXd result(x.cols(), static_cast<Index>(fit.variances.size()));
  const std::vector<double>& noise = fit.report.noise;
  require(of == DeviationOf::sample || std::ssize(noise) == result.cols(), "standard_deviation", "of", "function",
          "the noise of the samples is unknown for this fit; ask for that of a sample");
  const bool has_own = of == DeviationOf::function && !fit.function_variances.empty();
  for (Index c = 0; c < result.cols(); ++c) {
    Eigen::ArrayXd variance = (has_own ? fit.function_variances : fit.variances)[c]->evaluate(points).value;
    if (of == DeviationOf::function && !has_own) variance -= std::pow(noise[c] / fit.variance_unit, 2);
    result.col(c) = fit.variance_unit * variance.unaryExpr([](double v) { return v < 0 ? 0 : v; }).sqrt();  // keeps NaN
  }
  return result;
}

// Whether points are within a distance from places.
template <int D>
std::vector<char> near_places(const Points<D>& places, const Points<D>& x, double distance) {
  const KdTree<D> tree(places);
  std::vector<char> near(static_cast<std::size_t>(x.cols()));
  parallel_for(x.cols(), 1024, [&](Index begin, Index end) {
    for (Index i = begin; i < end; ++i)
      near[static_cast<std::size_t>(i)] =
          x.col(i).allFinite() && tree.any_within(x.col(i), distance * (1 + 1e-12)) ? 1 : 0;
  });
  return near;
}

template <int Dim>
std::vector<char> covered_by_hull(const Fit<Dim>& fit, const Points<Dim>& x) {
  require(fit.report.sphere.empty(), "mask", "hull", "given", "a sphere has no hull; use distance:D, in degrees");
  if constexpr (Dim > 3) {
    throw InvalidInput("mask: hull: of " + std::to_string(fit.report.axis_scales.size()) +
                       " coordinates: use distance:D");
  } else {
    const HalfSpaces hull = convex_hull<Dim>(*fit.places);
    const double rounding = 1e-9 * bounding_box<Dim>(*fit.places).extent().maxCoeff();
    std::vector<char> inside(static_cast<std::size_t>(x.cols()));
    parallel_for(x.cols(), 1024, [&](Index begin, Index end) {
      for (Index i = begin; i < end; ++i)
        inside[static_cast<std::size_t>(i)] = hull.contains(x.col(i), rounding) ? 1 : 0;
    });
    return inside;
  }
}

Points<3> on_sphere(const Eigen::Ref<const Eigen::MatrixXd>& x, const std::vector<int>& axes) {
  Points<3> u(3, x.cols());
  for (Index i = 0; i < x.cols(); ++i) u.col(i) = point_on_sphere(x(axes[0], i), x(axes[1], i));
  return u;
}

template <int Dim>
std::vector<char> covered_places(const Fit<Dim>& fit, const Eigen::Ref<const Eigen::MatrixXd>& given,
                                 const Mask& mask) {
  const Points<Dim> x = points_of<Dim>(given);
  require(fit.report.drift_axes.empty(), "mask", "function", "with a drift", "covariates have no hull; leave it out");
  require(fit.places != nullptr, "mask", "model", "older",
          "does not know where its samples are; fit it again with this version");
  if (mask.hull) return covered_by_hull(fit, x);
  const std::vector<int>& sphere = fit.report.sphere;
  if (sphere.empty()) return near_places<Dim>(*fit.places, x, mask.distance);
  require(Dim == 2, "mask", "coordinates", Dim, "on a sphere there must be no others");
  const double half = std::min(mask.distance, 180.0) * std::numbers::pi / 360;
  return near_places<3>(on_sphere(*fit.places, sphere), on_sphere(x, sphere), 2 * std::sin(half));
}

// Rows of a gradient, or of the upper triangle of a Hessian, that are of the variables that there are.
template <int Dim>
std::vector<Index> rows_of(int variables, bool hessian) {
  std::vector<Index> rows;
  for (Index a = 0, entry = 0; a < Dim; ++a) {
    if (!hessian && a < variables) rows.push_back(a);
    for (Index b = a; b < Dim; ++b, ++entry)
      if (hessian && b < variables) rows.push_back(entry);
  }
  return rows;
}

template <int Dim>
Function::Values evaluate_all(const Fit<Dim>& fit, int variables, const Eigen::Ref<const Eigen::MatrixXd>& x,
                              Derivatives derivatives) {
  const auto points = points_of<Dim>(x);
  const auto k = static_cast<Index>(fit.components.size());
  const Index m = x.cols(), d = variables, h = d * (d + 1) / 2;
  const std::vector<Index> slopes = rows_of<Dim>(variables, false), bends = rows_of<Dim>(variables, true);
  Function::Values result;
  result.value.resize(m, k);
  result.gradient.resize(m, derivatives >= Derivatives::gradient ? k * d : 0);
  result.hessian.resize(m, derivatives >= Derivatives::hessian ? k * h : 0);
  for (Index c = 0; c < k; ++c) {
    const Jet<Dim> jet = fit.components[c]->evaluate(points, derivatives);
    result.value.col(c) = jet.value;
    if (derivatives >= Derivatives::gradient)
      result.gradient.middleCols(c * d, d) = jet.gradient(slopes, Eigen::all).transpose();
    if (derivatives >= Derivatives::hessian)
      result.hessian.middleCols(c * h, h) = jet.hessian(bends, Eigen::all).transpose();
  }
  return result;
}

template <int Dim>
Eigen::MatrixXd evaluate_on_grid(const Fit<Dim>& fit, int variables, const std::vector<Eigen::VectorXd>& axes) {
  require(std::ssize(axes) == variables, "evaluate_grid", "number of axes", axes.size(),
          "must be " + std::to_string(variables) + ", the dimension of the function");
  GridAxes<Dim> grid;
  grid.fill(Eigen::VectorXd::Zero(1));
  std::copy(axes.begin(), axes.end(), grid.begin());
  Eigen::MatrixXd values;
  for (std::size_t c = 0; c < fit.components.size(); ++c) {
    const Eigen::VectorXd column = fit.components[c]->evaluate_grid(grid);
    if (c == 0) values.resize(column.size(), static_cast<Index>(fit.components.size()));
    values.col(static_cast<Index>(c)) = column;
  }
  return values;
}

// Some layers of the last axis at a time.
template <class Scalar>
void evaluate_slices(const Function& function, std::vector<Eigen::VectorXd> axes,
                     Eigen::Ref<Eigen::MatrixX<Scalar>> values, const Progress& progress) {
  constexpr Index most_nodes = Index{1} << 20;  // at a time, 8 MB per component; chosen by hand
  const auto d = static_cast<std::size_t>(function.dimension());
  require(axes.size() == d, "evaluate_grid", "number of axes", axes.size(),
          "must be " + std::to_string(d) + ", the dimension of the function");
  Index layer = 1;
  for (std::size_t a = 0; a + 1 < d; ++a) layer *= axes[a].size();
  const Eigen::VectorXd last = axes.back();
  require(values.rows() == function.components(), "evaluate_grid", "rows of values", values.rows(),
          "must be " + std::to_string(function.components()) + ", the components of the function");
  require(values.cols() == layer * last.size(), "evaluate_grid", "columns of values", values.cols(),
          "must be " + std::to_string(layer * last.size()) + ", the nodes of the grid");
  if (values.cols() == 0) return;
  const Index layers = std::max<Index>(1, most_nodes / layer);
  for (Index begin = 0; begin < last.size(); begin += layers) {
    report(progress, "evaluate", static_cast<double>(begin) / static_cast<double>(last.size()));
    axes.back() = last.segment(begin, std::min(layers, last.size() - begin));
    values.middleCols(layer * begin, layer * axes.back().size()) =
        function.evaluate_grid(axes).transpose().template cast<Scalar>();
  }
}

// In many variables with zeros for those that there are not, of which the report does not speak.
template <int Dim>
Function fit_variables(const Eigen::Ref<const Eigen::MatrixXd>& points, const Eigen::Ref<const Eigen::MatrixXd>& values,
                       const Eigen::Ref<const Eigen::VectorXd>& weights, FitOptions options) {
  const auto variables = static_cast<int>(points.rows());
  if constexpr (Dim > largest_dimension) {
    require(options.periods.empty() || std::ssize(options.periods) == variables, "fit", "periods",
            options.periods.size(), "one per axis, 0 for axes that are not periodic, or none at all");
    require(options.sphere.empty() || !options.drift.empty(), "fit", "dimension", variables,
            "with a sphere there are at most " + std::to_string(largest_dimension - 1) + " coordinates");
    if (!options.periods.empty()) options.periods.resize(static_cast<std::size_t>(Dim), 0.0);
    for (const std::vector<int>* axes : {&options.drift, &options.sphere})
      for (const int a : *axes)
        require(a >= 0 && a < variables, "fit", "axis", a, "must be one of the variables, numbered from 0");
    require(std::ssize(options.drift) < variables, "fit", "drift", options.drift.size(),
            "must leave one axis at least that is a coordinate");
  }
  Fit<Dim> result = csrbf::fit<Dim>(Samples<Dim>{points_of<Dim>(points), values, weights}, options);
  result.report.axis_scales.resize(static_cast<std::size_t>(variables));
  for (std::vector<double>& axis : result.report.axes) axis.resize(static_cast<std::size_t>(variables));
  return Function(std::move(result), variables);
}

}  // namespace

template <int Dim>
Function::Function(Fit<Dim> fit) : Function(std::move(fit), Dim) {}

template <int Dim>
Function::Function(Fit<Dim> fit, int variables)
    : dimension_(variables), fit_(std::make_shared<const FunctionFit>(std::move(fit))) {
  require(fitted_dimension(variables) == Dim, "Function", "variables", variables,
          "must be fitted in " + std::to_string(fitted_dimension(variables)) + " dimensions");
  const auto& components = this->fit<Dim>().components;
  require(!components.empty(), "Function", "components of the fit", 0, "there must be at least one");
  for (const auto& component : components)
    require(component != nullptr, "Function", "component of the fit", "null", "must point to a field");
}

template <int Dim>
const Fit<Dim>& Function::fit() const {
  const Fit<Dim>* found = std::get_if<Fit<Dim>>(fit_.get());
  require(found != nullptr, "Function::fit", "dimension", Dim,
          "must be that of the function, " + std::to_string(dimension_));
  return *found;
}

Index Function::components() const {
  return visit_fit(*fit_, [](const auto& fit) { return static_cast<Index>(fit.components.size()); });
}

const FitReport& Function::report() const {
  return *visit_fit(*fit_, [](const auto& fit) { return &fit.report; });
}

Function::Values Function::evaluate(const Eigen::Ref<const Eigen::MatrixXd>& x, Derivatives derivatives) const {
  require_variables(x, dimension_);
  return visit_fit(*fit_, [&](const auto& fit) { return evaluate_all(fit, dimension_, x, derivatives); });
}

Eigen::MatrixXd Function::evaluate_grid(const std::vector<Eigen::VectorXd>& axes) const {
  return visit_fit(*fit_, [&](const auto& fit) { return evaluate_on_grid(fit, dimension_, axes); });
}

void Function::evaluate_grid(const std::vector<Eigen::VectorXd>& axes, Eigen::Ref<Eigen::MatrixXd> values,
                             const Progress& progress) const {
  evaluate_slices<double>(*this, axes, values, progress);
}

void Function::evaluate_grid(const std::vector<Eigen::VectorXd>& axes, Eigen::Ref<Eigen::MatrixXf> values,
                             const Progress& progress) const {
  evaluate_slices<float>(*this, axes, values, progress);
}

Eigen::MatrixXd Function::standard_deviation(const Eigen::Ref<const Eigen::MatrixXd>& x, DeviationOf of) const {
  require_variables(x, dimension_);
  return visit_fit(*fit_, [&](const auto& fit) { return deviation(fit, x, of); });
}

std::vector<bool> Function::covered(const Eigen::Ref<const Eigen::MatrixXd>& x, const Mask& mask) const {
  require_variables(x, dimension_);
  const std::vector<char> covered = visit_fit(*fit_, [&](const auto& fit) { return covered_places(fit, x, mask); });
  return {covered.begin(), covered.end()};
}

Function Function::extrapolated(Extrapolation extrapolation) const {
  require(extrapolation != Extrapolation::automatic, "extrapolation", "of a function", "auto",
          "is for fits; use constant, linear, trend or nan");
  return visit_fit(*fit_, [&]<int Dim>(const Fit<Dim>& fit) {
    Fit<Dim> result = fit;
    const bool has_trend = fit.report.method == info_of(FitMethod::interpolate).name;
    extrapolate<Dim>(result.components, result.variances, has_trend, extrapolation);
    std::vector<std::shared_ptr<const Field<Dim>>> none;
    if (!result.function_variances.empty()) extrapolate<Dim>(result.function_variances, none, has_trend, extrapolation);
    return Function(std::move(result), dimension_);
  });
}

Mask mask_of(const std::string& text) {
  if (text == "hull") return {.hull = true};
  const std::string prefix = "distance:";
  Mask mask;
  const char *begin = text.data() + std::min(prefix.size(), text.size()), *end = text.data() + text.size();
  const auto [last, error] = read_number(begin, end, mask.distance);
  if (!text.starts_with(prefix) || error != std::errc() || last != end || !(mask.distance > 0))
    throw InvalidInput("mask = " + text + ": must be hull, or distance:D with a positive distance D");
  return mask;
}

Eigen::MatrixXd Function::bounds() const {
  return visit_fit(*fit_, [&](const auto& fit) {
    const auto box = fit.components.front()->bounds();
    Eigen::MatrixXd corners(dimension_, 2);
    corners << box.lo.head(dimension_), box.hi.head(dimension_);
    return corners;
  });
}

Function fit_function(const Eigen::Ref<const Eigen::MatrixXd>& points, const Eigen::Ref<const Eigen::MatrixXd>& values,
                      const Eigen::Ref<const Eigen::VectorXd>& weights, const FitOptions& options) {
  switch (fitted_dimension(points.rows())) {
#define CSRBF_CASE(Dim) \
  case Dim:             \
    return fit_variables<Dim>(points, values, weights, options);
    CSRBF_FOR_MANY_DIMS(CSRBF_CASE)
#undef CSRBF_CASE
    default:
      throw InvalidInput("fit: dimension = " + std::to_string(points.rows()) + ": " + dimensions_text);
  }
}

#define CSRBF_INSTANTIATE(Dim)                              \
  template Function::Function(Fit<Dim> fit);                \
  template Function::Function(Fit<Dim> fit, int variables); \
  template const Fit<Dim>& Function::fit<Dim>() const;
CSRBF_FOR_MANY_DIMS(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
