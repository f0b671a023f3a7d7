// Sums of N radial functions at N points by FastSum, systems solved with them, and a surface of one: CPU seconds,
// errors against direct sums and dense systems, iterations. Prints sections of benchmarks/GLOBAL.md. usage:
// global_functions sums LARGEST | systems LARGEST | dense N | smoothing N | deviations | surface CLOUD.ply MESH.ply

#include "csrbf/approx/basis/expansion.hpp"
#include "csrbf/approx/global/interpolate.hpp"
#include "csrbf/approx/global/kriging_variance.hpp"
#include "csrbf/approx/sums/fast_sum.hpp"
#include "csrbf/implicit/compare.hpp"
#include "csrbf/implicit/polygonize.hpp"
#include "csrbf/io/mesh.hpp"
#include "csrbf/io/points.hpp"
#include "csrbf/surface/reconstruct.hpp"

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

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
void sums(const char* name, Index n, Shape shape, const char* what, double tolerance) {
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
  std::printf("| %s, %dD, %s | %ld | %.2f | %.2f | %.1e |\n", name, Dim, what, static_cast<long>(n), prepared - start,
              done - prepared, std::sqrt(error / size));
  std::fflush(stdout);
}

// In a process of its own, whose memory is that of this system.
template <int Dim>
void system(const char* name, Index n, Shape shape, const char* what) {
  std::fflush(stdout);
  if (const pid_t child = fork(); child > 0) {
    waitpid(child, nullptr, 0);
    return;
  }
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
  std::_Exit(0);
}

void all_sums(Index largest) {
  std::printf(
      "## Sums\n\nN terms at their N centres, tolerance 1e-7; the error is relative, root mean square, against direct "
      "sums.\n\n| kernel and points | N | prepare | sum | error |\n|---|---|---|---|---|\n");
  for (Index n = 10000; n <= largest; n *= 10) {
    sums<2>("thin-plate", n, Shape::uniform, "uniform", 1e-7);
    sums<3>("linear", n, Shape::uniform, "uniform", 1e-7);
    sums<3>("cubic", n, Shape::uniform, "uniform", 1e-7);
    sums<3>("linear", n, Shape::sphere, "sphere", 1e-7);
    sums<3>("linear", n, Shape::clusters, "clusters", 1e-7);
  }
}

void all_systems(Index largest) {
  std::printf(
      "## Systems\n\nResiduals at most 1e-8 of the largest value in the plane, 1e-7 in space. Clusters are twenty, "
      "their "
      "sizes differ 300 times; on the sphere every other point is off the surface by 1 %%.\n\n"
      "| kernel and points | N | seconds | iterations | residual | MB |\n|---|---|---|---|---|---|\n");
  for (const Index n : {Index{4000}, Index{20000}, Index{100000}, Index{1000000}}) {
    if (n > largest) break;
    system<2>("thin-plate", n, Shape::uniform, "uniform");
    if (n == 1000000) continue;
    system<2>("thin-plate", n, Shape::clusters, "clusters");
    system<2>("thin-plate", n, Shape::tracks, "tracks");
    system<2>("cubic", n, Shape::uniform, "uniform");
    system<3>("linear", n, Shape::uniform, "uniform");
    system<3>("linear", n, Shape::layer, "layer 1000:1");
    system<3>("linear", n, Shape::sphere, "sphere");
    system<3>("linear", n, Shape::clusters, "clusters");
    if (n > 20000) continue;
    system<3>("cubic", n, Shape::uniform, "uniform");
    system<3>("cubic", n, Shape::layer, "layer 1000:1");
  }
}

void against_dense(Index n) {
  std::printf(
      "## Against dense systems\n\nThe largest difference at 1000 points, in units of the range of the values, of %ld "
      "samples in the plane; kernels with a scale: four spacings.\n\n"
      "| kernel | difference | iterations | seconds | dense |\n|---|---|---|---|---|\n",
      static_cast<long>(n));
  Samples<2> samples{cloud<2>(n, Shape::uniform), Eigen::MatrixXd(n, 1), {}};
  const auto x = samples.points.array();
  samples.values.col(0) = ((5 * x.row(0)).sin() * (4 * x.row(1)).cos()).transpose();
  const double range = samples.values.maxCoeff() - samples.values.minCoeff();
  const Points<2> at = .95 * cloud<2>(n + 1000, Shape::uniform).rightCols(1000);
  for (const std::string& name : Kernel::names(2)) {
    if (Kernel(name, 2).compact()) continue;
    InterpolateOptions options{.kernel = name, .dense_limit = 1};
    if (Kernel(name, 2).has_scale()) options.support = 8 / std::sqrt(static_cast<double>(n));
    std::printf("| %s | ", name.c_str());
    try {
      const double start = cpu_seconds();
      const Interpolation<2> fast = interpolate(samples, options);
      const double middle = cpu_seconds();
      options.dense_limit = n;
      const Interpolation<2> dense = interpolate(samples, options);
      const double end = cpu_seconds();
      const double difference =
          (fast.components[0]->evaluate(at).value - dense.components[0]->evaluate(at).value).cwiseAbs().maxCoeff();
      std::printf("%.1e | %d | %.2f | %.2f |\n", difference / range, fast.report.iterations, middle - start,
                  end - middle);
    } catch (const std::exception& error) {
      std::printf("%s | | | |\n", error.what());
    }
    std::fflush(stdout);
  }
}

template <int Dim>
Eigen::VectorXd smooth_function(const Points<Dim>& x) {
  return ((5 * x.row(0).array()).sin() * (4 * x.row(Dim - 1).array()).cos() + x.row(Dim - 2).array()).transpose();
}

// The root mean square error of the smoothing that is chosen, beside that of the best one, which the truth tells.
template <int Dim>
void chosen_smoothing(const char* name, Index n, Shape shape, const char* what, double noise) {
  const Points<Dim> all = cloud<Dim>(2 * n, shape);
  const auto every_other = [&](Index first) { return Points<Dim>(all(Eigen::all, Eigen::seqN(first, n, 2))); };
  Samples<Dim> samples{every_other(0), Eigen::MatrixXd(n, 1), {}};
  const Points<Dim> at = every_other(1);
  std::mt19937_64 random(11);
  std::normal_distribution<double> normal;
  samples.values.col(0) = smooth_function<Dim>(samples.points);
  const Eigen::VectorXd truth = smooth_function<Dim>(at);
  for (double& value : samples.values.reshaped()) value += noise * normal(random);
  const auto error = [&](const Interpolation<Dim>& fit) {
    return std::sqrt((fit.components[0]->evaluate(at).value - truth).squaredNorm() / static_cast<double>(n));
  };
  const double start = cpu_seconds();
  const Interpolation<Dim> fit = interpolate(samples, {.kernel = name, .smoothing = std::nullopt, .dense_limit = 1000});
  const double seconds = cpu_seconds() - start;
  const double chosen = error(fit);
  double best = chosen, at_best = fit.report.smoothing;
  for (const double factor : {.5, 2.}) {  // downhill
    for (;;) {
      const double lambda = factor * at_best;
      const double e =
          error(interpolate(samples, {.kernel = name, .smoothing = lambda, .dense_limit = 1000, .tolerance = 1e-4}));
      if (e >= best) break;
      best = e;
      at_best = lambda;
    }
  }
  std::printf("| %s, %dD, %s, noise %g | %ld | %.2e | %.2e | %.4g | %.4g | %.3f | %.4g | %d | %.2f |\n", name, Dim,
              what, noise, static_cast<long>(n), fit.report.smoothing, at_best, chosen, best, chosen / best,
              fit.report.leave_one_out, fit.report.iterations, seconds);
  std::fflush(stdout);
}

void all_smoothing(Index n) {
  std::printf(
      "## Smoothing\n\nThe smoothing that is chosen and the best one, by factors of 2: their root mean square errors "
      "at as many other points, against the truth, whose values have a deviation of about .8.\n\n"
      "| samples | N | chosen | best | its error | best error | ratio | left-out errors | iterations | seconds |\n"
      "|---|---|---|---|---|---|---|---|---|---|\n");
  for (const double noise : {.01, .1, .5}) {
    chosen_smoothing<2>("thin-plate", n, Shape::uniform, "uniform", noise);
    chosen_smoothing<2>("thin-plate", n, Shape::clusters, "clusters", noise);
    chosen_smoothing<2>("thin-plate", n, Shape::tracks, "tracks", noise);
    chosen_smoothing<3>("linear", n, Shape::uniform, "uniform", noise);
    chosen_smoothing<3>("cubic", n, Shape::uniform, "uniform", noise);
  }
}

// Deviations from near and spread samples, which more than 4000 have, against those from all: of 4000 samples, and the
// same with one more far away.
template <int Dim>
void deviations(const char* name, Shape shape, const char* what, double lambda) {
  constexpr Index n = 4000;
  Points<Dim> x = cloud<Dim>(n, shape);
  const Kernel kernel(name, Dim);
  const auto power = [&](const Points<Dim>& points) {
    const auto basis = std::make_shared<const RadialBasis<Dim>>(
        kernel, points, Eigen::VectorXd::Constant(1, kernel.has_scale() ? .3 : 1));
    return std::make_unique<const PowerFunction<Dim>>(basis, std::max(0, kernel.order() - 1), lambda,
                                                      Eigen::VectorXd());
  };
  const Points<Dim> at = .9 * cloud<Dim>(n + 2000, shape).rightCols(2000);
  double start = cpu_seconds();
  const Eigen::ArrayXd all = power(x)->evaluate(at).array().sqrt();
  const double dense = cpu_seconds() - start;
  x.conservativeResize(Dim, n + 1);
  x.col(n) = Point<Dim>::Constant(1.2);
  start = cpu_seconds();
  const Eigen::ArrayXd near = power(x)->evaluate(at).array().sqrt();
  const double fast = cpu_seconds() - start;
  Eigen::ArrayXd ratio = near / all;
  std::sort(ratio.begin(), ratio.end());
  std::printf("| %s, %dD, %s | %g | %.3f | %.3f | %.3f | %.3f | %.2f | %.2f |\n", name, Dim, what, lambda, ratio[0],
              ratio[1000], ratio[1980], ratio[1999], fast, dense);
  std::fflush(stdout);
}

void all_deviations() {
  std::printf(
      "## Deviations\n\nThose of more than 4000 samples, from near and spread ones, over those from all of 4000, at "
      "2000 points.\n\n"
      "| kernel and points | smoothing | least | median | 99 %% | largest | seconds | dense |\n"
      "|---|---|---|---|---|---|---|---|\n");
  for (const double lambda : {0., 1e-3, .1}) {
    deviations<2>("thin-plate", Shape::uniform, "uniform", lambda);
    deviations<2>("thin-plate", Shape::tracks, "tracks", lambda);
    deviations<2>("matern-c2", Shape::uniform, "uniform", lambda);
    deviations<3>("linear", Shape::uniform, "uniform", lambda);
    deviations<3>("linear", Shape::clusters, "clusters", lambda);
  }
}

void surface(const char* cloud, const char* reference) {
  const PointCloud points = read_points(cloud);
  const double start = cpu_seconds();
  const Reconstruction result = reconstruct(points, {.method = "carr", .normals = Normals::file});
  const double fitted = cpu_seconds();
  const Mesh mesh = polygonize(*result.field, {.seeds = points.points});
  const double meshed = cpu_seconds();
  const MeshComparison c = compare(mesh, read_mesh(reference));
  std::printf(
      "## A surface\n\nBiharmonic, `--method carr`: %ld points with normals, %ld centres with those off the surface. "
      "The "
      "chamfer distance is in units of 1e-4 of the diagonal.\n\n"
      "| fit and distances | mesh | chamfer | closed | components |\n|---|---|---|---|---|\n"
      "| %.1f s | %.1f s | %.2f | %s | %ld |\n",
      static_cast<long>(points.size()), static_cast<long>(result.report.centers), fitted - start, meshed - fitted,
      1e4 * c.chamfer_mean, c.topology.watertight() ? "yes" : "no", static_cast<long>(c.topology.components));
}

}  // namespace

int main(int argc, char** argv) {
  const std::string part = argc > 2 ? argv[1] : "";
  if (part == "sums") return all_sums(std::atol(argv[2])), 0;
  if (part == "systems") return all_systems(std::atol(argv[2])), 0;
  if (part == "dense") return against_dense(std::atol(argv[2])), 0;
  if (part == "smoothing") return all_smoothing(std::atol(argv[2])), 0;
  if (argc == 2 && std::string(argv[1]) == "deviations") return all_deviations(), 0;
  if (part == "surface" && argc > 3) return surface(argv[2], argv[3]), 0;
  std::fprintf(stderr,
               "usage: global_functions sums LARGEST | systems LARGEST | dense N | smoothing N | deviations | surface "
               "CLOUD.ply MESH.ply\n");
  return 2;
}
