#include "csrbf/surface/composite/patch_fitter.hpp"

#include "csrbf/linalg/gram.hpp"
#include "csrbf/surface/composite/patch_kernel.hpp"
#include "csrbf/surface/composite/patch_rows.hpp"

#include <Eigen/Geometry>

#include <numbers>

namespace csrbf {
namespace {

// Chosen by hand unless noted.
constexpr double compatible_normals = 0.2;  // cosine of 78 degrees; larger: loses creases, smaller: joins thin sheets
constexpr Index fewest_fit_points = 8;      // with their normals 32 conditions for the 10 coefficients of a quadric
constexpr double ridge_quadric = 1e-6;      // relative to the weights; makes a planar patch planar
constexpr double round_off = 1e-13;         // relative; keeps the normal matrices positive definite
constexpr double inner_weight_variable = 0.65;  // d^2 below which the blending weight (1 - d^2)^4 exceeds 1/64
constexpr double opposite_normals = -0.5;       // cosine of 120 degrees: noise rarely turns normals that far
constexpr double own_weight = 1;                // approximate sum of the weights of a sample's own patches
constexpr double smallest_freedom = 0.01;  // floor of 1 - leverage, for a sample that determines its own prediction
constexpr int newton_steps = 3;            // from the tangent plane to the surface of a patch
constexpr double least_height = 0.9;       // least normal semi-axis of a patch over its radius; 1 at most
constexpr double smallest_slope = 1e-3;    // floor of |grad f|, which is 1 for a model that follows its normals

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

// d^2, of which the blending weight is (1 - d^2)^4.
double weight_variable(const Patch& patch, const Point<3>& x) {
  Point<3> q = patch.T * (x - patch.center);
  q[2] *= patch.flatness;
  return q.squaredNorm();
}

}  // namespace

Eigen::Vector4d FittedPatch::evaluate(const Point<3>& q) const {
  Eigen::Vector4d f = quadric_rows(q) * patch.quadric;
  for (Index j = 0; j < alpha.size(); ++j) {
    const Point<3> d = q - centers.col(j);
    const double d2 = d.squaredNorm();
    f[0] += alpha[j] * patch_kernel::value(d2);
    f.tail<3>() += alpha[j] * patch_kernel::slope(d2) * d;
  }
  return f;
}

Point<3> FittedPatch::step_to_surface(const Point<3>& x) const {
  const Eigen::Vector4d f = evaluate(patch.T * (x - patch.center));
  const Point<3> slope = f.tail<3>();
  const double squared = std::max(slope.squaredNorm(), smallest_slope * smallest_slope);
  return (-f[0] * patch.radius * patch.radius / squared) * (patch.T.transpose() * slope);
}

void FittedPatch::pack(ByteWriter& out) const {
  out.put(patch.center.data(), patch.center.size());
  out.put(patch.T.data(), patch.T.size());
  out.put(patch.radius);
  out.put(patch.flatness);
  out.put(patch.quadric.data(), patch.quadric.size());
  out.put(alpha.size());
  out.put(centers.data(), centers.size());
  out.put(alpha.data(), alpha.size());
}

void FittedPatch::unpack(ByteReader& in) {
  in.take(patch.center.data(), patch.center.size());
  in.take(patch.T.data(), patch.T.size());
  patch.radius = in.take<double>();
  patch.flatness = in.take<double>();
  in.take(patch.quadric.data(), patch.quadric.size());
  alpha.resize(in.take<Index>());
  centers.resize(3, alpha.size());
  in.take(centers.data(), centers.size());
  in.take(alpha.data(), alpha.size());
}

double FittedPatch::distance(const Point<3>& x) const {
  const Point<3> target = patch.T * (x - patch.center);
  Point<3> q(target[0], target[1], 0);
  Eigen::Vector4d f = evaluate(q);
  for (int step = 0; step < newton_steps; ++step) {
    q[2] = std::clamp(q[2] - f[0] / std::min(f[3], -smallest_slope), -1.0, 1.0);
    f = evaluate(q);
  }
  return patch.radius * std::abs(target[2] - q[2]) * std::abs(f[3]) / std::max(f.tail<3>().norm(), smallest_slope);
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
  // At least 1.3 times the extent of the leaf, so that its own samples have weight.
  patch.radius = std::max(std::sqrt(options_.overlap * area / std::numbers::pi), 1.3 * std::sqrt(reach2));
}

// Points of the support with compatible normals. The support grows by 1.25 until there are enough of them, at most 12
// times: 15-fold.
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
  patch.flatness = 1.0 / std::clamp(1.5 * height / patch.radius, least_height, 1.0);
  patch.T /= patch.radius;
}

// Every stride-th point, and all candidates for centres.
void PatchFitter::thin() {
  const auto count = static_cast<Index>(support_.size());
  if (count <= options_.max_fit_points) return;
  const Index stride = (count + options_.max_fit_points - 1) / options_.max_fit_points;
  std::size_t kept = 0;
  for (Index k = 0; k < count; ++k) {
    const Index i = support_[k];
    if (k % stride == 0 || std::binary_search(options_.centers.begin(), options_.centers.end(), i))
      support_[kept++] = i;
  }
  support_.resize(kept);
}

// Samples of another sheet count too: there the distance of the patch is an error of the blend.
bool PatchFitter::within_tolerance(const FittedPatch& patch) const {
  const auto meets = [&](Index i) {
    return weight_variable(patch.patch, cloud_.points.col(i)) >= inner_weight_variable ||
           patch.step_to_surface(cloud_.points.col(i)).norm() <= options_.tolerance[i];
  };
  return std::all_of(support_.begin(), support_.end(), meets) && std::all_of(foreign_.begin(), foreign_.end(), meets);
}

double PatchFitter::error_on_other_sheets(const FittedPatch& patch) const {
  const Point<3> normal = patch.patch.T.row(2).normalized();
  double sum = 0;
  for (const Index i : foreign_) {
    if (cloud_.normals.col(i).dot(normal) > opposite_normals) continue;  // possibly the same sheet under noise
    const double weight = std::pow(std::max(0.0, 1 - weight_variable(patch.patch, cloud_.points.col(i))), 4);
    const double distance = std::min(patch.step_to_surface(cloud_.points.col(i)).norm(), patch.patch.radius);
    sum += weight / (own_weight + weight) * distance;
  }
  return sum;
}

// The candidates in the support, evenly thinned to the number allowed.
void PatchFitter::choose_centers() {
  centers_.clear();
  for (Index k = 0; k < std::ssize(support_); ++k)
    if (options_.centers.empty() || std::binary_search(options_.centers.begin(), options_.centers.end(), support_[k]))
      centers_.push_back(k);
  const Index count = std::ssize(centers_), kept = std::min(options_.centers_per_patch, count);
  for (Index j = 0; j < kept; ++j) centers_[j] = centers_[j * count / kept];
  centers_.resize(kept);
}

void PatchFitter::localize(const Patch& patch) {
  const auto count = static_cast<Index>(support_.size());
  const Index padded = (count + gram_rows - 1) / gram_rows * gram_rows;
  q_.setZero(padded, 3);
  target_.setZero(padded, 3);
  weight_.setZero(padded);
  offset_.setZero(padded);
  for (Index k = 0; k < count; ++k) {
    const Index i = support_[k];
    const Point<3> q = patch.T * (cloud_.points.col(i) - patch.center);
    q_.row(k) = q;
    target_.row(k) = -patch.radius * (patch.T * cloud_.normals.col(i));
    offset_[k] = 0.5 * cloud_.spacing[i] / patch.radius;
    const double s = std::max(0.0, 1 - q.squaredNorm());
    weight_[k] = s * s + 1e-3;  // wider than the blending weight, so that the rim of the patch is constrained too
  }
  root_w_ = weight_.cwiseSqrt();
  root_g_ = std::sqrt(options_.normal_weight) * root_w_;
}

// Eqs. (6.3)-(6.6): sum_k w_k (g(q_k)^2 + rho |grad g(q_k) + n_k|^2) + mu |A|^2 over quadrics g(q) = q.A q + b.q + c.
void PatchFitter::fit_quadric(Patch& patch) {
  const Index K = q_.rows();
  quadric_columns_.resize(4 * K, 11);
  quadric_columns(q_.data(), K, root_w_.data(), root_g_.data(), quadric_columns_.data());
  quadric_columns_.col(10).head(K).setZero();
  for (int c = 0; c < 3; ++c) quadric_columns_.col(10).segment((1 + c) * K, K) = root_g_.cwiseProduct(target_.col(c));
  Eigen::Matrix<double, 11, 11> A;
  gram(quadric_columns_.data(), 4 * K, 11, A.data());
  const Eigen::Matrix<double, 10, 1> b = A.row(10).head<10>();
  const double total = weight_.sum();
  for (const int square : {4, 7, 9}) A(square, square) += ridge_quadric * total;
  for (const int mixed : {5, 6, 8}) A(mixed, mixed) += 2 * ridge_quadric * total;
  A.diagonal().array() += round_off * total;
  quadric_matrix_.compute(A.topLeftCorner<10, 10>());
  patch.quadric = quadric_matrix_.solve(b);
}

// The fit is linear in the samples: leaving sample k out divides its residual by 1 - h_k, h_k = df_k / ds_k (its
// leverage). For a quadric fit followed by a fit of its residual, H = H_q + H_r (1 - H_q).
void PatchFitter::left_out_distances(const FittedPatch& patch, std::span<const Index> ids, double* distance) {
  std::vector<Index> rows, columns;  // in the support and in `ids`
  for (Index i = 0; i < std::ssize(ids); ++i) {
    distance[i] = patch.distance(cloud_.points.col(ids[i]));
    const auto found = std::find(support_.begin(), support_.end(), ids[i]);
    if (found == support_.end()) continue;
    rows.push_back(found - support_.begin());
    columns.push_back(i);
  }
  const Eigen::Matrix<double, 10, Eigen::Dynamic> q = quadric_columns_(rows, Eigen::seqN(0, 10)).transpose();
  const Eigen::Matrix<double, 10, Eigen::Dynamic> solved = quadric_matrix_.solve(q);
  Eigen::VectorXd leverage = q.cwiseProduct(solved).colwise().sum();
  const Index M = options_.normal_rows == NormalRows::gradient ? patch.alpha.size() : 0;
  if (M > 0) {
    const Eigen::MatrixXd b = columns_(rows, Eigen::seqN(0, M)).transpose();
    const Eigen::MatrixXd cross = columns_.leftCols(M).transpose() * quadric_columns_.leftCols(10);
    leverage += residual_matrix_.solve(b).cwiseProduct(b - cross * solved).colwise().sum().transpose();
  }
  for (Index i = 0; i < leverage.size(); ++i) distance[columns[i]] /= std::max(1 - leverage[i], smallest_freedom);
}

// Weighted rows of the residual for values and normals: B alpha = s - g, grad B alpha = -n - grad g.
void PatchFitter::gradient_columns(const FittedPatch& result) {
  const Index K = q_.rows(), M = result.centers.cols();
  columns_.resize(4 * K, M + 1);
  kernel_columns(q_.data(), K, root_w_.data(), root_g_.data(), result.centers.data(), M, columns_.data());
  columns_.col(M) = quadric_columns_.col(10);
  columns_.col(M).noalias() -= quadric_columns_.leftCols(10) * result.patch.quadric;
}

// The same with off-surface values instead of gradients: the targets at q + side kappa n are -side kappa.
void PatchFitter::off_surface_columns(const FittedPatch& result) {
  const Index K = q_.rows(), M = result.centers.cols();
  columns_.resize(3 * K, M + 1);
  for (Index k = 0; k < K; ++k)
    for (int side = -1; side <= 1; ++side) {
      const Index row = (side + 1) * K + k;
      const Point<3> q = q_.row(k) - side * offset_[k] * target_.row(k);
      columns_(row, M) = root_w_[k] * (-side * offset_[k] - quadric_rows(q).row(0).dot(result.patch.quadric));
      for (Index j = 0; j < M; ++j)
        columns_(row, j) = root_w_[k] * patch_kernel::value((q - result.centers.col(j)).squaredNorm());
    }
}

// Eq. (6.10): (B^T W B + lambda K) alpha = B^T W (s - g), K the kernel matrix of the centres.
void PatchFitter::fit_residual(FittedPatch& result) {
  const auto M = static_cast<Index>(centers_.size());
  if (M == 0) return;
  center_q_ = q_(centers_, Eigen::all);
  result.centers = center_q_.transpose();
  if (options_.normal_rows == NormalRows::gradient) {
    gradient_columns(result);
  } else {
    off_surface_columns(result);
  }
  gram_.resize(M + 1, M + 1);
  gram(columns_.data(), columns_.rows(), M + 1, gram_.data());
  const Eigen::VectorXd b = gram_.row(M).head(M);
  auto A = gram_.topLeftCorner(M, M);
  const double scale = A.trace() / static_cast<double>(M);
  add_kernel_matrix(center_q_.data(), M, options_.smoothing * scale, gram_.data(), M + 1);
  A.diagonal().array() += round_off * scale;
  residual_matrix_.compute(A);
  result.alpha = residual_matrix_.solve(b);
}

}  // namespace csrbf
