#include "csrbf/surface/medial/slope_penalty.hpp"

#include "csrbf/approx/basis/radial_basis.hpp"
#include "csrbf/core/interruption.hpp"
#include "csrbf/core/parallel.hpp"
#include "csrbf/linalg/sparse_least_squares.hpp"
#include "csrbf/surface/medial/quadric_fitter.hpp"

namespace csrbf {
namespace {

using Rows = SlopeSystem::Rows;

constexpr double gradient_bound = 135.0 / 64;  // K' = max |phi'| of Wendland's C2 function, at r = 1/4
// Chosen by hand.
constexpr Index most_for_choice = 2000;               // centres that the smoothing is chosen with; more: slower
constexpr Index most_blocks = 8;                      // into which they are divided: more represent the surface better
constexpr double wanted_rows = 4;                     // rows per centre that a block needs, clamped to ...
constexpr double least_rows = 0.25, most_rows = 0.6;  // ... these shares of the rows per centre of the whole system
constexpr double wide_support_smoothing = 10;  // where supports are so wide that no block has them: quadrics suffice
constexpr double smallest_smoothing = 1e-8, largest_smoothing = 1e2;  // range of the choice
constexpr double constant_ridge = 1e-9;  // relative; constants have no slope, which leaves the penalty singular

// Normalises row k of B and D: from phi to w.
void fill_row(const MedialAxisField::Data& data, const Point<3>& p, Index k, SlopeSystem& s) {
  const Index begin = s.B.outerIndexPtr()[k], end = s.B.outerIndexPtr()[k + 1];
  double W = 0, S = 0;
  Point<3> slope = Point<3>::Zero(), steepness = Point<3>::Zero();  // gradients of W and S
  for (Index e = begin; e < end; ++e) {
    const Index j = s.B.innerIndexPtr()[e];
    const Point<3> d = p - data.centers.col(j);
    const double sigma = data.supports[j], phi = s.B.valuePtr()[e], a = std::max(0.0, 1 - d.norm() / sigma);
    const Point<3> gradient = -20 * a * a * a / (sigma * sigma) * d;
    W += phi;
    const Eigen::Vector4d g = evaluate_quadric(data.quadrics.col(j), d);
    S += phi * g[0];
    slope += gradient;
    steepness += g[0] * gradient + phi * g.tail<3>();
    for (std::size_t c = 0; c < 3; ++c) s.D[c].valuePtr()[e] = gradient[static_cast<Index>(c)];
  }
  s.residual[k] = W > 0 ? -S / W : 0;
  s.slope[k] = W > 0 ? -s.normals.col(k).dot(steepness - S / W * slope) / W : 0;
  for (Index e = begin; e < end; ++e) {
    const double w = s.B.valuePtr()[e] / W, factor = data.supports[s.B.innerIndexPtr()[e]] / (gradient_bound * W);
    s.B.valuePtr()[e] = w;
    for (std::size_t c = 0; c < 3; ++c) {
      double& D = s.D[c].valuePtr()[e];
      D = factor * (D - w * slope[static_cast<Index>(c)]);
    }
  }
}

Eigen::SparseMatrix<double> penalty(const SlopeSystem& s) {
  Eigen::SparseMatrix<double> P(s.B.cols(), s.B.cols());
  P.setIdentity();
  P *= constant_ridge * static_cast<double>(s.B.rows()) / static_cast<double>(s.B.cols());
  for (const Rows& D : s.D) {
    stop_if_interrupted();
    P += Eigen::SparseMatrix<double>(D.transpose() * D);
  }
  return P;
}

// The part of M with the given rows, whose entries are all in columns j with place[j] >= 0.
Rows part(const Rows& M, const std::vector<Index>& rows, const std::vector<int>& place, Index columns) {
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t i = 0; i < rows.size(); ++i)
    for (Rows::InnerIterator e(M, rows[i]); e; ++e)
      entries.emplace_back(static_cast<int>(i), place[e.col()], e.value());
  Rows result(static_cast<Index>(rows.size()), columns);
  result.setFromTriplets(entries.begin(), entries.end());
  return result;
}

// The samples within reach of the centres of some blocks only. Consecutive centres are neighbours.
SlopeSystem sample_blocks(const SlopeSystem& s, Index blocks) {
  const Index M = s.B.cols(), length = most_for_choice / blocks;
  std::vector<int> place(M, -1);
  int columns = 0;
  for (Index block = 0; block < blocks; ++block)
    for (Index i = 0; i < length; ++i) place[block * (M / blocks) + i] = columns++;
  std::vector<Index> rows;
  for (Index k = 0; k < s.B.rows(); ++k) {
    bool inside = true;
    for (Rows::InnerIterator e(s.B, k); e && inside; ++e) inside = place[e.col()] >= 0;
    if (inside) rows.push_back(k);
  }
  SlopeSystem sample;
  sample.B = part(s.B, rows, place, columns);
  for (std::size_t c = 0; c < 3; ++c) sample.D[c] = part(s.D[c], rows, place, columns);
  sample.residual = s.residual(rows);
  sample.slope = s.slope(rows);
  sample.normals = s.normals(Eigen::all, rows);
  sample.supports.resize(columns);
  for (std::size_t j = 0; j < place.size(); ++j)
    if (place[j] >= 0) sample.supports[place[j]] = s.supports[static_cast<Index>(j)];
  return sample;
}

// The mean of -n . grad f over the samples as a function of alpha.
AffineFunction mean_slope(const SlopeSystem& s) {
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(s.B.cols());
  for (std::size_t c = 0; c < 3; ++c) sum -= s.D[c].transpose() * s.normals.row(static_cast<Index>(c)).transpose();
  const auto N = static_cast<double>(s.B.rows());
  return {s.slope.sum() / N, gradient_bound / N * sum.cwiseQuotient(s.supports)};
}

SparseLeastSquaresFit solve(const SlopeSystem& s, std::optional<double> smoothing, const Progress& progress) {
  SparseLeastSquaresOptions options;
  options.lambda0 = smoothing;
  options.penalty = penalty(s);
  options.smallest = smallest_smoothing;
  options.largest = largest_smoothing;
  options.score_unit = mean_slope(s);
  options.solver.progress = progress;
  return sparse_least_squares(s.B, s.residual, options);
}

}  // namespace

SlopeSystem slope_system(const MedialAxisField::Data& data, const PointsRef<3>& samples, const PointsRef<3>& normals) {
  SlopeSystem s;
  s.normals = normals;
  s.supports = data.supports;
  s.slope.resize(samples.cols());
  s.B = RadialBasis<3>(Kernel("wendland-c2", 3), data.centers, data.supports).matrix(samples);
  for (Rows& D : s.D) D = s.B;
  s.residual.resize(samples.cols());
  parallel_for(samples.cols(), 512, [&](Index begin, Index end) {
    for (Index k = begin; k < end; ++k) fill_row(data, samples.col(k), k, s);
  });
  return s;
}

SlopeSolution solve_slope_system(const SlopeSystem& system, std::optional<double> smoothing, const Progress& progress) {
  if (!smoothing && system.B.cols() > most_for_choice) {
    SlopeSystem sample = sample_blocks(system, most_blocks);
    const auto per_center = [](const Rows& B) { return static_cast<double>(B.rows()) / static_cast<double>(B.cols()); };
    const double all = per_center(system.B), enough = std::clamp(wanted_rows, least_rows * all, most_rows * all);
    for (Index blocks = most_blocks / 2; blocks > 0 && per_center(sample.B) < enough; blocks /= 2)
      sample = sample_blocks(system, blocks);
    smoothing = per_center(sample.B) < enough ? wide_support_smoothing : solve(sample, {}, progress).lambda0;
  }
  const SparseLeastSquaresFit fit = solve(system, smoothing, progress);
  return {fit.coefficients.col(0), fit.lambda0};
}

}  // namespace csrbf
