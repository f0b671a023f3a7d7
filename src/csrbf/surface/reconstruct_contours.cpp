#include "csrbf/surface/reconstruct_contours.hpp"

#include "csrbf/approx/basis/expansion.hpp"
#include "csrbf/core/seconds_since.hpp"
#include "csrbf/implicit/combine.hpp"
#include "csrbf/implicit/combine/transformed_field.hpp"
#include "csrbf/surface/check/surface_distances.hpp"
#include "csrbf/surface/contours/contour_fit.hpp"

namespace csrbf {
namespace {

// Chosen by hand.
constexpr double margin = 0.05;               // of the diagonal, around the contours: surfaces bulge between slices
constexpr double smallest_feature = 0.5;      // size of the smallest features, in spacings of the contour points used
constexpr double rim = 1;                     // range of the blend at a cap, in heights of the cap above the last slice
constexpr double sharpness = 3;               // exponent of the super-elliptic blend at a cap; larger: sharper rims
constexpr double smoothing_of_pixels = 1e-3;  // lambda for jagged contours: within the range in the header

void check_contour_options(const ContourOptions& options) {
  require(options.centers >= 16, "reconstruct_contours", "centers", options.centers, "must be at least 16");
  const double smoothing = options.smoothing.value_or(0);
  require(smoothing >= 0 && std::isfinite(smoothing), "reconstruct_contours", "smoothing", smoothing,
          "must be finite and not negative");
}

// The contours in unit coordinates, by slices.
struct PreparedContours {
  std::vector<ContourLoop> loops;
  std::vector<Index> source;
  Box<3> box;
  Points<3> points{3, 0};
  Slices slices;
};

PreparedContours prepare(const Polylines& contours, std::vector<std::string>& warnings) {
  PreparedContours result;
  result.loops = contour_loops(contours, warnings);
  for (const ContourLoop& loop : result.loops) result.source.insert(result.source.end(), loop.begin(), loop.end());
  require(!result.loops.empty(), "reconstruct_contours", "contours", "none",
          "at least two closed curves of three points or more are needed");
  result.box = bounding_box<3>(contours.vertices(Eigen::all, result.source));
  require(result.box.diagonal() > 0, "reconstruct_contours", "contours", "one point", "contours must enclose an area");
  result.points = (contours.vertices.colwise() - result.box.center()) / result.box.diagonal();
  result.slices = gather_slices(result.points, result.loops);
  require(result.slices.slices.size() > 1, "reconstruct_contours", "slices", result.slices.slices.size(),
          "contours of at least two planes are needed");
  return result;
}

double choose_smoothing(const PreparedContours& prepared, std::vector<std::string>& warnings) {
  if (!are_jagged(prepared.points, prepared.loops)) return 0;
  warnings.emplace_back("the contours are jagged and were smoothed");
  return smoothing_of_pixels;
}

// Height of the cap minus height above the last slice: a linear field.
std::shared_ptr<const Field<3>> below(const Cap& cap, const Box<3>& bounds) {
  const PolynomialTail<3> plane{1, cap.position, 1,
                                Eigen::Vector4d(0, -cap.outward.x(), -cap.outward.y(), -cap.outward.z())};
  const auto nothing = std::make_shared<const RadialBasis<3>>(Kernel("wendland-c2", 3), cap.position,
                                                              Eigen::VectorXd::Constant(1, cap.height));
  return std::make_shared<const Expansion<3>>(nothing, Eigen::VectorXd::Zero(1), plane, bounds);
}

std::shared_ptr<const Field<3>> closed(const ContourFit& fit, const PreparedContours& prepared) {
  const double scale = prepared.box.diagonal();
  Box<3> bounds = fit.field->bounds().inflated(margin);
  for (const Cap& cap : fit.caps) bounds.add(cap.position);
  const auto place = [&](std::shared_ptr<const Field<3>> field, const Points<3>& seeds) {
    const Point<3> origin = prepared.box.center();
    Box<3> box;
    box.add(scale * bounds.lo + origin);
    box.add(scale * bounds.hi + origin);
    return std::make_shared<const TransformedField>(TransformedField::Data{std::move(field), origin, scale,
                                                                           scale * smallest_feature * fit.spacing, box,
                                                                           (scale * seeds).colwise() + origin});
  };
  const auto surface = place(fit.field, fit.seeds);
  if (fit.caps.empty()) return surface;
  // The intersection with the half-spaces below the caps: the complement of the union of the complements.
  CombinedField::Data data{{{surface, true}}, true, Blending::super_elliptic, 0, sharpness};
  double lowest = fit.caps.front().height;
  for (const Cap& cap : fit.caps) {
    data.terms.push_back({place(below(cap, bounds), cap.position), true});
    lowest = std::min(lowest, cap.height);
  }
  data.range = scale * rim * lowest;
  return std::make_shared<const CombinedField>(std::move(data));
}

Points<3> outward_normals(const Field<3>& field, const PointsRef<3>& at) {
  return -field.evaluate(at, Derivatives::gradient).gradient.colwise().normalized();
}

}  // namespace

Reconstruction reconstruct_contours(const Polylines& contours, const ContourOptions& options) {
  check_contour_options(options);
  Reconstruction result;
  ReconstructReport& out = result.report;
  auto start = std::chrono::steady_clock::now();
  PreparedContours prepared = prepare(contours, out.warnings);
  out.prepare_seconds = seconds_since(start);
  out.smoothing = options.smoothing ? *options.smoothing : choose_smoothing(prepared, out.warnings);
  start = std::chrono::steady_clock::now();
  const ContourFit fit = fit_contours(prepared.points, prepared.loops, prepared.slices,
                                      {options.centers, out.smoothing, options.progress});
  result.field = closed(fit, prepared);
  out.fit_seconds = seconds_since(start);
  start = std::chrono::steady_clock::now();
  const Points<3> used = contours.vertices(Eigen::all, prepared.source);
  result.normals = outward_normals(*result.field, used);
  out.set_distances(surface_distances(*result.field, used, prepared.box.diagonal()));
  out.evaluate_seconds = seconds_since(start);

  out.method = "contours";
  out.normals = NormalSource::within_slices;
  out.points = contours.vertices.cols();
  out.points_used = used.cols();
  out.centers = fit.centers;
  out.contours = {.contours = static_cast<Index>(prepared.loops.size()),
                  .slices = static_cast<Index>(prepared.slices.slices.size()),
                  .caps = static_cast<Index>(fit.caps.size())};
  result.source = std::move(prepared.source);
  return result;
}

}  // namespace csrbf
