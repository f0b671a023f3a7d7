// Sums of N radial functions at N points by FastSum, and systems solved with them: CPU seconds, errors against direct
// sums, iterations. Prints tables in Markdown.
// usage: global_functions [LARGEST]     LARGEST: number of points, default 100000

#include "csrbf/approx/global/interpolate.hpp"
#include "csrbf/approx/sums/fast_sum.hpp"

#include <sys/resource.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <random>
#include <string>

namespace {

using namespace csrbf;

enum class Shape { uniform, clusters, tracks, layer, sphere };

double cpu_seconds() {
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

template <int Dim>
Points<Dim> cloud(Index n, Shape shape) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::normal_distribution<double> normal;
  Points<Dim> x(Dim, n);
  Point<Dim> center = Point<Dim>::Zero();
  double spread = 1;
  for (Index i = 0; i < n; ++i) {
    for (int d = 0; d < Dim; ++d) x(d, i) = shape == Shape::sphere ? normal(random) : uniform(random);
    if (shape == Shape::clusters) {
      if (i % (n / 20) == 0) {  // 20 of them, whose sizes vary 300 times
        center = x.col(i);
        spread = std::pow(10, -3 + 2.5 * std::abs(uniform(random)));
      }
      for (int d = 0; d < Dim; ++d) x(d, i) = center[d] + spread * normal(random);
    }
    if (shape == Shape::tracks) x(Dim - 1, i) = std::round(20 * x(Dim - 1, i)) / 20 + 1e-4 * x(0, i);
    if (shape == Shape::layer) x(Dim - 1, i) *= 1e-3;
    if (shape == Shape::sphere) x.col(i) *= (i % 2 == 0 ? 1 : 1.01) / x.col(i).norm();  // with off-surface points
  }
  return x;
}

template <int Dim>
void sums(const char* name, Index n, Shape shape, double tolerance) {
  const Points<Dim> x = cloud<Dim>(n, shape);
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal;
  const Eigen::VectorXd alpha = Eigen::VectorXd::NullaryExpr(n, [&] { return normal(random); });
  const Kernel kernel(name, Dim);
  const double start = cpu_seconds();
  const FastSum<Dim> sum(x, kernel, 1, {.tolerance = tolerance});
  const double prepared = cpu_seconds();
  const Eigen::VectorXd y = sum.multiply(alpha);
  const double done = cpu_seconds();
  double error = 0, size = 0;
  Eigen::VectorXd r2(n), phi(n);
  for (Index k = 0; k < n; k += n / 100) {
    r2 = (x.colwise() - x.col(k)).colwise().squaredNorm().transpose();
    kernel.values(r2.data(), n, phi.data());
    error += std::pow(phi.dot(alpha) - y[k], 2);
    size += std::pow(phi.dot(alpha), 2);
  }
  std::printf("| %s, %dD | %ld | %.2f | %.2f | %.1e |\n", name, Dim, static_cast<long>(n), prepared - start,
              done - prepared, std::sqrt(error / size));
  std::fflush(stdout);
}

template <int Dim>
void system(const char* name, Index n, Shape shape, const char* what) {
  Samples<Dim> samples{cloud<Dim>(n, shape), Eigen::MatrixXd(n, 1), {}};
  const auto x = samples.points.array();
  samples.values.col(0) = ((5 * x.row(0)).sin() * (4 * x.row(Dim - 1)).cos() + .1 * x.row(0)).transpose();
  const double start = cpu_seconds();
  try {
    const Interpolation<Dim> fit = interpolate(samples, {.kernel = name, .dense_limit = 1000});
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    std::printf("| %s, %dD, %s | %ld | %.2f | %d | %.1e | %ld |\n", name, Dim, what, static_cast<long>(n),
                cpu_seconds() - start, fit.report.iterations, fit.report.residual, usage.ru_maxrss / 1024);
  } catch (const std::exception& error) {
    std::printf("| %s, %dD, %s | %ld | %.2f | %s | | |\n", name, Dim, what, static_cast<long>(n), cpu_seconds() - start,
                error.what());
  }
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  const Index largest = argc > 1 ? std::atol(argv[1]) : 100000;
  std::printf("# Global radial functions\n\nWritten by `global_functions %ld`; CPU seconds.\n\n",
              static_cast<long>(largest));
  std::printf(
      "Sums of N terms at their N centres, tolerance 1e-7; the error is relative, root mean square, against "
      "direct sums.\n\n| kernel | N | prepare | sum | error |\n|---|---|---|---|---|\n");
  for (Index n = 10000; n <= largest; n *= 10) {
    sums<2>("thin-plate", n, Shape::uniform, 1e-7);
    sums<3>("linear", n, Shape::uniform, 1e-7);
    sums<3>("cubic", n, Shape::uniform, 1e-7);
    sums<3>("linear", n, Shape::sphere, 1e-7);
    sums<3>("linear", n, Shape::clusters, 1e-7);
  }
  std::printf(
      "\nInterpolation, residuals at most 1e-8 of the largest value in the plane, 1e-7 in space. On the sphere "
      "every other point is off the surface by 1 %%.\n\n| kernel and points | N | seconds | iterations | "
      "residual | MB |\n|---|---|---|---|---|---|\n");
  for (const Index n : {Index{4000}, Index{20000}, Index{100000}, Index{1000000}}) {
    if (n > largest) break;
    system<2>("thin-plate", n, Shape::uniform, "uniform");
    if (n == 1000000) continue;
    system<2>("thin-plate", n, Shape::clusters, "clusters");
    system<2>("thin-plate", n, Shape::tracks, "tracks");
    system<3>("linear", n, Shape::uniform, "uniform");
    system<3>("linear", n, Shape::layer, "layer 1000:1");
    system<3>("linear", n, Shape::sphere, "sphere");
  }
}
