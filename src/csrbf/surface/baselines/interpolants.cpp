#include "csrbf/approx/basis/expansion.hpp"
#include "csrbf/approx/global/interpolate.hpp"
#include "csrbf/approx/global/kriging_variance.hpp"
#include "csrbf/approx/samples/spacing.hpp"
#include "csrbf/core/small_matrices.hpp"
#include "csrbf/linalg/ridge.hpp"
#include "csrbf/surface/baselines/baselines.hpp"
#include "csrbf/surface/baselines/off_surface.hpp"

namespace csrbf::baselines {
namespace {

// Chosen by hand.
constexpr Index most_dense = 1000;  // default number of centres for methods with dense systems ...
constexpr double residual = 1e-3;   // of systems solved by fast sums, in spacings of the points kept
constexpr double least_residual = 1e-9, largest_residual = 1e-2;  // of these, in units of the largest value
constexpr Index most_sparse = 3000;                               // ... and with sparse ones: a few seconds
constexpr double morse_support = 4;     // spacings of the centres: a support has about 50 of them, and their offsets
constexpr double carrier_radius = 0.5;  // diagonals: the ball around the cloud
constexpr Index dinh_neighbors = 16;    // from which the shape of the surface at a centre is estimated
constexpr double least_stretch = 0.5;   // least semi-axis of a basis function, across a flat part; 1 along the surface
constexpr double dinh_length = 4;       // of the basis functions, in spacings of the centres
constexpr double dinh_ridge = 1e-8;     // default smoothing: keeps the dense system well conditioned

Index budget(const MethodOptions& options, const PreparedCloud& cloud, Index most) {
  return std::min(options.centers > 0 ? options.centers : most, cloud.cloud.size());
}

MethodFit interpolant(const Samples<3>& samples, const InterpolateOptions& options) {
  const Interpolation<3> result = interpolate<3>(samples, options);
  return {result.components.front(), samples.size(), result.report.smoothing};
}

// All points unless there is a budget.
Index all_or_budget(const MethodOptions& options, const PreparedCloud& cloud) {
  return options.centers > 0 ? std::min(options.centers, cloud.cloud.size()) : cloud.cloud.size();
}

// For values whose errors move the surface by as much: the first `count` samples are points of the cloud.
InterpolateOptions polyharmonic(const char* kernel, const Samples<3>& samples, Index count,
                                const MethodOptions& options) {
  const Points<3> kept = samples.points.leftCols(count);
  const double error = residual * center_spacing<3>(kept, kept);
  return {.kernel = kernel,
          .smoothing = options.smoothing.value_or(0),
          .tolerance = std::clamp(error / samples.values.cwiseAbs().maxCoeff(), least_residual, largest_residual),
          .progress = options.progress};
}

// Transforms space so that the basis function of a centre is a ball where its neighbours fill space, a disc where they
// lie on a plane, and a needle along an edge.
Eigen::Matrix3d stretch(const Points<3>& around) {
  const Points<3> centered = around.colwise() - around.rowwise().mean();
  const Eigen::Matrix3d moments = centered * centered.transpose();
  const SymmetricEigen eigen = symmetric_eigen(moments);
  const Eigen::Matrix3d axes = eigen.vectors;
  const Eigen::Vector3d widths =
      (eigen.values.cwiseMax(0).cwiseSqrt() / std::sqrt(eigen.values[2])).cwiseMax(least_stretch);
  return axes * widths.cwiseInverse().asDiagonal() * axes.transpose();
}

}  // namespace

MethodFit carr(const PreparedCloud& cloud, const MethodOptions& options) {
  const Index count = all_or_budget(options, cloud);
  const Samples<3> samples = off_surface_samples(cloud, count, Offsets::both);
  return interpolant(samples, polyharmonic("linear", samples, count, options));
}

MethodFit turk_obrien(const PreparedCloud& cloud, const MethodOptions& options) {
  const Index count = all_or_budget(options, cloud);
  const Samples<3> samples = off_surface_samples(cloud, count, Offsets::inside);
  return interpolant(samples, polyharmonic("cubic", samples, count, options));
}

MethodFit savchenko(const PreparedCloud& cloud, const MethodOptions& options) {
  const Index count = all_or_budget(options, cloud);
  Samples<3> samples = off_surface_samples(cloud, count, Offsets::none);
  // Carrier: positive inside a ball about the cloud, of slope 1 on it. A polynomial, so that the sum is an expansion.
  const auto carrier = [](const Point<3>& x) {
    return (carrier_radius * carrier_radius - x.squaredNorm()) / (2 * carrier_radius);
  };
  const Point<3> middle = bounding_box<3>(samples.points).center();
  for (Index i = 0; i < samples.size(); ++i) samples.values(i, 0) = -carrier(samples.points.col(i) - middle);
  const Interpolation<3> spline = interpolate<3>(samples, polyharmonic("cubic", samples, count, options));
  const Expansion<3>& f = *spline.components.front();
  PolynomialTail<3> tail{2, f.tail().origin, f.tail().scale, Eigen::VectorXd::Zero(10)};
  tail.coefficients.head(f.tail().coefficients.size()) = f.tail().coefficients;
  const Point<3> shift = tail.origin - middle;  // x - middle = scale q + shift
  tail.coefficients[0] += carrier(shift);
  tail.coefficients.segment<3>(1) -= tail.scale / carrier_radius * shift;
  for (const int square : {4, 7, 9}) tail.coefficients[square] -= tail.scale * tail.scale / (2 * carrier_radius);
  return {std::make_shared<const Expansion<3>>(f.shared_basis(), f.coefficients(), tail), samples.size(),
          spline.report.smoothing};
}

MethodFit morse(const PreparedCloud& cloud, const MethodOptions& options) {
  const Index count = budget(options, cloud, most_sparse);
  const Samples<3> samples = off_surface_samples(cloud, count, Offsets::both);
  const Points<3> centers = samples.points.leftCols(count);
  return interpolant(samples, {.kernel = "wendland-c2",
                               .support = morse_support * center_spacing<3>(centers, centers),
                               .smoothing = options.smoothing.value_or(0),
                               .degree = -1,
                               .progress = options.progress});
}

MethodFit dinh(const PreparedCloud& cloud, const MethodOptions& options) {
  const Index count = budget(options, cloud, most_dense);
  const Samples<3> samples = off_surface_samples(cloud, count, Offsets::both);
  const Points<3> centers = samples.points.leftCols(count);
  const KdTree<3> tree(centers);
  RadialMetric<3> metric;
  std::vector<Index> ids(dinh_neighbors);
  std::vector<double> squared(ids.size());
  for (Index i = 0; i < count; ++i) {
    const Index found = tree.nearest(centers.col(i), dinh_neighbors, ids.data(), squared.data());
    metric.transforms.push_back(stretch(centers(Eigen::all, std::vector<Index>(ids.begin(), ids.begin() + found))));
  }
  const Eigen::VectorXd length = Eigen::VectorXd::Constant(1, dinh_length * center_spacing<3>(centers, centers));
  const auto basis = std::make_shared<const RadialBasis<3>>(Kernel("matern-c4", 3), centers, length, metric);
  const RidgeFit fit =
      ridge(basis->dense_matrix(samples.points), samples.values, {.lambda0 = options.smoothing.value_or(dinh_ridge)});
  return {std::make_shared<const Expansion<3>>(basis, fit.coefficients.col(0)), count, fit.lambda0};
}

}  // namespace csrbf::baselines
