#include "csrbf/approx/fit_on_sphere.hpp"

#include "csrbf/approx/fit_method.hpp"
#include "csrbf/approx/samples/merge_duplicates.hpp"
#include "csrbf/kernels/kernel.hpp"
#include "csrbf/spatial/morton_order.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace csrbf {
namespace {

// Chosen by hand.
constexpr double one_chart = 45;            // degrees: reach of samples that one chart holds
constexpr Index in_one_system = 2500;       // samples on the whole sphere, fitted in space
constexpr Index fewest_in_chart = 40;       // samples within its reach
constexpr Index fallback_samples = 500;     // of the whole sphere, where a chart is missing
constexpr double grid_per_degree = 0x1p36;  // to which longitudes are rounded: 360 may have been added

// Longitudes from -180 to 180.
template <int Dim>
Samples<Dim> with_usual_longitudes(const Samples<Dim>& samples, int axis) {
  Samples<Dim> result = samples;
  for (double& longitude : result.points.row(axis))
    longitude = std::round(std::remainder(longitude, 360.0) * grid_per_degree) / grid_per_degree;
  return result;
}

// A chart whose middle is the point n.
SphereChart chart_at(const Point<3>& n) {
  SphereChart chart;
  chart.axes.row(2) = n;
  // East and north, or any two directions at the poles.
  const Point<3> pole(0, 0, 1), x(1, 0, 0);
  const Point<3> east = std::abs(n[2]) > 1 - 1e-12 ? x : Point<3>(pole.cross(n).normalized());
  chart.axes.row(0) = east;
  chart.axes.row(1) = n.cross(east).normalized();
  return chart;
}

struct Cap {
  Point<3> middle;
  double reach;  // degrees
};

template <int Dim>
Points<3> directions(const Samples<Dim>& samples, const FitOptions& options) {
  Points<3> u(3, samples.size());
  for (Index i = 0; i < samples.size(); ++i)
    u.col(i) = point_on_sphere(samples.points(options.sphere[0], i), samples.points(options.sphere[1], i));
  return u;
}

// Around the middle of the box of the points, which does not depend on where samples are dense.
Cap cap_of(const Points<3>& u) {
  const Point<3> middle = 0.5 * (u.rowwise().minCoeff() + u.rowwise().maxCoeff());
  if (!(middle.norm() > 0.1)) return {Point<3>(0, 0, 1), 180};
  const Point<3> n = middle.normalized();
  const double cosine = std::clamp((n.transpose() * u).minCoeff(), -1.0, 1.0);
  return {n, std::acos(cosine) * 180 / std::numbers::pi};
}

bool uses_charts(const FitOptions& options, Index samples) {
  if (options.kernel != "auto" && Kernel(options.kernel, 3, options.kernel_parameter).order() > 0) return false;
  if (const FitMethodInfo* given = find_fit_method(options.method))
    return given->method == FitMethod::partition_of_unity || given->method == FitMethod::moving_least_squares ||
           given->method == FitMethod::along_tracks;
  return options.centers == 0 && samples > in_one_system;
}

// One fit from those in charts and in space.
template <int Dim>
class SphereFit {
  static constexpr int space_dim = SphereField<Dim>::space_dim;

 public:
  SphereFit(Samples<Dim> samples, const FitOptions& options, const FitSamples<Dim>& in_plane,
            const FitSamples<space_dim>& in_space)
      : samples_(std::move(samples)),
        options_(options),
        plane_options_(options),
        in_plane_(in_plane),
        in_space_(in_space),
        u_(directions(samples_, options)) {
    plane_options_.sphere.clear();
    if (!options.periods.empty()) plane_options_.periods = other_periods();
  }

  Fit<Dim> fit() {
    const Cap cap = cap_of(u_);
    std::vector<Index> all(samples_.size());
    for (Index i = 0; i < samples_.size(); ++i) all[i] = i;
    if (cap.reach <= one_chart) {
      add_chart(chart_at(cap.middle), all);
    } else {
      if (plane_options_.extrapolation == Extrapolation::nan) plane_options_.extrapolation = Extrapolation::constant;
      if (uses_charts(options_, samples_.size()))
        add_six_charts();
      else
        add_space(samples_, all);
    }
    return assemble();
  }

 private:
  [[nodiscard]] std::vector<double> other_periods() const {
    std::vector<double> periods = {0, 0};
    for (int a = 0; a < Dim; ++a)
      if (a != options_.sphere[0] && a != options_.sphere[1])
        periods.push_back(options_.periods[static_cast<std::size_t>(a)]);
    return periods;
  }

  void add_chart(const SphereChart& chart, const std::vector<Index>& rows) {
    Samples<Dim> here = chosen_samples(samples_, rows);
    here.points = SphereField<Dim>::in_chart(here.points, options_.sphere[0], options_.sphere[1], chart);
    fits_.push_back(in_plane_(here, plane_options_));
    charts_.push_back(chart);
    add_report(fits_.back().report, rows);
  }

  void add_six_charts() {
    const auto rows_within = [&](const Point<3>& n, double angle) {
      const double least = std::cos(angle * std::numbers::pi / 180);
      std::vector<Index> rows;
      for (Index i = 0; i < u_.cols(); ++i)
        if (n.dot(u_.col(i)) > least) rows.push_back(i);
      return rows;
    };
    bool complete = true;
    for (const int sign : {1, -1})
      for (Index a = 0; a < 3; ++a) {
        const Point<3> n = sign * Point<3>::Unit(a);
        if (std::ssize(rows_within(n, chart_reach)) >= fewest_in_chart)
          add_chart(chart_at(n), rows_within(n, chart_samples));
        else
          complete = false;
      }
    if (complete) return;
    std::vector<Index> spread;
    const std::vector<Index> order = morton_order<3>(u_);
    const Index stride = std::max<Index>(1, samples_.size() / fallback_samples);
    for (Index i = stride / 2; i < samples_.size(); i += stride) spread.push_back(order[i]);
    add_space(chosen_samples(samples_, spread), spread);
  }

  void add_space(const Samples<Dim>& some, const std::vector<Index>& rows) {
    if constexpr (space_dim > Dim) {
      Samples<space_dim> spatial;
      spatial.points = SphereField<Dim>::in_space(some.points, options_.sphere[0], options_.sphere[1]);
      spatial.values = some.values;
      spatial.weights = some.weights;
      FitOptions spatial_options = plane_options_;
      const bool is_free = options_.method == "auto" && options_.tolerance == 0 && options_.centers == 0;
      if (is_free || !charts_.empty()) spatial_options.method = "interpolate";
      if (Dim == 2) spatial_options.scale_axes = false;
      spatial_options.extrapolation = Extrapolation::trend;  // the box of the samples in space does not hold the sphere
      if (!options_.periods.empty()) spatial_options.periods.insert(spatial_options.periods.begin(), 0.0);
      space_ = in_space_(spatial, spatial_options);
      if (charts_.empty()) add_report(space_->report, rows);
    }
  }

  // Of a fit to the samples `rows`: sums, and what the largest one says.
  void add_report(const FitReport& part, const std::vector<Index>& rows) {
    const bool largest = part.samples > largest_;
    if (largest) largest_ = part.samples;
    const FitReport old = report_;
    if (largest) report_ = part;
    report_.centers = old.centers + part.centers;
    report_.choose_seconds = old.choose_seconds + part.choose_seconds;
    report_.fit_seconds = old.fit_seconds + part.fit_seconds;
    if (old.partition || part.partition) {
      PartitionReport sum = report_.partition.value_or(old.partition.value_or(PartitionReport{}));
      sum.patches =
          old.partition.value_or(PartitionReport{}).patches + part.partition.value_or(PartitionReport{}).patches;
      report_.partition = sum;
    }
    report_.warnings = old.warnings;
    for (const std::string& warning : part.warnings)
      if (std::find(old.warnings.begin(), old.warnings.end(), warning) == old.warnings.end())
        report_.warnings.push_back(warning);
    report_.gross_errors = old.gross_errors;
    for (const Index row : part.gross_errors) report_.gross_errors.push_back(rows[row]);
    report_.suspects = old.suspects;
    for (const Index row : part.suspects) report_.suspects.push_back(rows[row]);
    if (std::isfinite(part.cross_validation_rmse)) {
      squares_ += static_cast<double>(part.samples) * std::pow(part.cross_validation_rmse, 2);
      squared_ += static_cast<double>(part.samples);
    }
    noise_known_ = noise_known_ && !part.noise.empty();
  }

  void finish_report() {
    for (std::vector<Index>* found : {&report_.gross_errors, &report_.suspects}) {
      std::sort(found->begin(), found->end());
      found->erase(std::unique(found->begin(), found->end()), found->end());
    }
    if (squared_ > 0) report_.cross_validation_rmse = std::sqrt(squares_ / squared_);
    if (!noise_known_) report_.noise.clear();
    const Samples<3> places{u_, Eigen::MatrixXd::Zero(u_.cols(), 1), {}};
    if (charts_.size() > 1) {
      if (Dim == 2) report_.merged_duplicates = merge_duplicates(places).merged();
      report_.missing = 0;
      if (options_.missing)
        for (Index i = 0; i < samples_.size(); ++i)
          if ((samples_.values.row(i).array() == *options_.missing).any()) ++report_.missing;
      const auto left_out = options_.loss == "auto" ? std::ssize(report_.gross_errors) : 0;
      report_.samples = report_.samples_fitted =
          samples_.size() - report_.missing - report_.merged_duplicates - left_out;
    }
    std::vector<double> scales(Dim);
    const std::size_t mapped = charts_.empty() ? 3 : 2;  // coordinates of the sphere come first in those of the fit
    std::size_t next = mapped;
    for (int a = 0; a < Dim; ++a) {
      const bool is_other = a != options_.sphere[0] && a != options_.sphere[1];
      scales[static_cast<std::size_t>(a)] = report_.axis_scales.at(is_other ? next++ : 0);
    }
    report_.axis_scales = scales;
  }

  Fit<Dim> assemble() {
    finish_report();
    Fit<Dim> result;
    const Box<Dim> box = box_of_samples(samples_, options_);
    const auto blended = [&](std::size_t c, auto member) -> std::shared_ptr<const Field<Dim>> {
      typename SphereField<Dim>::Parts parts{options_.sphere[0], options_.sphere[1]};
      for (std::size_t k = 0; k < charts_.size(); ++k) parts.charts.push_back({charts_[k], member(fits_[k])[c]});
      if (space_) parts.space = member(*space_)[c];
      return std::make_shared<SphereField<Dim>>(std::move(parts), box);
    };
    const auto components = [](const auto& fit) -> const auto& {
      return fit.components;
    };
    const auto variances = [](const auto& fit) -> const auto& {
      return fit.variances;
    };
    const bool all_known =
        std::all_of(fits_.begin(), fits_.end(), [](const auto& f) { return !f.variances.empty(); }) &&
        (!space_ || !space_->variances.empty());
    for (std::size_t c = 0; c < static_cast<std::size_t>(samples_.components()); ++c) {
      result.components.push_back(blended(c, components));
      if (all_known) result.variances.push_back(blended(c, variances));
    }
    result.report = report_;
    return result;
  }

  Samples<Dim> samples_;
  const FitOptions& options_;
  FitOptions plane_options_;
  const FitSamples<Dim>& in_plane_;
  const FitSamples<space_dim>& in_space_;
  Points<3> u_;
  std::vector<SphereChart> charts_;
  std::vector<Fit<Dim>> fits_;
  std::optional<Fit<space_dim>> space_;
  FitReport report_;
  Index largest_ = 0;
  double squares_ = 0, squared_ = 0;
  bool noise_known_ = true;
};

}  // namespace

template <int Dim>
Box<Dim> box_of_samples(const Samples<Dim>& samples, const FitOptions& options) {
  constexpr double clearly_smaller = 0.9;
  Box<Dim> box = bounding_box<Dim>(samples.points);
  if (options.sphere.empty()) return box;
  const Index axis = options.sphere[0];
  const Eigen::VectorXd longitudes = with_usual_longitudes(samples, options.sphere[0]).points.row(axis);
  std::vector<double> sorted(longitudes.begin(), longitudes.end());
  std::sort(sorted.begin(), sorted.end());
  double gap = sorted.front() + 360 - sorted.back();
  std::size_t first = 0;
  for (std::size_t i = 1; i < sorted.size(); ++i) {
    if (!(sorted[i] - sorted[i - 1] > gap)) continue;
    gap = sorted[i] - sorted[i - 1];
    first = i;
  }
  if (!(360 - gap < clearly_smaller * box.extent()[axis])) return box;
  box.lo[axis] = sorted[first];
  box.hi[axis] = first == 0 ? sorted.back() : sorted[first - 1] + 360;
  return box;
}

void check_sphere(const FitOptions& options, int dimension) {
  if (options.sphere.empty()) return;
  const std::vector<int>& axes = options.sphere;
  const auto is_axis = [&](int a) { return a >= 0 && a < dimension; };
  require(axes.size() == 2 && is_axis(axes[0]) && is_axis(axes[1]) && axes[0] != axes[1], "fit", "sphere", axes.size(),
          "must be two of the axes, numbered from 0: longitude, latitude");
  const bool only_of_others =
      dimension >= largest_dimension && !options.drift.empty();  // which are fitted, and asked, then
  require(dimension < largest_dimension || only_of_others, "fit", "dimension", dimension,
          "with a sphere there are at most " + std::to_string(largest_dimension - 1) + " coordinates");
  if (std::ssize(options.periods) == dimension)
    for (const int a : axes)
      require(options.periods[static_cast<std::size_t>(a)] == 0, "fit", "periods",
              options.periods[static_cast<std::size_t>(a)], "longitude and latitude of a sphere need no period");
}

template <int Dim>
Fit<Dim> fit_on_sphere(const Samples<Dim>& samples, const FitOptions& options, const FitSamples<Dim>& in_plane,
                       const FitSamples<SphereField<Dim>::space_dim>& in_space) {
  if constexpr (Dim == 1 || Dim == largest_dimension) {
    throw InvalidInput("fit: sphere: needs two to " + std::to_string(largest_dimension - 1) + " coordinates");
  } else {
    for (const double latitude : samples.points.row(options.sphere[1]))
      require(std::abs(latitude) <= 90, "fit", "latitude", latitude,
              "must be from -90 to 90 degrees; sphere takes the axis of longitude first, then that of latitude");
    return SphereFit<Dim>(with_usual_longitudes(samples, options.sphere[0]), options, in_plane, in_space).fit();
  }
}

#define CSRBF_INSTANTIATE(Dim) template Box<Dim> box_of_samples<Dim>(const Samples<Dim>&, const FitOptions&);
CSRBF_FOR_MANY_DIMS(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

#define CSRBF_INSTANTIATE(Dim)                                                                         \
  template Fit<Dim> fit_on_sphere<Dim>(const Samples<Dim>&, const FitOptions&, const FitSamples<Dim>&, \
                                       const FitSamples<SphereField<Dim>::space_dim>&);
CSRBF_FOR_EACH_DIM(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
