#include "report/fit_page.hpp"

#include "report/left_out.hpp"
#include "report/plots.hpp"
#include "report/surface_view.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/core/percentile.hpp"

#include <algorithm>
#include <cmath>

namespace csrbf::app {
namespace {

constexpr Index most_samples = 200000;  // in the histogram: more take longer, and change nothing to be seen

// The box of the samples and the names of the axes.
struct Domain {
  Eigen::MatrixXd bounds;  // d x 2
  const NamedFunction& model;

  [[nodiscard]] double lo(Index a) const { return bounds(a, 0); }
  [[nodiscard]] double hi(Index a) const { return bounds(a, 1); }
  [[nodiscard]] double extent(Index a) const { return hi(a) - lo(a); }
  [[nodiscard]] const std::string& name(Index a) const { return model.coordinate_names[a]; }
  [[nodiscard]] const std::string& value() const { return model.value_names.front(); }
  // Do both axes seem to have the same unit?
  [[nodiscard]] bool to_scale(Index a, Index b) const {
    constexpr double most = 3;  // ratio of the extents; chosen by hand
    return extent(a) < most * extent(b) && extent(b) < most * extent(a);
  }
};

// Longitudes are turned into those of the box, which may lie across the date line.
SampleTable turned_into_box(SampleTable samples, const Domain& domain) {
  const std::vector<int>& sphere = domain.model.function.report().sphere;
  if (sphere.empty()) return samples;
  constexpr double turn = 360, rounding = 1e-9;  // degrees
  const double west = domain.lo(sphere[0]) - rounding;
  for (double& longitude : samples.coordinates.row(sphere[0]))
    longitude -= turn * std::floor((longitude - west) / turn);
  return samples;
}

// Whether the errors at the samples are those of rounding.
bool passes_through(const FitReport& r, const Eigen::MatrixXd& values) {
  constexpr double share = 1e-6;  // of the range of the values; chosen by hand
  return r.max_error <= share * (values.maxCoeff() - values.minCoeff());
}

// What the errors at the samples come from.
std::string treatment(const FitReport& r, const Eigen::MatrixXd& values) {
  if (passes_through(r, values)) return "The function passes through the samples: nothing was smoothed away.";
  if (r.smoothing > 0)
    return "The function does not pass through every sample: part of their variation was treated as noise and smoothed "
           "away (smoothing " +
           readable(r.smoothing) + ").";
  return "The function does not pass through every sample: it has fewer degrees of freedom than there are samples, and "
         "comes as near as these allow.";
}

void add_facts(const FitReport& r, const Domain& domain, const SampleTable& samples, Page& page) {
  page.facts = {{grouped(r.samples), "samples"},
                {readable(r.rmse), "error at the samples, root mean square"},
                {readable(r.max_error), "largest error at a sample"}};
  if (std::isfinite(r.cross_validation_rmse)) {
    page.facts.push_back({readable(r.cross_validation_rmse), "error at held-out samples"});
    page.findings.push_back("Held-out samples of " + domain.value() + " were predicted with an error of " +
                            readable(r.cross_validation_rmse) +
                            " (root mean square): expect this error between the samples.");
  }
  page.findings.push_back(treatment(r, samples.values));
  if (domain.model.value_names.size() > 1)
    page.findings.push_back("The pictures show " + domain.value() + ", the first of " +
                            counted(std::ssize(domain.model.value_names), "value") + ".");
  if (r.merged_duplicates > 0)
    page.findings.push_back(counted(r.merged_duplicates, "sample") + " merged with others at the same place.");
}

Figure error_histogram(const Eigen::VectorXd& error, const FitReport& r, const Domain& domain) {
  std::vector<double> sizes;
  for (const double value : error)
    if (std::isfinite(value)) sizes.push_back(std::abs(value));
  constexpr double most = 0.99, more = 1.25;  // the axis ends at 1.25 times the 99th percentile: outliers do not set it
  const double limit = sizes.empty() ? 1 : more * percentile(sizes, most);
  Histogram histogram{.values = {error.begin(), error.end()},
                      .lo = -limit,
                      .hi = limit,
                      .label = "sample − function, in the unit of " + domain.value(),
                      .counted = "samples"};
  std::string caption = "The outermost bars include all samples beyond them.";
  if (error.size() < r.samples) caption += " Shows " + counted(error.size(), "sample") + ", evenly chosen.";
  return {"Errors at the samples", draw(histogram), caption};
}

Figure curve(const Domain& domain, const SampleTable& samples, const std::vector<Index>& chosen) {
  constexpr Index places = 600, most = 2000;  // of the curve, about one per pixel; dots, beyond which they merge
  Eigen::MatrixXd x = Eigen::RowVectorXd::LinSpaced(places, domain.lo(0), domain.hi(0));
  Curve plot{.x_label = domain.name(0), .y_label = domain.value()};
  plot.line.resize(2, places);
  plot.line.row(0) = x;
  plot.line.row(1) = domain.model.function.evaluate(x).value.col(0);
  const std::vector<Index> dots = spread(chosen, most);
  plot.dots.resize(2, std::ssize(dots));
  plot.dots << samples.coordinates(0, dots), samples.values(dots, 0).transpose();
  return {"The function", draw(plot), "The curve is the function, the dots are samples."};
}

// Values on the plane of two axes, at the middle of the others.
Eigen::MatrixXd plane_values(const Domain& domain, Index a, Index b, const Eigen::VectorXd& x,
                             const Eigen::VectorXd& y) {
  std::vector<Eigen::VectorXd> axes;
  for (Index k = 0; k < domain.bounds.rows(); ++k)
    axes.push_back(k == a ? x : k == b ? y : Eigen::VectorXd::Constant(1, 0.5 * (domain.lo(k) + domain.hi(k))));
  const Eigen::MatrixXd values = domain.model.function.evaluate_grid(axes);
  return Eigen::Map<const Eigen::MatrixXd>(values.data(), x.size(), y.size()).transpose();
}

PlaneMap plane_map(const Domain& domain, Index a, Index b, Eigen::MatrixXd values) {
  PlaneMap map{.values = std::move(values),
               .x_label = domain.name(a),
               .y_label = domain.name(b),
               .to_scale = domain.to_scale(a, b),
               .description = domain.value() + " by " + domain.name(a) + " and " + domain.name(b)};
  map.box.lo << domain.lo(a), domain.lo(b);
  map.box.hi << domain.hi(a), domain.hi(b);
  return map;
}

// What colours of the function span, and its name.
struct ColorRange {
  double lo, hi;
  std::string label;
};

// Values far beyond those of the samples, where the function extrapolates, would leave one colour to the rest.
ColorRange color_range(const std::string& label, double lo, double hi, const SampleTable& samples) {
  constexpr double beyond = 0.1;  // of the range of the samples; chosen by hand
  const auto values = samples.values.col(0);
  const double least = values.minCoeff(), most = values.maxCoeff(), margin = beyond * (most - least);
  const bool is_cut = lo < least - margin || hi > most + margin;
  lo = std::max(lo, least - margin);
  hi = std::min(hi, most + margin);
  if (!(lo < hi)) return {lo - 1, lo + 1, label};
  return {lo, hi, is_cut ? label + " (colours end near those of the samples)" : label};
}

void set_range(const std::string& label, const SampleTable& samples, std::vector<PlaneMap>& maps) {
  double lo = std::numeric_limits<double>::infinity(), hi = -lo;
  for (const PlaneMap& map : maps) extend(map.values.reshaped(), lo, hi);
  const ColorRange range = color_range(label, lo, hi, samples);
  for (PlaneMap& map : maps) map.scale = {range.lo, range.hi, false, range.label};
}

// `values`: of the function on a grid over the plane.
Figure map_of_plane(const Domain& domain, const Eigen::MatrixXd& values, const SampleTable& samples,
                    const std::vector<Index>& chosen) {
  std::vector<PlaneMap> maps{plane_map(domain, 0, 1, values)};
  set_range(domain.value(), samples, maps);
  constexpr Index most = 3000;  // dots, beyond which they hide the map
  maps[0].dots = samples.coordinates(Eigen::all, spread(chosen, most));
  const std::string shown =
      maps[0].dots.cols() < samples.coordinates.cols() ? counted(maps[0].dots.cols(), "sample") : "the samples";
  const std::string caption = "Colours show the function, dots the positions of " + shown + ".";
  return {"The function", draw(maps[0]), caption};
}

Figure maps_of_space(const Domain& domain, const SampleTable& samples) {
  std::vector<PlaneMap> maps;
  for (const auto& [a, b] : {std::pair<Index, Index>{0, 1}, {0, 2}, {1, 2}}) {
    constexpr Index nodes = 150;  // along each axis, one for two pixels
    maps.push_back(plane_map(domain, a, b,
                             plane_values(domain, a, b, Eigen::VectorXd::LinSpaced(nodes, domain.lo(a), domain.hi(a)),
                                          Eigen::VectorXd::LinSpaced(nodes, domain.lo(b), domain.hi(b)))));
    maps.back().width = 250;
  }
  set_range(domain.value(), samples, maps);
  std::vector<std::string> drawings;
  for (const PlaneMap& map : maps) drawings.push_back(draw(map));
  return {"The function on planes through the middle", side_by_side(drawings),
          "Each plane spans two coordinates; the others are in the middle of their range.", true};
}

// The function of two variables as a landscape over the unit square (or the rectangle of the samples).
class Landscape {
 public:
  explicit Landscape(const Domain& domain) : domain_(domain) {
    constexpr Index nodes = 200;  // along each axis: 40,000 vertices, within SurfaceView::most_vertices
    const double longer = std::max(domain.extent(0), domain.extent(1));
    const bool to_scale = domain.to_scale(0, 1);
    for (Index a = 0; a < 2; ++a) {
      scale_[a] = 1 / (to_scale ? longer : domain.extent(a));
      axes_[a] = Eigen::VectorXd::LinSpaced(nodes, domain.lo(a), domain.hi(a));
    }
    values_ = plane_values(domain, 0, 1, axes_[0], axes_[1]);
    if (!is_finite()) return;
    lo_ = values_.minCoeff();
    hi_ = values_.maxCoeff();
    constexpr double height = 0.4;  // of the longer side, chosen by eye
    scale_[2] = hi_ > lo_ ? height / (hi_ - lo_) : 1;
  }

  [[nodiscard]] bool is_finite() const { return values_.allFinite(); }
  [[nodiscard]] double lo() const { return lo_; }
  [[nodiscard]] double hi() const { return hi_; }

  [[nodiscard]] Point<3> place(double x, double y, double value) const {
    return {scale_[0] * (x - domain_.lo(0)), scale_[1] * (y - domain_.lo(1)), scale_[2] * (value - lo_)};
  }

  [[nodiscard]] Mesh mesh() const {
    const Index columns = values_.cols(), rows = values_.rows();
    Mesh mesh;
    mesh.vertices.resize(3, columns * rows);
    mesh.normals.resize(3, columns * rows);
    mesh.triangles.resize(3, 2 * (columns - 1) * (rows - 1));
    Index triangle = 0;
    for (Index j = 0; j < rows; ++j)
      for (Index i = 0; i < columns; ++i) {
        mesh.vertices.col(j * columns + i) = place(axes_[0][i], axes_[1][j], values_(j, i));
        mesh.normals.col(j * columns + i) = normal(i, j);
        if (i + 1 == columns || j + 1 == rows) continue;
        const auto v = static_cast<std::int32_t>(j * columns + i), up = static_cast<std::int32_t>(v + columns);
        mesh.triangles.col(triangle++) << v, v + 1, up + 1;
        mesh.triangles.col(triangle++) << v, up + 1, up;
      }
    return mesh;
  }

  // Values on a grid of nodes x nodes over the same box (x fastest), bilinear at the vertices.
  [[nodiscard]] Eigen::VectorXd at_nodes(const Eigen::VectorXd& grid, Index nodes) const {
    Eigen::VectorXd result(values_.size());
    const double last = static_cast<double>(nodes - 1);
    for (Index j = 0, k = 0; j < values_.rows(); ++j)
      for (Index i = 0; i < values_.cols(); ++i, ++k) {
        const double x = last * static_cast<double>(i) / static_cast<double>(values_.cols() - 1);
        const double y = last * static_cast<double>(j) / static_cast<double>(values_.rows() - 1);
        const Index c = std::min(static_cast<Index>(x), nodes - 2), r = std::min(static_cast<Index>(y), nodes - 2);
        const double s = x - static_cast<double>(c), t = y - static_cast<double>(r);
        const double* corner = grid.data() + r * nodes + c;
        result[k] =
            (1 - t) * ((1 - s) * corner[0] + s * corner[1]) + t * ((1 - s) * corner[nodes] + s * corner[nodes + 1]);
      }
    return result;
  }

  // Rows along y.
  [[nodiscard]] const Eigen::MatrixXd& grid() const { return values_; }

  // In the order of the vertices.
  [[nodiscard]] Eigen::VectorXd values() const { return values_.transpose().reshaped(); }

 private:
  [[nodiscard]] Point<3> normal(Index i, Index j) const {
    const Index left = std::max<Index>(i - 1, 0), right = std::min(i + 1, values_.cols() - 1);
    const Index low = std::max<Index>(j - 1, 0), high = std::min(j + 1, values_.rows() - 1);
    const double dx =
        (values_(j, right) - values_(j, left)) * scale_[2] / (scale_[0] * (axes_[0][right] - axes_[0][left]));
    const double dy = (values_(high, i) - values_(low, i)) * scale_[2] / (scale_[1] * (axes_[1][high] - axes_[1][low]));
    return Point<3>(-dx, -dy, 1).normalized();
  }

  const Domain& domain_;
  GridAxes<2> axes_;
  Eigen::MatrixXd values_;
  Point<3> scale_ = Point<3>::Ones();
  double lo_ = 0, hi_ = 1;
};

// Deviations at the nodes of the landscape, linear between those of a coarser grid; empty where the function has none.
Eigen::VectorXd deviations(const Landscape& landscape, const Domain& domain) {
  constexpr Index nodes = 30;  // along each axis: 900 deviations take some hundredths of a second
  Eigen::MatrixXd places(2, nodes * nodes);
  const auto at = [&](Index axis, Index i) {
    return domain.lo(axis) + domain.extent(axis) * static_cast<double>(i) / static_cast<double>(nodes - 1);
  };
  for (Index j = 0; j < nodes; ++j)
    for (Index i = 0; i < nodes; ++i) places.col(j * nodes + i) << at(0, i), at(1, j);
  Eigen::VectorXd coarse;
  try {
    coarse = domain.model.function.standard_deviation(places, DeviationOf::function).col(0);
  } catch (const InvalidInput&) {
    return {};
  }
  if (!coarse.allFinite()) return {};
  return landscape.at_nodes(coarse, nodes);
}

Figure landscape_view(const Landscape& landscape, const Domain& domain, const SampleTable& samples,
                      const std::vector<Index>& chosen, const Eigen::VectorXd& error) {
  SurfaceView view;
  view.title = "The function as a landscape";
  view.shown = "0";
  view.up = "z";
  view.mesh = landscape.mesh();
  view.axes = {domain.name(0), domain.name(1), domain.value()};
  view.ranges = Box<3>{{domain.lo(0), domain.lo(1), landscape.lo()}, {domain.hi(0), domain.hi(1), landscape.hi()}};
  Points<3> places(3, std::ssize(chosen));
  for (Index i = 0; i < places.cols(); ++i) {
    const auto x = samples.coordinates.col(chosen[i]);
    places.col(i) = landscape.place(x[0], x[1], samples.values(chosen[i], 0));
  }
  const std::vector<Index> points = spread_indices(places.cols(), SurfaceView::most_points);
  view.points = places(Eigen::all, points);
  const Eigen::VectorXd size = error.cwiseAbs();
  const ColorRange range = color_range(domain.value(), landscape.lo(), landscape.hi(), samples);
  view.colors.push_back({domain.value(), range.label, range.lo, range.hi, false, landscape.values(),
                         samples.values(spread(chosen, SurfaceView::most_points), 0)});
  std::vector<double> sizes(size.begin(), size.end());
  constexpr double most = 0.99;  // percentile at the end of the scale: outliers do not set it
  view.colors.push_back({"error at the samples", "Error at the samples (grey: no samples nearby)", 0,
                         percentile(sizes, most), false, values_near(places, size, view.mesh.vertices), size(points)});
  if (const Eigen::VectorXd deviation = deviations(landscape, domain); deviation.size() > 0)
    view.colors.push_back(
        {"standard deviation", "Standard deviation of the function", 0, deviation.maxCoeff(), false, deviation});
  view.caption = "Heights are values of " + domain.value() + ", scaled to be visible.";
  return surface_figure(view);
}

// Where the errors are, on the plane: blue where the function is too high.
Figure residual_map(const Domain& domain, const SampleTable& samples, const std::vector<Index>& chosen,
                    const Eigen::VectorXd& error) {
  constexpr Index cells = 60;  // along the longer axis
  const bool to_scale = domain.to_scale(0, 1);
  const double longer = std::max(domain.extent(0), domain.extent(1));
  const auto count = [&](Index axis) {
    return to_scale ? std::max<Index>(2, std::lround(cells * domain.extent(axis) / longer)) : cells;
  };
  const Index columns = count(0), rows = count(1);
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(rows, columns), weight = sum;
  const auto cell = [&](Index axis, double value, Index n) {
    const double part = (value - domain.lo(axis)) / domain.extent(axis);
    return std::clamp<Index>(static_cast<Index>(part * static_cast<double>(n)), 0, n - 1);
  };
  for (Index i = 0; i < error.size(); ++i) {
    if (!std::isfinite(error[i])) continue;
    const auto x = samples.coordinates.col(chosen[i]);
    const Index r = cell(1, x[1], rows), c = cell(0, x[0], columns);
    sum(r, c) += error[i];
    weight(r, c) += 1;
  }
  std::vector<double> sizes;
  for (const double value : error)
    if (std::isfinite(value)) sizes.push_back(std::abs(value));
  constexpr double most = 0.98;  // percentile at the ends of the scale
  const double limit = sizes.empty() ? 1 : percentile(sizes, most);
  PlaneMap map{
      .values = (weight.array() > 0).select(sum.array() / weight.array(), std::numeric_limits<double>::quiet_NaN()),
      .x_label = domain.name(0),
      .y_label = domain.name(1),
      .scale = {-(limit > 0 ? limit : 1), limit > 0 ? limit : 1, true, "sample − function"},
      .to_scale = to_scale,
      .description = "Errors at the samples by " + domain.name(0) + " and " + domain.name(1)};
  map.box.lo << domain.lo(0), domain.lo(1);
  map.box.hi << domain.hi(0), domain.hi(1);
  constexpr Index most_dots = 2000;  // beyond which they cover each other
  if (error.size() > most_dots)
    return {"Where the errors are", draw(map), "Mean errors at the samples in each cell; grey: no samples."};
  map.dots = samples.coordinates(Eigen::all, chosen);
  map.dot_values = error;
  return {"Where the errors are", draw(map), "Each dot is a sample, coloured by its error."};
}

}  // namespace

void show(const NamedFunction& model, const SampleTable& given, const FitOptions& options, Page& page) {
  const Domain domain{model.function.bounds(), model};
  const SampleTable samples = turned_into_box(given, domain);
  const FitReport& r = model.function.report();
  add_facts(r, domain, samples, page);
  const std::vector<Index> chosen = spread_indices(samples.coordinates.cols(), most_samples);
  const Eigen::VectorXd error =
      samples.values(chosen, 0) - model.function.evaluate(samples.coordinates(Eigen::all, chosen)).value.col(0);
  const bool has_extent = (domain.bounds.col(1) - domain.bounds.col(0)).minCoeff() > 0;
  const int dimension = model.function.dimension();
  if (dimension == 2 && has_extent) {
    const Landscape landscape(domain);
    if (landscape.is_finite() && landscape.hi() > landscape.lo())
      page.figures.push_back(landscape_view(landscape, domain, samples, chosen, error));
    page.figures.push_back(map_of_plane(domain, landscape.grid(), samples, chosen));
  } else if (has_extent) {
    page.figures.push_back(dimension == 1 ? curve(domain, samples, chosen) : maps_of_space(domain, samples));
  }
  page.figures.push_back(error_histogram(error, r, domain));
  if (dimension == 2 && has_extent && !passes_through(r, samples.values))
    page.figures.push_back(residual_map(domain, samples, chosen, error));
  add_left_out(model, samples, options, page);
}

}  // namespace csrbf::app
