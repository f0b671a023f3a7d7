#include "csrbf/surface/patch_fitter.hpp"

#include "csrbf/kernels/wendland.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include <numbers>

namespace csrbf {
namespace {

constexpr double compatible_normals = 0.2;  // cosine: 78 degrees
constexpr Index fewest_fit_points = 8;      // twice what a quadric needs
constexpr double ridge_quadric = 1e-6;      // relative; makes a planar patch planar
constexpr double round_off = 1e-13;         // relative; keeps the normal matrices positive definite
constexpr double inner = 0.5;               // squared radius where the blending weight is above 1 / 16
constexpr double smallest_slope = 1e-3;     // of a model that ignores its normals
constexpr double inverse_support2 = 1.0 / (Patches::support * Patches::support);

// Rows of the quadric at q: value, then the three derivatives.
using QuadricRows = Eigen::Matrix<double, 4, 10>;
QuadricRows quadric_rows(const Point<3>& q) {
  const double x = q[0], y = q[1], z = q[2];
  QuadricRows rows;
  rows << 1, x, y, z, x * x, x * y, x * z, y * y, y * z, z * z,  //
      0, 1, 0, 0, 2 * x, y, z, 0, 0, 0,                          //
      0, 0, 1, 0, 0, x, 0, 2 * y, z, 0,                          //
      0, 0, 0, 1, 0, 0, x, 0, y, 2 * z;
  return rows;
}

// The kernel of the residual as a function of r^2, and its phi' / r.
const Wendland kernel(3, 2);
double phi(double r2) {
  return kernel.value(std::sqrt(r2));
}
double phi_slope(double r2) {
  return kernel.g(std::sqrt(r2));
}

}  // namespace

Point<3> FittedPatch::step_to_surface(const Point<3>& x) const {
  const Point<3> q = patch.T * (x - patch.center);
  Eigen::Vector4d f = quadric_rows(q) * patch.quadric;
  for (Index j = 0; j < alpha.size(); ++j) {
    const Point<3> d = q - centers.col(j);
    const double r2 = inverse_support2 * d.squaredNorm();
    f[0] += alpha[j] * phi(r2);
    f.tail<3>() += alpha[j] * inverse_support2 * phi_slope(r2) * d;
  }
  const Point<3> slope = f.tail<3>();
  const double squared = std::max(slope.squaredNorm(), smallest_slope * smallest_slope);
  return (-f[0] * patch.radius * patch.radius / squared) * (patch.T.transpose() * slope);
}

FittedPatch PatchFitter::fit(const Index* ids, Index n) {
  FittedPatch result;
  frame(ids, n, result.patch);
  gather(ids, n, result.patch);
  thin();
  choose_centers();
  localize(result.patch);
  fit_quadric(result.patch);
  fit_residual(result);
  return result;
}

// Centre, axes and radius of the patch over the leaf `ids`.
void PatchFitter::frame(const Index* ids, Index n, Patch& patch) const {
  Point<3> center = Point<3>::Zero(), normal = Point<3>::Zero();
  double area = 0;
  for (Index i = 0; i < n; ++i) {
    center += cloud_.points.col(ids[i]);
    normal += cloud_.normals.col(ids[i]);
    area += cloud_.spacing[ids[i]] * cloud_.spacing[ids[i]];
  }
  patch.center = center / static_cast<double>(n);
  if (!(normal.norm() > 0)) normal = cloud_.normals.col(ids[0]);
  normal.normalize();
  double reach2 = 0;
  Point<3> farthest = Point<3>::Zero();
  for (Index i = 0; i < n; ++i) {
    const Point<3> d = cloud_.points.col(ids[i]) - patch.center;
    const Point<3> tangential = d - d.dot(normal) * normal;
    if (tangential.squaredNorm() >= farthest.squaredNorm()) farthest = tangential;
    reach2 = std::max(reach2, d.squaredNorm());
  }
  // Axes that turn with the cloud: the first towards the farthest point of the leaf.
  Point<3> first = farthest.norm() > 0 ? Point<3>(farthest.normalized()) : normal.unitOrthogonal();
  first = (first - first.dot(normal) * normal).normalized();
  patch.T.row(0) = first;
  patch.T.row(1) = normal.cross(first);
  patch.T.row(2) = normal;
  patch.radius = std::max(std::sqrt(options_.overlap * area / std::numbers::pi), 1.3 * std::sqrt(reach2));
}

// Points of the support with compatible normals; the support grows until there are enough of them.
void PatchFitter::gather(const Index* ids, Index n, Patch& patch) {
  const Point<3> normal = patch.T.row(2).transpose();
  const Index wanted = std::min<Index>(fewest_fit_points, cloud_.size());
  for (int attempt = 0; attempt < 12; ++attempt) {
    tree_.within(patch.center, patch.radius, support_);
    const auto same_sheet = [&](Index i) { return cloud_.normals.col(i).dot(normal) > compatible_normals; };
    const auto foreign = std::stable_partition(support_.begin(), support_.end(), same_sheet);
    foreign_.assign(foreign, support_.end());
    support_.erase(foreign, support_.end());
    if (static_cast<Index>(support_.size()) >= wanted) break;
    patch.radius *= 1.25;
  }
  if (support_.empty()) support_.assign(ids, ids + n);
  area_per_sample_ = std::numbers::pi * patch.radius * patch.radius / static_cast<double>(support_.size());
  double height = 0;
  for (const Index i : support_) height = std::max(height, std::abs(normal.dot(cloud_.points.col(i) - patch.center)));
  patch.flatness = 1.0 / std::clamp(1.5 * height / patch.radius, 0.8, 1.0);
  patch.T /= patch.radius;
}

// Every stride-th point, and all candidates for centres.
void PatchFitter::thin() {
  const auto count = static_cast<Index>(support_.size());
  if (count <= options_.max_fit_points) return;
  const Index stride = (count + options_.max_fit_points - 1) / options_.max_fit_points;
  std::size_t kept = 0;
  for (Index k = 0; k < count; ++k) {
    const Index i = support_[static_cast<std::size_t>(k)];
    if (k % stride == 0 || std::binary_search(options_.centers.begin(), options_.centers.end(), i))
      support_[kept++] = i;
  }
  support_.resize(kept);
}

// Samples of another sheet count too: there the patch spoils the blend by its distance from them.
bool PatchFitter::within_tolerance(const FittedPatch& patch) const {
  const auto meets = [&](Index i) {
    Point<3> q = patch.patch.T * (cloud_.points.col(i) - patch.patch.center);
    q[2] *= patch.patch.flatness;
    return q.squaredNorm() >= inner || patch.step_to_surface(cloud_.points.col(i)).norm() <= options_.tolerance[i];
  };
  return std::all_of(support_.begin(), support_.end(), meets) && std::all_of(foreign_.begin(), foreign_.end(), meets);
}

// The candidates in the support, evenly thinned to the number allowed.
void PatchFitter::choose_centers() {
  centers_.clear();
  for (std::size_t k = 0; k < support_.size(); ++k)
    if (options_.centers.empty() || std::binary_search(options_.centers.begin(), options_.centers.end(), support_[k]))
      centers_.push_back(static_cast<Index>(k));
  const auto count = static_cast<Index>(centers_.size()), kept = std::min(options_.centers_per_patch, count);
  for (Index j = 0; j < kept; ++j)
    centers_[static_cast<std::size_t>(j)] = centers_[static_cast<std::size_t>(j * count / kept)];
  centers_.resize(static_cast<std::size_t>(kept));
}

void PatchFitter::localize(const Patch& patch) {
  const auto count = static_cast<Index>(support_.size());
  q_.resize(3, count);
  target_.resize(3, count);
  weight_.resize(count);
  offset_.resize(count);
  for (Index k = 0; k < count; ++k) {
    const Index i = support_[static_cast<std::size_t>(k)];
    q_.col(k) = patch.T * (cloud_.points.col(i) - patch.center);
    target_.col(k) = -patch.radius * (patch.T * cloud_.normals.col(i));
    offset_[k] = 0.5 * cloud_.spacing[i] / patch.radius;
    const double s = std::max(0.0, 1 - q_.col(k).squaredNorm());
    weight_[k] = s * s + 1e-3;  // wider than the blending weight: the rim of the patch is used too
  }
}

// Spec 5.3: sum_k w_k ( g(q_k)^2 + rho |grad g(q_k) + n_k|^2 ) + mu |A|^2 over quadrics g(q) = q.A q + b.q + c.
void PatchFitter::fit_quadric(Patch& patch) const {
  Eigen::Matrix<double, 10, 10> A = Eigen::Matrix<double, 10, 10>::Zero();
  Eigen::Matrix<double, 10, 1> b = Eigen::Matrix<double, 10, 1>::Zero();
  const double rho = options_.normal_weight;
  for (Index k = 0; k < q_.cols(); ++k) {
    const QuadricRows rows = quadric_rows(q_.col(k));
    const Eigen::Matrix<double, 10, 4> weighted =
        rows.transpose() * (weight_[k] * Eigen::Vector4d(1, rho, rho, rho)).asDiagonal();
    A.noalias() += weighted * rows;
    b.noalias() += weighted.rightCols<3>() * target_.col(k);
  }
  const double total = weight_.sum();
  for (const int square : {4, 7, 9}) A(square, square) += ridge_quadric * total;
  for (const int mixed : {5, 6, 8}) A(mixed, mixed) += 2 * ridge_quadric * total;
  A.diagonal().array() += round_off * total;
  patch.quadric = A.ldlt().solve(b);
}

// Weighted rows of the residual for values and normals: B alpha = s - g, grad B alpha = -n - grad g.
void PatchFitter::gradient_rows(const FittedPatch& result) {
  const Index K = q_.cols(), M = result.centers.cols();
  rows_.resize(4 * K, M);
  rhs_.resize(4 * K);
  const double root_rho = std::sqrt(options_.normal_weight);
  for (Index k = 0; k < K; ++k) {
    const double root_w = std::sqrt(weight_[k]), root_g = root_w * root_rho;
    const Eigen::Vector4d g = quadric_rows(q_.col(k)) * result.patch.quadric;
    rhs_[4 * k] = -root_w * g[0];
    rhs_.segment<3>(4 * k + 1) = root_g * (target_.col(k) - g.tail<3>());
    for (Index j = 0; j < M; ++j) {
      const Point<3> d = q_.col(k) - result.centers.col(j);
      const double r2 = inverse_support2 * d.squaredNorm();
      rows_(4 * k, j) = root_w * phi(r2);
      rows_.col(j).segment<3>(4 * k + 1) = (root_g * inverse_support2 * phi_slope(r2)) * d;
    }
  }
}

// The same with values beside the surface instead of gradients: the targets at q + side kappa n are -side kappa.
void PatchFitter::off_surface_rows(const FittedPatch& result) {
  const Index K = q_.cols(), M = result.centers.cols();
  rows_.resize(3 * K, M);
  rhs_.resize(3 * K);
  for (Index k = 0; k < K; ++k)
    for (int side = -1; side <= 1; ++side) {
      const Index row = 3 * k + side + 1;
      const Point<3> q = q_.col(k) - side * offset_[k] * target_.col(k);
      const double root_w = std::sqrt(weight_[k]);
      rhs_[row] = root_w * (-side * offset_[k] - quadric_rows(q).row(0).dot(result.patch.quadric));
      for (Index j = 0; j < M; ++j)
        rows_(row, j) = root_w * phi(inverse_support2 * (q - result.centers.col(j)).squaredNorm());
    }
}

// Eq. (6.10): (B^T W B + lambda K) alpha = B^T W (s - g), K the kernel matrix of the centres.
void PatchFitter::fit_residual(FittedPatch& result) {
  const auto M = static_cast<Index>(centers_.size());
  if (M == 0) return;
  result.centers = q_(Eigen::all, centers_);
  if (options_.normal_rows == NormalRows::gradient) {
    gradient_rows(result);
  } else {
    off_surface_rows(result);
  }
  A_.setZero(M, M);
  A_.selfadjointView<Eigen::Lower>().rankUpdate(rows_.transpose());
  const double scale = A_.trace() / static_cast<double>(M);
  for (Index j = 0; j < M; ++j)
    for (Index i = j; i < M; ++i)
      A_(i, j) += options_.smoothing * scale *
                  phi(inverse_support2 * (result.centers.col(i) - result.centers.col(j)).squaredNorm());
  A_.diagonal().array() += round_off * scale;
  result.alpha = A_.selfadjointView<Eigen::Lower>().ldlt().solve(rows_.transpose() * rhs_);
}

}  // namespace csrbf
