#include "csrbf/surface/slope_penalty.hpp"

#include "csrbf/approx/radial_basis.hpp"
#include "csrbf/core/parallel.hpp"
#include "csrbf/linalg/sparse_least_squares.hpp"
#include "csrbf/surface/quadric_fitter.hpp"

#include <algorithm>

namespace csrbf {
namespace {

using Rows = SlopeSystem::Rows;

constexpr double steepest = 135.0 / 64;  // K' = max |phi'| of Wendland's C2 function
constexpr Index most_for_choice = 2000;  // centres that the smoothing is chosen with
constexpr Index choice_blocks = 8;
constexpr double smallest = 1e-8, largest = 1e2;  // range of the choice
constexpr double ridge = 1e-9;                    // relative; the slopes do not see the constants

// Turns row k of B and D from phi to w.
void fill_row(const MedialAxisField::Data& data, const Point<3>& p, Index k, SlopeSystem& s) {
  const Index begin = s.B.outerIndexPtr()[k], end = s.B.outerIndexPtr()[k + 1];
  double W = 0, S = 0;
  Point<3> slope = Point<3>::Zero();
  for (Index e = begin; e < end; ++e) {
    const Index j = s.B.innerIndexPtr()[e];
    const Point<3> d = p - data.centers.col(j);
    const double sigma = data.supports[j], phi = s.B.valuePtr()[e], a = std::max(0.0, 1 - d.norm() / sigma);
    const Point<3> gradient = -20 * a * a * a / (sigma * sigma) * d;
    W += phi;
    S += phi * evaluate_quadric(data.quadrics.col(j), d)[0];
    slope += gradient;
    for (std::size_t c = 0; c < 3; ++c) s.D[c].valuePtr()[e] = gradient[static_cast<Index>(c)];
  }
  s.residual[k] = W > 0 ? -S / W : 0;
  for (Index e = begin; e < end; ++e) {
    const double w = s.B.valuePtr()[e] / W, factor = data.supports[s.B.innerIndexPtr()[e]] / (steepest * W);
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
  P *= ridge * static_cast<double>(s.B.rows()) / static_cast<double>(s.B.cols());
  for (const Rows& D : s.D) P += Eigen::SparseMatrix<double>(D.transpose() * D);
  return P;
}

// The part of M with the given rows, whose entries are all in columns j with place[j] >= 0.
Rows part(const Rows& M, const std::vector<Index>& rows, const std::vector<int>& place, Index columns) {
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t i = 0; i < rows.size(); ++i)
    for (Rows::InnerIterator e(M, rows[i]); e; ++e)
      entries.emplace_back(static_cast<int>(i), place[static_cast<std::size_t>(e.col())], e.value());
  Rows result(static_cast<Index>(rows.size()), columns);
  result.setFromTriplets(entries.begin(), entries.end());
  return result;
}

// The samples that only the centres of some blocks reach. Centres that follow each other are neighbours.
SlopeSystem sample_blocks(const SlopeSystem& s) {
  const Index M = s.B.cols(), length = most_for_choice / choice_blocks;
  std::vector<int> place(static_cast<std::size_t>(M), -1);
  int columns = 0;
  for (Index block = 0; block < choice_blocks; ++block)
    for (Index i = 0; i < length; ++i) place[static_cast<std::size_t>(block * (M / choice_blocks) + i)] = columns++;
  std::vector<Index> rows;
  for (Index k = 0; k < s.B.rows(); ++k) {
    bool inside = true;
    for (Rows::InnerIterator e(s.B, k); e && inside; ++e) inside = place[static_cast<std::size_t>(e.col())] >= 0;
    if (inside) rows.push_back(k);
  }
  SlopeSystem sample;
  sample.B = part(s.B, rows, place, columns);
  for (std::size_t c = 0; c < 3; ++c) sample.D[c] = part(s.D[c], rows, place, columns);
  sample.residual = s.residual(rows);
  return sample;
}

SparseLeastSquaresFit solve(const SlopeSystem& s, std::optional<double> smoothing, const Progress& progress) {
  SparseLeastSquaresOptions options;
  options.lambda0 = smoothing;
  options.penalty = penalty(s);
  options.smallest = smallest;
  options.largest = largest;
  options.solver.progress = progress;
  return sparse_least_squares(s.B, s.residual, options);
}

}  // namespace

SlopeSystem slope_system(const MedialAxisField::Data& data, const PointsRef<3>& samples) {
  SlopeSystem s;
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
    const SlopeSystem sample = sample_blocks(system);
    if (sample.B.rows() > 0) smoothing = solve(sample, {}, progress).lambda0;
  }
  const SparseLeastSquaresFit fit = solve(system, smoothing, progress);
  return {fit.coefficients.col(0), fit.lambda0, fit.direct};
}

}  // namespace csrbf
