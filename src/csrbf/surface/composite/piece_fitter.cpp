#include "csrbf/surface/composite/piece_fitter.hpp"

#include "csrbf/linalg/gram.hpp"
#include "csrbf/surface/composite/patch_kernel.hpp"
#include "csrbf/surface/composite/patch_rows.hpp"

namespace csrbf {
namespace {

// Chosen by hand unless noted.
constexpr double ridge_quadric = 1e-6;         // relative to the weights; makes a planar piece planar
constexpr double round_off = 1e-13;            // relative; keeps the normal matrices positive definite
constexpr int newton_steps = 3;                // from the tangent plane to the surface of a piece
constexpr double smallest_piece_slope = 1e-3;  // floor of |grad f|, which is 1 for a model that follows its normals

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

}  // namespace

Eigen::MatrixX4d FittedPiece::evaluate(const Eigen::MatrixX3d& q) const {
  Eigen::MatrixX4d f(q.rows(), 4);
  piece_jets(q.data(), q.rows(), patch.quadric.data(), centers.data(), alpha.data(), alpha.size(), f.data());
  return f;
}

Eigen::VectorXd FittedPiece::distances(const Eigen::MatrixX3d& q) const {
  const Eigen::VectorXd height = (q.rowwise() - middle.transpose()) * normal;
  const Eigen::MatrixX3d foot = q - height * normal.transpose();
  Eigen::VectorXd t = Eigen::VectorXd::Zero(q.rows());
  Eigen::MatrixX4d f = evaluate(foot);
  for (int step = 0; step < newton_steps; ++step) {
    const Eigen::ArrayXd slope = (f.rightCols<3>() * normal).array().min(-smallest_piece_slope);
    t = (t.array() - f.col(0).array() / slope).max(-1.0).min(1.0);
    f = evaluate(foot + t * normal.transpose());
  }
  const Eigen::ArrayXd cosine =
      (f.rightCols<3>() * normal).array().abs() / f.rightCols<3>().rowwise().norm().array().max(smallest_piece_slope);
  return patch.radius * (height - t).array().abs() * cosine;
}

void PieceFitter::fit(const OrientedPoints& cloud, std::span<const Index> ids, const CompositeOptions& options,
                      FittedPiece& piece) {
  samples_ = std::ssize(ids);
  gradient_rows_ = options.normal_rows == NormalRows::gradient;
  normal_weight_ = options.normal_weight;
  choose_centers(ids, options);
  localize(cloud, ids, piece.patch);
  fit_quadric(piece.patch);
  fit_residual(options, piece);
}

double PieceFitter::largest_normal_residual(const FittedPiece& piece) const {
  const Index K = q_.rows(), M = piece.alpha.size();
  if (!gradient_rows_ && M > 0) {
    const Eigen::MatrixX4d f = piece.evaluate(q_);
    return std::sqrt((f.rightCols<3>() - target_).topRows(samples_).rowwise().squaredNorm().maxCoeff());
  }
  // What the rows of the gradients leave, without their weights.
  Eigen::VectorXd rest = M > 0 ? columns_.col(M).tail(3 * K) : quadric_columns_.col(10).tail(3 * K);
  if (M > 0)
    rest.noalias() -= columns_.leftCols(M).bottomRows(3 * K) * piece.alpha;
  else
    rest.noalias() -= quadric_columns_.leftCols(10).bottomRows(3 * K) * piece.patch.quadric;
  const auto squares = rest.reshaped(K, 3).topRows(samples_).rowwise().squaredNorm().array();
  return std::sqrt((squares / root_g_.head(samples_).array().square()).maxCoeff());
}

// The fit is linear in the samples: leaving sample k out divides its residual by 1 - h_k, h_k = df_k / ds_k (its
// leverage). For a quadric fit followed by a fit of its residual, H = H_q + H_r (1 - H_q).
Eigen::VectorXd PieceFitter::leverage(const FittedPiece& piece, std::span<const Index> rows) const {
  const std::vector<Index> chosen(rows.begin(), rows.end());
  const Eigen::Matrix<double, 10, Eigen::Dynamic> q = quadric_columns_(chosen, Eigen::seqN(0, 10)).transpose();
  const Eigen::Matrix<double, 10, Eigen::Dynamic> solved = quadric_matrix_.solve(q);
  Eigen::VectorXd h = q.cwiseProduct(solved).colwise().sum();
  const Index M = gradient_rows_ ? piece.alpha.size() : 0;
  if (M > 0) {
    const Eigen::MatrixXd b = columns_(chosen, Eigen::seqN(0, M)).transpose();
    Eigen::MatrixXd cross(M, 10);
    gram(columns_.data(), M, quadric_columns_.data(), 10, columns_.rows(), cross.data());
    h += residual_matrix_.solve(b).cwiseProduct(b - cross * solved).colwise().sum().transpose();
  }
  return h;
}

// The candidates among the samples, evenly thinned to the number allowed.
void PieceFitter::choose_centers(std::span<const Index> ids, const CompositeOptions& options) {
  centers_.clear();
  for (Index k = 0; k < std::ssize(ids); ++k)
    if (options.centers.empty() || std::binary_search(options.centers.begin(), options.centers.end(), ids[k]))
      centers_.push_back(k);
  const Index count = std::ssize(centers_), kept = std::min(options.centers_per_patch, count);
  for (Index j = 0; j < kept; ++j) centers_[j] = centers_[j * count / kept];
  centers_.resize(kept);
}

void PieceFitter::localize(const OrientedPoints& cloud, std::span<const Index> ids, const Patch& patch) {
  const auto count = samples_;
  const Index padded = (count + gram_rows - 1) / gram_rows * gram_rows;
  q_.setZero(padded, 3);
  target_.setZero(padded, 3);
  weight_.setZero(padded);
  offset_.setZero(padded);
  for (Index k = 0; k < count; ++k) {
    const Index i = ids[k];
    const Point<3> q = patch.T * (cloud.points.col(i) - patch.center);
    q_.row(k) = q;
    target_.row(k) = -patch.radius * (patch.T * cloud.normals.col(i));
    offset_[k] = 0.5 * cloud.spacing[i] / patch.radius;
    const double s = std::max(0.0, 1 - q.squaredNorm());
    weight_[k] = s * s + 1e-3;  // wider than the blending weight, so that the rim of the patch is constrained too
  }
  root_w_ = weight_.cwiseSqrt();
  root_g_ = std::sqrt(normal_weight_) * root_w_;
}

// Eqs. (6.3)-(6.6): sum_k w_k (g(q_k)^2 + rho |grad g(q_k) + n_k|^2) + mu |A|^2 over quadrics g(q) = q.A q + b.q + c.
void PieceFitter::fit_quadric(Patch& patch) {
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

// Weighted rows of the residual for values and normals: B alpha = s - g, grad B alpha = -n - grad g.
void PieceFitter::gradient_columns(const FittedPiece& piece) {
  const Index K = q_.rows(), M = piece.centers.cols();
  columns_.resize(4 * K, M + 1);
  kernel_columns(q_.data(), K, root_w_.data(), root_g_.data(), piece.centers.data(), M, columns_.data());
  columns_.col(M) = quadric_columns_.col(10);
  columns_.col(M).noalias() -= quadric_columns_.leftCols(10) * piece.patch.quadric;
}

// The same with off-surface values instead of gradients: the targets at q + side kappa n are -side kappa.
void PieceFitter::off_surface_columns(const FittedPiece& piece) {
  const Index K = q_.rows(), M = piece.centers.cols();
  columns_.resize(3 * K, M + 1);
  for (Index k = 0; k < K; ++k)
    for (int side = -1; side <= 1; ++side) {
      const Index row = (side + 1) * K + k;
      const Point<3> q = q_.row(k) - side * offset_[k] * target_.row(k);
      columns_(row, M) = root_w_[k] * (-side * offset_[k] - quadric_rows(q).row(0).dot(piece.patch.quadric));
      for (Index j = 0; j < M; ++j)
        columns_(row, j) = root_w_[k] * patch_kernel::value((q - piece.centers.col(j)).squaredNorm());
    }
}

// Eq. (6.10): (B^T W B + lambda K) alpha = B^T W (s - g), K the kernel matrix of the centres.
void PieceFitter::fit_residual(const CompositeOptions& options, FittedPiece& piece) {
  const auto M = static_cast<Index>(centers_.size());
  if (M == 0) return;
  center_q_ = q_(centers_, Eigen::all);
  piece.centers = center_q_.transpose();
  if (gradient_rows_) {
    gradient_columns(piece);
  } else {
    off_surface_columns(piece);
  }
  gram_.resize(M + 1, M + 1);
  gram(columns_.data(), columns_.rows(), M + 1, gram_.data());
  const Eigen::VectorXd b = gram_.row(M).head(M);
  auto A = gram_.topLeftCorner(M, M);
  const double scale = A.trace() / static_cast<double>(M);
  add_kernel_matrix(center_q_.data(), M, options.smoothing * scale, gram_.data(), M + 1);
  A.diagonal().array() += round_off * scale;
  residual_matrix_.compute(A);
  piece.alpha = residual_matrix_.solve(b);
}

}  // namespace csrbf
