#include "csrbf/surface/reconstruct.hpp"

#include "csrbf/core/percentile.hpp"
#include "csrbf/core/seconds_since.hpp"
#include "csrbf/implicit/combine.hpp"
#include "csrbf/implicit/combine/extend_distance.hpp"
#include "csrbf/implicit/combine/transformed_field.hpp"
#include "csrbf/spatial/farthest_points.hpp"
#include "csrbf/surface/baselines/method_fit.hpp"
#include "csrbf/surface/check/surface_distances.hpp"
#include "csrbf/surface/composite/choose_options.hpp"
#include "csrbf/surface/composite/composite_field.hpp"
#include "csrbf/surface/composite/thinnest_parts.hpp"
#include "csrbf/surface/prepare/decimate.hpp"
#include "csrbf/surface/prepare/find_normals.hpp"
#include "csrbf/surface/surface_method.hpp"

#include <iomanip>
#include <numeric>
#include <sstream>

namespace csrbf {
namespace {

// Chosen by hand unless noted.
constexpr Index fewest_coarse = 12, most_coarse = 40;  // points per patch of a coarse level; larger: smoother holes
constexpr Index most_coarse_centers = 16;              // ... and CSRBF centres, which extrapolate shape across holes
constexpr Index coarsest_points = 100;                 // a level with fewer points has no coarser one
constexpr Index finest_leaf = 6;                       // points per patch without smoothing
constexpr Index coarsest_leaf = 256;                   // points per patch where a search for a tolerance starts
constexpr Index centers_per_leaf = 2;  // of a budget; a support, with its overlap of 4, holds about four times as many
constexpr Index most_centers = 64;     // in a support, for a budget or a tolerance; more: time, conditioning
constexpr int tolerance_attempts = 6;  // each halves the error asked for where the one before missed the tolerance
constexpr double outlier_share = 0.001;    // of the samples that may miss the tolerance
constexpr double winding_smoothing = 0.7;  // spacings: the least that leaves no bumps between samples
constexpr double open_level = -0.5;        // u = 2w - 1 on the samples below which the surface is open
constexpr Index level_samples = 2000;      // at which it is measured
constexpr double disagreement = 3;         // mean distance of samples from the surface over the cross-validation error
constexpr double too_small_to_see = 1e-5;  // of the diagonal: smaller mean distances are no disagreement
constexpr Index quadric_coefficients = 10;
constexpr double across_thin_parts = 0.5;  // cells: one corner at least is between two sheets
constexpr double finest_detail = 0.25;     // spacings: thinner parts may be lost
constexpr double too_thin = 0.75;          // cells to have over those of the mesh
constexpr double visible = 6;              // least distance of two sheets over the cross-validation error
constexpr double coarsest_detail = 1.25;   // spacings: longer cells add to the held-out error (dragon, bunny scans)
constexpr double far_from_points = 0.03;   // rms distance over the diagonal; noise that strong leaves no shape

bool composite(const ReconstructOptions& options) {
  return options.method == "auto" || options.method == "composite";
}

void check_options(const ReconstructOptions& options) {
  if (!composite(options)) {
    std::string names = "unknown; use auto, composite";
    for (const SurfaceMethod& method : surface_methods()) names += std::string(", ") + method.name;
    require(find_surface_method(options.method) != nullptr, "reconstruct", "method", options.method, names);
    require(options.tolerance == 0, "reconstruct", "tolerance", options.tolerance,
            "only the method composite keeps a tolerance");
    require(!options.region, "reconstruct", "region", "(given)", "only the method composite has regions");
  }
  require(options.centers >= 0, "reconstruct", "centers", options.centers,
          "must be positive, or 0 to let the data decide");
  require(options.tolerance >= 0 && options.tolerance < 1, "reconstruct", "tolerance", options.tolerance,
          "must be a fraction of the bounding-box diagonal in [0, 1)");
  require(!options.smoothing || *options.smoothing >= 0, "reconstruct", "smoothing", options.smoothing.value_or(0),
          "must not be negative");
}

// Of the median distance of samples from the surface to their spacing: below it the surface passes through them. Chosen
// by hand, between clean clouds (at most .01) and noise of a fourth of the spacing.
constexpr double noisy_distance = 0.05;

// Patches with fewer coefficients than samples smooth: they hold no detail as small as the spacing of the samples.
double feature_size(double spacing, const CompositeOptions& options) {
  if (options.tolerance.size() > 0) return spacing;
  const auto samples = options.overlap * static_cast<double>(options.leaf_size);
  const auto coefficients = static_cast<double>(quadric_coefficients + options.centers_per_patch);
  return spacing * std::clamp(std::sqrt(samples / coefficients), 1.0, coarsest_detail);
}

// Indices of the points in the region; of all if there is none.
std::vector<Index> ids_inside(const Points<3>& points, const std::optional<Box<3>>& region) {
  std::vector<Index> ids;
  for (Index i = 0; i < points.cols(); ++i)
    if (!region || region->contains(points.col(i))) ids.push_back(i);
  return ids;
}

// What 2w - 1 is on the surface, in the median over the samples; 0 if the surface is closed.
double winding_level(const WindingNumber& winding, const Points<3>& points, const std::vector<Index>& ids) {
  const Index step = std::max<Index>(1, std::ssize(ids) / level_samples);
  std::vector<Index> chosen;
  for (Index i = 0; i < std::ssize(ids); i += step) chosen.push_back(ids[i]);
  const Points<3> some = points(Eigen::all, chosen);
  const Eigen::VectorXd u = winding.evaluate(PointsRef<3>(some)).value;
  const double level = median(std::vector(u.begin(), u.end()));
  return level < open_level ? level : 0;
}

// `thinnest`: thinnest_parts() of the cloud.
CompositeField::Data build_field(const PreparedCloud& prepared, const CompositeOptions& options, double thinnest,
                                 const Progress& progress) {
  CompositeField::Data data;
  data.origin = prepared.origin;
  data.scale = prepared.scale;
  data.bounds = prepared.bounds;
  const OrientedPoints& cloud = prepared.cloud;
  CompositeFit finest = fit_composite(cloud, *prepared.tree, options, progress);
  const std::vector<Index> inside = ids_inside(cloud.points, options.region);
  const Eigen::ArrayXd areas = finest.areas(inside).array();
  const double area = areas.sum(), spacing = std::sqrt(area / static_cast<double>(inside.size()));
  data.feature_size =
      std::min(feature_size(spacing, options), std::max(across_thin_parts * thinnest, finest_detail * spacing));
  data.far_value = CompositeField::far_spacings * (areas * areas.sqrt()).sum() / area;  // most may be in a small part
  data.levels.push_back(std::move(finest.patches));
  CompositeOptions coarse_options = options;
  coarse_options.from_outside = true;  // they say what is in gaps
  coarse_options.centers_per_patch = std::min(options.centers_per_patch, most_coarse_centers);
  coarse_options.smoothing = CompositeOptions{}.smoothing;
  coarse_options.choose_leaves = false;
  coarse_options.centers.clear();
  coarse_options.tolerance.resize(0);
  coarse_options.leaf_size = std::clamp(options.leaf_size, fewest_coarse, most_coarse);
  Index previous = cloud.size();
  for (OrientedPoints coarse = decimate(cloud); coarse.size() >= coarsest_points && 2 * coarse.size() < previous;
       coarse = decimate(coarse)) {
    data.levels.push_back(fit_composite(coarse, coarse_options).patches);
    previous = coarse.size();
  }
  const Eigen::VectorXd smoothing_length = winding_smoothing * finest.areas.cwiseSqrt();
  data.winding = WindingNumber(cloud.points, cloud.normals, finest.areas, smoothing_length);
  data.winding_level = winding_level(data.winding, cloud.points, inside);
  return data;
}

// Samples further from the surface than the tolerance, if there is one.
Index outside(const std::vector<double>& distance, double tolerance) {
  if (tolerance == 0) return 0;
  return std::count_if(distance.begin(), distance.end(), [&](double d) { return d > tolerance; });
}

// A few samples may be outliers; more mean failure.
void check_tolerance(const std::vector<double>& distance, double tolerance, ReconstructReport& out) {
  const Index missed = outside(distance, tolerance);
  if (missed == 0) return;
  if (static_cast<double>(missed) <= outlier_share * static_cast<double>(distance.size())) {
    out.warnings.push_back(std::to_string(missed) + " points are further from the surface than the tolerance");
    return;
  }
  std::ostringstream message;
  message << "reconstruct: tolerance = " << tolerance << " of the diagonal cannot be reached: " << missed
          << " points are further away (99 % within " << out.p99_distance
          << "); the samples contradict each other there: allow more, or clean them";
  throw SolverFailure(message.str());
}

// Size of the part of the cloud that a sample is on, as a median over all samples.
Index typical_body(const PreparedCloud& prepared) {
  std::vector<Index> sizes;
  Index rest = prepared.cloud.size();
  for (const std::vector<Index>& component : prepared.components) {
    sizes.push_back(static_cast<Index>(component.size()));
    rest -= sizes.back();
  }
  sizes.push_back(rest);
  std::sort(sizes.begin(), sizes.end());
  Index below = 0;
  for (const Index size : sizes)
    if (2 * (below += size) >= prepared.cloud.size()) return size;
  return rest;
}

// The region in the unit coordinates of the cloud.
std::optional<Box<3>> unit_region(const PreparedCloud& prepared, const ReconstructOptions& options) {
  if (!options.region) return std::nullopt;
  const auto to_unit = [&](const Point<3>& x) { return Point<3>((x - prepared.origin) / prepared.scale); };
  return Box<3>{to_unit(options.region->lo), to_unit(options.region->hi)};
}

// The composite options: chosen by cross-validation, within the budget or the tolerance that is asked for.
ChosenOptions choose(const PreparedCloud& prepared, const ReconstructOptions& options, Index body_size) {
  const OrientedPoints& cloud = prepared.cloud;
  GivenOptions given;
  given.smoothing = options.smoothing;
  if (options.smoothing == 0.0) given.leaf_size = finest_leaf;
  if (options.tolerance > 0) given.leaf_size = coarsest_leaf;
  if (options.centers > 0)
    given.leaf_size =
        std::max<Index>(CompositeOptions::smallest_leaf, cloud.size() * centers_per_leaf / options.centers);
  given.normal_rows = options.normal_rows;
  given.body_size = body_size;
  given.region = unit_region(prepared, options);
  ChosenOptions chosen = choose_options(cloud, *prepared.tree, given);
  chosen.options.from_outside = false;
  if (options.tolerance > 0) {
    chosen.options.tolerance.setConstant(cloud.size(), options.tolerance);
    chosen.options.centers_per_patch = most_centers;
    chosen.options.smoothing = options.smoothing.value_or(CompositeOptions{}.smoothing);
  }
  if (options.centers > 0) {
    chosen.options.centers = farthest_points<3>(cloud.points, options.centers, {.progress = options.progress}).indices;
    std::sort(chosen.options.centers.begin(), chosen.options.centers.end());
    chosen.options.centers_per_patch = most_centers;
    chosen.options.max_fit_points = 4 * CompositeOptions{}.max_fit_points;
  }
  return chosen;
}

// A field with the distances of some of the points used to its surface.
struct Surface {
  std::shared_ptr<const Field<3>> field;
  std::vector<Index> measured;
  std::vector<double> distance;
};

// That of the composite method, with its options.
struct CompositeSurface {
  ChosenOptions chosen;
  double thinnest = 0;  // see thinnest_parts(); unit coordinates
  std::shared_ptr<const CompositeField> field;
  std::vector<Index> measured;   // points used that are in the region
  std::vector<double> distance;  // of these

  [[nodiscard]] double mean_distance() const {
    return std::accumulate(distance.begin(), distance.end(), 0.0) / static_cast<double>(distance.size());
  }

  // Whether the surface is much farther from its own samples than patches are from those they were fitted without: they
  // spoil each other, as when some reach another body and those of the cross-validation happen not to.
  [[nodiscard]] bool patches_disagree() const {
    return mean_distance() > std::max(disagreement * chosen.cross_validation_error, too_small_to_see) &&
           chosen.cross_validation_error > 0 && chosen.options.leaf_size > finest_leaf;
  }
};

CompositeSurface fit_surface(const PointCloud& input, const PreparedCloud& prepared, const ReconstructOptions& options,
                             Index body_size, ReconstructReport& out) {
  CompositeSurface result;
  auto start = std::chrono::steady_clock::now();
  result.chosen = choose(prepared, options, body_size);
  result.thinnest = thinnest_parts(prepared.cloud, *prepared.tree, visible * result.chosen.cross_validation_error);
  result.measured =
      ids_inside(prepared.cloud.points.leftCols(std::ssize(prepared.source)), result.chosen.options.region);
  if (result.measured.empty()) throw InvalidInput("reconstruct: region: no point is inside; move it, or leave it out");
  out.fit_seconds += seconds_since(start);
  for (int attempt = 0; attempt < tolerance_attempts; ++attempt) {
    start = std::chrono::steady_clock::now();
    const auto field = std::make_shared<CompositeField>(
        build_field(prepared, result.chosen.options, result.thinnest, options.progress));
    out.fit_seconds += seconds_since(start);
    start = std::chrono::steady_clock::now();
    result.distance =
        surface_distances(*field, input.points(Eigen::all, prepared.sources_of(result.measured)), prepared.scale);
    const Eigen::VectorXd spacing = prepared.cloud.spacing(result.measured);
    field->set_noisy(median(std::vector(result.distance)) >
                     noisy_distance * median(std::vector(spacing.begin(), spacing.end())));
    result.field = field;
    out.evaluate_seconds += seconds_since(start);
    if (outside(result.distance, options.tolerance) == 0) break;
    for (Index i = 0; i < std::ssize(result.distance); ++i)
      if (result.distance[i] > options.tolerance) result.chosen.options.tolerance[result.measured[i]] /= 2;
  }
  return result;
}

// Says so if plates are too thin for the cells of a mesh.
void warn_of_thin_parts(const PreparedCloud& prepared, const CompositeSurface& surface, ReconstructReport& out) {
  const double thinnest = prepared.scale * surface.thinnest;
  if (!(across_thin_parts * thinnest < too_thin * surface.field->feature_size())) return;
  const double cells = prepared.bounds.extent().maxCoeff() / (across_thin_parts * thinnest);
  std::ostringstream message;
  message << "plates of thickness " << std::setprecision(2) << thinnest
          << " are too thin for the mesh, which may have holes there; its resolution should be " << std::setprecision(9)
          << std::ceil(cells);
  out.warnings.push_back(message.str());
}

Surface reconstruct_composite(const PointCloud& input, const PreparedCloud& prepared, const ReconstructOptions& options,
                              ReconstructReport& out) {
  CompositeSurface best = fit_surface(input, prepared, options, typical_body(prepared), out);
  const bool free_to_choose = options.tolerance == 0 && options.centers == 0 && options.smoothing != 0.0;
  while (free_to_choose && best.patches_disagree()) {
    const Index half_as_large = leaves_of_body * best.chosen.options.leaf_size / 2;
    CompositeSurface smaller = fit_surface(input, prepared, options, half_as_large, out);
    if (smaller.mean_distance() > best.mean_distance() / 2) break;
    best = std::move(smaller);
  }
  const ChosenOptions& chosen = best.chosen;
  const Patches& finest = best.field->data().levels.front();
  out.method = "composite";
  out.centers = chosen.options.centers.empty() ? finest.centers() : static_cast<Index>(chosen.options.centers.size());
  out.smoothing = chosen.options.smoothing;
  out.composite = {.patches = finest.size(),
                   .levels = static_cast<Index>(best.field->data().levels.size()),
                   .settings = static_cast<const CompositeSettings&>(chosen.options),
                   .cross_validation_error = chosen.cross_validation_error};
  warn_of_thin_parts(prepared, best, out);
  return {best.field, std::move(best.measured), std::move(best.distance)};
}

Surface reconstruct_by(const SurfaceMethod& method, const PointCloud& input, const PreparedCloud& prepared,
                       const ReconstructOptions& options, ReconstructReport& out) {
  auto start = std::chrono::steady_clock::now();
  const MethodFit fit = method.fit(prepared, {options.centers, options.smoothing, options.progress});
  const auto field = std::make_shared<const TransformedField>(TransformedField::Data{
      fit.field, prepared.origin, prepared.scale, prepared.scale * prepared.cloud.spacing.mean(), prepared.bounds});
  out.fit_seconds = seconds_since(start);
  start = std::chrono::steady_clock::now();
  std::vector<double> distance = surface_distances(*field, input.points(Eigen::all, prepared.source), prepared.scale);
  out.evaluate_seconds = seconds_since(start);
  if (options.centers > 0 && !method.has_budget)
    out.warnings.push_back(std::string("the method ") + method.name +
                           " has no budget of centers: that given is ignored");
  if (options.smoothing && !method.smooths)
    out.warnings.push_back(std::string("the method ") + method.name + " has no smoothing: that given is ignored");
  out.method = method.name;
  out.centers = fit.centers;
  out.smoothing = fit.smoothing;
  return {field, ids_inside(prepared.cloud.points.leftCols(std::ssize(prepared.source)), std::nullopt),
          std::move(distance)};
}

}  // namespace

const char* name_of(NormalSource source) {
  constexpr const char* names[] = {"file", "estimated", "re-oriented", "corrected", "within the slices"};
  return names[static_cast<int>(source)];
}

void ReconstructReport::set_distances(const std::vector<double>& distance) {
  double sum = 0;
  for (const double d : distance) sum += d * d;
  rms_distance = std::sqrt(sum / static_cast<double>(distance.size()));
  max_distance = *std::max_element(distance.begin(), distance.end());
  const auto rank = static_cast<std::ptrdiff_t>(0.99 * static_cast<double>(distance.size() - 1));
  p99_distance = order_statistic(std::vector<double>(distance), rank);
}

Reconstruction reconstruct(const PointCloud& input, const ReconstructOptions& options) {
  check_options(options);
  Reconstruction result;
  ReconstructReport& out = result.report;
  const auto start = std::chrono::steady_clock::now();
  PreparedCloud prepared = prepare(input, options.normals, options.progress, options.region);
  if (!options.region) warn_of_sparse_parts(prepared);
  out.prepare_seconds = seconds_since(start);

  Surface surface = composite(options)
                        ? reconstruct_composite(input, prepared, options, out)
                        : reconstruct_by(*find_surface_method(options.method), input, prepared, options, out);
  out.set_distances(surface.distance);
  if (!std::isfinite(out.rms_distance))
    throw SolverFailure("reconstruct: method = " + options.method +
                        " finds no finite surface for these points; use another one, such as auto");
  check_tolerance(surface.distance, options.tolerance, out);
  if (out.rms_distance > far_from_points)
    out.warnings.emplace_back(
        "the surface is far from the points: they are too few for its shape, or their normals wrong");

  out.normals = prepared.normals;
  out.points = input.size();
  out.points_used = static_cast<Index>(prepared.source.size());
  out.warnings.insert(out.warnings.begin(), prepared.warnings.begin(), prepared.warnings.end());
  result.field = std::move(surface.field);
  result.source = std::move(prepared.source);
  result.measured = std::move(surface.measured);
  result.distance = std::move(surface.distance);
  result.normals = prepared.cloud.normals.leftCols(static_cast<Index>(result.source.size()));
  return result;
}

Reconstruction reconstruct(std::span<const std::array<double, 3>> points,
                           std::span<const std::array<double, 3>> normals, const ReconstructOptions& options) {
  require(normals.empty() || normals.size() == points.size(), "reconstruct", "number of normals", normals.size(),
          "must be that of the points, " + std::to_string(points.size()) + ", or 0");
  PointCloud cloud;
  cloud.points = as_points<3>(points);
  cloud.normals = as_points<3>(normals);
  return reconstruct(cloud, options);
}

PolygonizeMethod mesh_method(const Field<3>& field) {
  if (const auto* extended = dynamic_cast<const ExtendedField*>(&field)) return mesh_method(*extended->data().inner);
  if (const auto* combined = dynamic_cast<const CombinedField*>(&field)) {
    const auto& terms = combined->data().terms;
    const bool is_sharp = std::all_of(terms.begin(), terms.end(), [](const CombinedField::Term& term) {
      return mesh_method(*term.solid) == PolygonizeMethod::dual_contouring;
    });
    return is_sharp ? PolygonizeMethod::dual_contouring : PolygonizeMethod::marching_cubes;
  }
  const auto* composite = dynamic_cast<const CompositeField*>(&field);
  return composite != nullptr && !composite->data().noisy ? PolygonizeMethod::dual_contouring
                                                          : PolygonizeMethod::marching_cubes;
}

}  // namespace csrbf
