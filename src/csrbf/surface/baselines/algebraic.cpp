#include "csrbf/approx/basis/expansion.hpp"
#include "csrbf/approx/basis/polynomial.hpp"
#include "csrbf/linalg/decompositions.hpp"
#include "csrbf/surface/baselines/baselines.hpp"
#include "csrbf/surface/baselines/off_surface.hpp"

namespace csrbf::baselines {
namespace {

// Chosen by hand.
constexpr int degree = 8;                 // 165 coefficients; higher: more detail, less stable
constexpr Index most_samples = 4000;      // fitted, evenly chosen: a dense least squares problem
constexpr double relative_ridge = 1e-6;   // of the coefficients, relative to the mean square of a column
constexpr double gradient_weight = 0.01;  // of gradients relative to values, coordinates in units of half the box

// Target length of the gradient at a sample, from the monomials u there.
enum class Length { one, sum_of_magnitudes, root_of_squares };

double row_length(Length kind, const Eigen::RowVectorXd& u) {
  if (kind == Length::sum_of_magnitudes) return u.lpNorm<1>();
  return kind == Length::root_of_squares ? u.norm() : 1;
}

// The least-squares polynomial of the rows, as a field. Coordinates are those of the cloud over half its longest side.
MethodFit solve(const Eigen::MatrixXd& rows, const Eigen::VectorXd& data, const PolynomialTail<3>& frame,
                const Box<3>& box) {
  Eigen::MatrixXd A(rows.rows() + rows.cols(), rows.cols());
  A << rows, Eigen::MatrixXd::Identity(rows.cols(), rows.cols()) *
                 std::sqrt(relative_ridge * rows.squaredNorm() / static_cast<double>(rows.cols()));
  Eigen::VectorXd s = Eigen::VectorXd::Zero(A.rows());
  s.head(data.size()) = data;
  PolynomialTail<3> tail = frame;
  tail.coefficients = csrbf::solve(Eigen::ColPivHouseholderQR<Eigen::MatrixXd>(A), s);
  const auto none =
      std::make_shared<const RadialBasis<3>>(Kernel("wendland-c2", 3), Points<3>(3, 0), Eigen::VectorXd::Ones(1));
  return {std::make_shared<const Expansion<3>>(none, Eigen::VectorXd(0), tail, box), rows.cols(), relative_ridge};
}

PolynomialTail<3> frame_of(const Box<3>& box) {
  return {degree, box.center(), 0.5 * box.extent().maxCoeff(), {}};
}

// Minimises sum (f / w)^2 + kappa |grad f / w + n|^2 over samples, w = target length of the gradient there.
MethodFit gradient_fit(const PreparedCloud& cloud, Length kind) {
  const OrientedPoints& all = cloud.cloud;
  const Box<3> box = bounding_box<3>(all.points);
  const PolynomialTail<3> frame = frame_of(box);
  const Index stride = (all.size() + most_samples - 1) / most_samples, n = (all.size() + stride - 1) / stride;
  Points<3> q(3, n), normals(3, n);
  for (Index i = 0; i < n; ++i) {
    q.col(i) = (all.points.col(i * stride) - frame.origin) / frame.scale;
    normals.col(i) = all.normals.col(i * stride);
  }
  const Polynomials<3> polynomials(degree);
  const Index Q = polynomials.size();
  Eigen::MatrixXd value(n, Q), gradient(3 * n, Q), rows(4 * n, Q);
  polynomials.rows(q, value.data(), gradient.data());
  Eigen::VectorXd data = Eigen::VectorXd::Zero(4 * n);
  const double kappa = std::sqrt(gradient_weight);
  for (Index i = 0; i < n; ++i) {
    const double w = row_length(kind, value.row(i));
    rows.row(i) = value.row(i) / w;
    rows.middleRows(n + 3 * i, 3) = kappa / w * gradient.middleRows(3 * i, 3);
    data.segment<3>(n + 3 * i) = -kappa * normals.col(i);
  }
  return solve(rows, data, frame, box);
}

}  // namespace

MethodFit three_levels(const PreparedCloud& cloud, const MethodOptions& /*options*/) {
  const Samples<3> samples = off_surface_samples(cloud, most_samples / 3, Offsets::both);
  const Box<3> box = bounding_box<3>(cloud.cloud.points);
  const PolynomialTail<3> frame = frame_of(box);
  const Points<3> q = (samples.points.colwise() - frame.origin) / frame.scale;
  const Polynomials<3> polynomials(degree);
  Eigen::MatrixXd rows(q.cols(), polynomials.size());
  polynomials.rows(q, rows.data());
  return solve(rows, samples.values.col(0) / frame.scale, frame, box);
}

MethodFit gradient_one(const PreparedCloud& cloud, const MethodOptions& /*options*/) {
  return gradient_fit(cloud, Length::one);
}

MethodFit min_max(const PreparedCloud& cloud, const MethodOptions& /*options*/) {
  return gradient_fit(cloud, Length::sum_of_magnitudes);
}

MethodFit min_var(const PreparedCloud& cloud, const MethodOptions& /*options*/) {
  return gradient_fit(cloud, Length::root_of_squares);
}

}  // namespace csrbf::baselines
