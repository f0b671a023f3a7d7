#include "baselines.hpp"

#include "csrbf/approx/basis/polynomial.hpp"
#include "csrbf/approx/fit.hpp"
#include "csrbf/core/error.hpp"
#include "signals.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/QR>

#include <cmath>

namespace csrbf::thesis {

double band_limited(const Eigen::VectorXd& values, Index first, double W, double x) {
  double sum = 0;
  for (Index i = 0; i < values.size(); ++i) sum += values[i] * sinc(2 * W * x - static_cast<double>(first + i));
  return sum;
}

template <int Dim>
Eigen::VectorXd global_polynomial(const Points<Dim>& points, const Eigen::VectorXd& values, int degree,
                                  const Points<Dim>& x) {
  const Polynomials<Dim> basis(degree);
  Eigen::MatrixXd B(points.cols(), basis.size());
  basis.rows(points, B.data());
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(B);
  require(qr.rank() == basis.size(), "global_polynomial", "degree", degree,
          "the samples must determine a polynomial of this degree; lower it");
  Eigen::MatrixXd at_x(x.cols(), basis.size());
  basis.rows(x, at_x.data());
  return at_x * qr.solve(values);
}

template Eigen::VectorXd global_polynomial<1>(const Points<1>&, const Eigen::VectorXd&, int, const Points<1>&);
template Eigen::VectorXd global_polynomial<2>(const Points<2>&, const Eigen::VectorXd&, int, const Points<2>&);

double cubic_b_spline(double x) {
  const double a = std::abs(x);
  if (a < 1) return 2.0 / 3 - a * a + a * a * a / 2;
  return a < 2 ? (2 - a) * (2 - a) * (2 - a) / 6 : 0;
}

FrameIteration frame_iteration(const Eigen::VectorXd& points, const Eigen::VectorXd& values, Index count,
                               Index iterations) {
  // <Phi, Phi(. - k)>: the B-spline of degree 7 at k.
  const double products[] = {2416 / 5040.0, 1191 / 5040.0, 120 / 5040.0, 1 / 5040.0};
  Eigen::MatrixXd G = Eigen::MatrixXd::Zero(count, count);
  for (Index k = 0; k < count; ++k)
    for (Index l = std::max<Index>(0, k - 3); l <= std::min(count - 1, k + 3); ++l) G(k, l) = products[std::abs(k - l)];
  Eigen::MatrixXd U(points.size(), count);
  for (Index i = 0; i < points.size(); ++i)
    for (Index k = 0; k < count; ++k) U(i, k) = cubic_b_spline(points[i] - static_cast<double>(k));

  FrameIteration result;
  const Eigen::MatrixXd S = U.transpose() * U;
  const Eigen::VectorXd bounds = Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd>(S, G).eigenvalues();
  result.A = bounds.minCoeff();
  result.B = bounds.maxCoeff();
  if (!(result.A > 1e-12 * result.B))
    throw SolverFailure("frame_iteration: the samples do not determine the function; add samples in the largest gap");

  const Eigen::LLT<Eigen::MatrixXd> gram(G);
  const double step = 2 / (result.A + result.B);
  const Eigen::VectorXd f0 = gram.solve(U.transpose() * values);  // eq. (1.18)
  Eigen::VectorXd f = step * f0;
  result.coefficients.resize(count, iterations);
  for (Index n = 0; n < iterations; ++n) {
    result.coefficients.col(n) = f;
    f += step * (f0 - gram.solve(S * f));  // eq. (1.20)
  }
  return result;
}

namespace {

// Samples of the signal at two or three places per knot, none of the gaps larger than a knot distance.
Eigen::VectorXd jittered(Index count, double spacing, unsigned seed) {
  Eigen::VectorXd p = random_points<1>(count, seed).row(0);
  for (Index i = 0; i < count; ++i) p[i] = spacing * (static_cast<double>(i) + .9 * p[i]);
  return p;
}

void add_polynomials(Figure& figure) {
  const Points<1> points = random_points<1>(100, 1, -1, 1);
  const auto signal = [](const Point<1>& p) { return wavy_signal((p[0] + 1) / 2); };
  const Eigen::VectorXd values = values_at(points, signal);
  const Points<1> x = 2 * line(1001).array() - 1;
  const Eigen::VectorXd truth = values_at(x, signal);
  Table table{.name = "global polynomial", .columns = {"degree", "RMSE at the samples", "RMSE"}};
  double best = std::numeric_limits<double>::infinity();
  for (int degree = 2; degree <= 20; degree += 2) {
    const double at_samples = rms(global_polynomial<1>(points, values, degree, points), values);
    const double between = rms(global_polynomial<1>(points, values, degree, x), truth);
    best = std::min(best, between);
    table.rows.push_back({static_cast<double>(degree), at_samples, between});
  }
  figure.tables.push_back(table);
  const double ours = rms(fit<1>({points, values, {}}).components[0]->evaluate(x).value, truth);
  figure.claims.push_back({"1.1.1 global polynomial, 100 random samples of (3.5)", "only in restricted configurations",
                           "best RMSE " + number(best, 2) + " up to degree 20; default fit " + number(ours, 2),
                           verdict(ours < best)});
}

void add_band_limited(Figure& figure) {
  constexpr double W = 25;
  Table table{.name = "band-limited", .columns = {"values left and right of [0, 1]", "largest error"}};
  // A function of bandwidth 20 Hz that decays as 1 / x^4, so that few values are needed.
  const auto f = [](double x) { return std::pow(sinc(10 * (x - 0.4)), 4); };
  for (const Index more : {0, 5, 10, 20, 40, 80}) {
    Eigen::VectorXd values(51 + 2 * more);
    for (Index i = 0; i < values.size(); ++i) values[i] = f(static_cast<double>(i - more) / (2 * W));
    double error = 0;
    for (int i = 0; i <= 1000; ++i)
      error = std::max(error, std::abs(band_limited(values, -more, W, i / 1000.0) - f(i / 1000.0)));
    table.rows.push_back({static_cast<double>(more), error});
  }
  figure.tables.push_back(table);
  figure.claims.push_back({"1.1.2 band-limited function (1.5) from equidistant values", "exact for infinitely many",
                           "largest error " + number(table.rows.back()[1], 2) + " with 80 values on either side",
                           verdict(table.rows.back()[1] < 1e-4)});
}

void add_frame(Figure& figure) {
  constexpr Index count = 40;
  const Eigen::VectorXd points = jittered(120, (count - 1) / 120.0, 3);
  const Eigen::VectorXd truth = random_points<1>(count, 4).row(0);
  Eigen::VectorXd values = Eigen::VectorXd::Zero(points.size());
  for (Index i = 0; i < points.size(); ++i)
    for (Index k = 0; k < count; ++k) values[i] += truth[k] * cubic_b_spline(points[i] - static_cast<double>(k));
  const FrameIteration frame = frame_iteration(points, values, count, 60);
  const double rate = (frame.B - frame.A) / (frame.B + frame.A);
  Table table{.name = "frame iteration", .columns = {"iteration", "error", "bound"}};
  for (Index n = 0; n < frame.coefficients.cols(); ++n)
    table.rows.push_back({static_cast<double>(n + 1), relative_error(frame.coefficients.col(n), truth),
                          std::pow(rate, static_cast<double>(n + 1))});
  figure.tables.push_back(table);
  figure.claims.push_back({"1.4 frame iteration (1.18)-(1.20)", "converges to f",
                           "error " + number(table.rows.back()[1], 2) + " after " + number(table.rows.back()[0]) +
                               " iterations; rate (B - A) / (B + A) = " + number(rate, 4),
                           verdict(table.rows.back()[1] < table.rows.front()[1] / 10)});
}

}  // namespace

Figure baselines() {
  Figure figure{.name = "chapter-1",
                .title = "Chapter 1: methods to compare with",
                .text =
                    "Global polynomials, the series of band-limited functions (1.5) and the frame iteration "
                    "(1.18)-(1.20), each where it belongs."};
  add_polynomials(figure);
  add_band_limited(figure);
  add_frame(figure);
  return figure;
}

}  // namespace csrbf::thesis
