// How far the main jobs are from what the machine allows: for each the least arithmetic and the least traffic with
// memory that its method needs, the times these would take at the rates measured here, and the time it takes.
// Prints a table in Markdown.

#include "csrbf/approx/fit.hpp"
#include "csrbf/approx/unity/partition_of_unity.hpp"
#include "csrbf/approx/unity/partition_of_unity_field.hpp"
#include "csrbf/core/lanes.hpp"
#include "csrbf/core/parallel.hpp"
#include "csrbf/implicit/polygonize.hpp"
#include "csrbf/levelset/lattice/lattice.hpp"
#include "csrbf/levelset/segment.hpp"
#include "csrbf/spatial/radix_sort.hpp"
#include "csrbf/surface/composite/composite_field.hpp"
#include "csrbf/surface/reconstruct.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <functional>
#include <numbers>
#include <random>
#include <vector>

namespace {

using namespace csrbf;
using std::numbers::pi;

constexpr int runs = 5;
constexpr Index samples = 1'000'000;
constexpr double bytes_per_number = sizeof(double);

double seconds_of(const std::function<void()>& job) {
  const auto start = std::chrono::steady_clock::now();
  job();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

struct Time {
  double median, least, most;
};

Time time_of(const std::function<void()>& job) {
  std::vector<double> seconds;
  for (int run = 0; run < runs; ++run) seconds.push_back(seconds_of(job));
  std::sort(seconds.begin(), seconds.end());
  return {seconds[runs / 2], seconds.front(), seconds.back()};
}

// Multiplications and additions by the widest instructions the library uses: independent chains, all in registers.
CSRBF_ALWAYS_INLINE double multiply_add(Index rounds) {
  constexpr int chains = 10;
  Doubles sums[chains];
  for (int c = 0; c < chains; ++c) sums[c] = Doubles(0.1 * c);
  const Doubles a(0.999), b(1e-3);
  for (Index i = 0; i < rounds; ++i)
    for (int c = 0; c < chains; ++c) sums[c] = b + sums[c] * a;
  double result[Doubles::size] = {};
  for (int c = 1; c < chains; ++c) sums[0] += sums[c];
  sums[0].store(result);
  return result[0];
}

// Of all threads together, operations a second.
double arithmetic_rate() {
  constexpr Index rounds = 20'000'000;
  const auto threads = static_cast<Index>(thread_count());
  std::vector<double> results(threads);
  const Time time = time_of(
      [&] { parallel_for(threads, 1, [&](Index begin, Index) { results[begin] = simd<multiply_add>(rounds); }); });
  constexpr double operations = 2.0 * 10 * Doubles::size * rounds;
  return results.front() == 0 ? 0 : operations * static_cast<double>(threads) / time.least;
}

// Of all threads together, bytes a second: a[i] = b[i] + s c[i] reads two numbers and writes one.
double memory_rate() {
  constexpr Index n = 1 << 25;
  std::vector<double> a(n), b(n, 1.0), c(n, 2.0);
  const Time time = time_of([&] {
    parallel_for(n, 1 << 20, [&](Index begin, Index end) {
      for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i) a[i] = b[i] + 3 * c[i];
    });
  });
  return 3 * bytes_per_number * n / time.least;
}

// Bringing the samples, `numbers` numbers each, into the order of the cells they are in, when these are known: a radix
// sort of the cells, then a copy in their order. What finds its way can hardly do with less.
double sorting_seconds(Index cells, Index numbers) {
  std::mt19937 random(1);
  std::uniform_int_distribution<std::uint32_t> cell(0, static_cast<std::uint32_t>(cells - 1));
  std::vector<Keyed> given(samples);
  for (std::size_t i = 0; i < given.size(); ++i) given[i] = {cell(random), static_cast<std::uint32_t>(i)};
  std::vector<double> from(samples * numbers, 1.0), to(from.size());
  std::vector<Keyed> items;
  std::vector<double> seconds;
  for (int run = 0; run < runs; ++run) {
    items = given;
    seconds.push_back(seconds_of([&] {
      radix_sort(items, static_cast<std::uint32_t>(cells));
      parallel_for(samples, 1 << 14, [&](Index begin, Index end) {
        for (Index i = begin; i < end; ++i)
          std::copy_n(from.data() + numbers * items[i].index, numbers, to.data() + numbers * i);
      });
    }));
  }
  return *std::min_element(seconds.begin(), seconds.end());
}

struct Rates {
  double operations, bytes;
};

// `sorting`: seconds, 0 where nothing has to be sorted.
void print_row(const char* job, double operations, double bytes, double sorting, const Time& time, const Rates& rates) {
  const double by_operations = operations / rates.operations, by_bytes = bytes / rates.bytes;
  const double floor = std::max(by_operations, by_bytes);
  std::printf("| %s | %.2f | %.3f | %.3f | %.3f | %.3f | %.3f | %.3f-%.3f | %.1f | %.1f |\n", job, operations * 1e-9,
              bytes * 1e-9, by_operations, by_bytes, sorting, time.median, time.least, time.most, time.median / floor,
              time.median / (floor + sorting));
  std::fflush(stdout);
}

// A kernel of compact support: squared distance, root, polynomial of the distance.
constexpr double kernel_operations(int dim) {
  return 3 * dim + 14;
}

// Rows of the least squares system, its normal equations (lower triangle), Cholesky, two triangular systems; with a
// centre at every sample the kernel matrix is factored itself.
double patch_operations(int dim, double n, double polynomial, double centers) {
  const double kernels = kernel_operations(dim);
  const auto normal_equations = [n](double columns) { return n * columns * (columns + 1); };
  const auto solve = [](double unknowns) { return unknowns * unknowns * unknowns / 3 + 2 * unknowns * unknowns; };
  if (centers >= n)
    return n * polynomial + normal_equations(polynomial + 1) + solve(polynomial) + n * n / 2 * kernels + solve(n);
  return n * polynomial + n * centers * kernels + normal_equations(polynomial + centers + 1) +
         solve(polynomial + centers);
}

double franke(double x, double y) {
  return .75 * std::exp(-(std::pow(9 * x - 2, 2) + std::pow(9 * y - 2, 2)) / 4) +
         .75 * std::exp(-std::pow(9 * x + 1, 2) / 49 - (9 * y + 1) / 10) +
         .5 * std::exp(-(std::pow(9 * x - 7, 2) + std::pow(9 * y - 3, 2)) / 4) -
         .2 * std::exp(-std::pow(9 * x - 4, 2) - std::pow(9 * y - 7, 2));
}

template <int Dim>
Samples<Dim> random_samples() {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> uniform(0, 1);
  Samples<Dim> result{Points<Dim>(Dim, samples), Eigen::MatrixXd(samples, 1), {}};
  for (Index i = 0; i < samples; ++i) {
    for (int a = 0; a < Dim; ++a) result.points(a, i) = uniform(random);
    result.values(i, 0) = franke(result.points(0, i), result.points(1, i)) + (Dim > 2 ? result.points(Dim - 1, i) : 0);
  }
  return result;
}

template <int Dim>
void fit_rows(const Rates& rates, const char* fit_name, const char* evaluate_name) {
  const Samples<Dim> given = random_samples<Dim>();
  Fit<Dim> result;
  const Time fit_time = time_of([&] { result = fit(given, {.method = "partition-of-unity"}); });
  const FitReport& report = result.report;
  const PartitionReport& partition = *report.partition;
  const auto n = static_cast<double>(partition.samples_per_patch), patches = static_cast<double>(partition.patches);
  const double centers = static_cast<double>(report.centers) / patches;
  const auto polynomial = static_cast<double>(Polynomials<Dim>::size(report.degree));
  const double model = patches * (1 + Dim + polynomial + centers * (Dim + 1)) * bytes_per_number;
  print_row(fit_name, patches * patch_operations(Dim, n, polynomial, centers),
            static_cast<double>(samples) * (Dim + 1) * bytes_per_number + model,
            sorting_seconds(partition.patches, Dim + 1), fit_time, rates);

  // Every point lies in growth^Dim supports: weights, local coordinates, monomials with coefficients, kernels.
  const Points<Dim> queries = random_samples<Dim>().points.rowwise().reverse();
  Eigen::VectorXd values;
  const Time time = time_of([&] { values = result.components.front()->evaluate(queries).value; });
  const double each = 9 * Dim + 3 * polynomial + centers * (kernel_operations(Dim) + 2);
  print_row(evaluate_name, static_cast<double>(samples) * std::pow(cover_growth<Dim>, Dim) * each,
            static_cast<double>(samples) * (Dim + 1) * bytes_per_number + model,
            sorting_seconds(partition.patches, Dim + 1), time, rates);
}

PointCloud torus() {
  PointCloud cloud{Points<3>(3, samples), Points<3>(3, samples), {}};
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (Index i = 0; i < samples;) {
    const double u = 2 * pi * uniform(random), v = 2 * pi * uniform(random);
    if (uniform(random) > (1 + .4 * std::cos(v)) / 1.4) continue;
    cloud.normals.col(i) << std::cos(v) * std::cos(u), std::cos(v) * std::sin(u), std::sin(v);
    cloud.points.col(i) = Point<3>(std::cos(u), std::sin(u), 0) + .4 * cloud.normals.col(i);
    ++i;
  }
  return cloud;
}

// Mean number of patches over points of the surface.
double patches_over(const Patches& patches, const PointCloud& cloud, const CompositeField::Data& data) {
  constexpr Index probes = 500;
  double over = 0;
  for (Index i = 0; i < probes; ++i) {
    const Point<3> x = (cloud.points.col(i * samples / probes) - data.origin) / data.scale;
    for (const Patch& patch : patches.patches()) {
      Point<3> q = patch.T * (x - patch.center);
      q[2] *= patch.flatness;
      over += q.squaredNorm() < 1 ? 1 : 0;
    }
  }
  return over / probes;
}

void surface_rows(const Rates& rates) {
  const PointCloud cloud = torus();
  Reconstruction result;
  const Time fit_time = time_of([&] { result = reconstruct(cloud); });
  const auto& data = dynamic_cast<const CompositeField&>(*result.field).data();
  const CompositeSettings& options = result.report.composite->settings;
  const double n = options.overlap * static_cast<double>(options.leaf_size);
  double operations = 0, model = 0;
  for (const Patches& level : data.levels) {
    const auto patches = static_cast<double>(level.size()), centers = static_cast<double>(level.centers()) / patches;
    // Values and gradients: four rows per sample for the quadric, then for the radial functions.
    operations += patches * (4 * n * 10 * 11 + 1000.0 / 3 + n * centers * (2 * kernel_operations(3)) +
                             4 * n * centers * (centers + 1) + std::pow(centers, 3) / 3);
    model +=
        static_cast<double>(level.size()) * sizeof(Patch) + static_cast<double>(level.centers()) * 4 * bytes_per_number;
  }
  const double cloud_bytes = static_cast<double>(samples) * 6 * bytes_per_number;
  print_row("reconstruct, 1e6 points", operations, cloud_bytes + model, sorting_seconds(data.levels.front().size(), 6),
            fit_time, rates);

  PolygonizeStatistics statistics;
  Mesh mesh;
  const Time time = time_of([&] {
    mesh = polygonize(*result.field, {.resolution = automatic_resolution(*result.field), .statistics = &statistics});
  });
  const double over = patches_over(data.levels.front(), cloud, data),
               centers =
                   static_cast<double>(data.levels.front().centers()) / static_cast<double>(data.levels.front().size());
  const double value = over * (15 + 18 + 8 + 20 + centers * (kernel_operations(3) + 2));
  const double gradient = over * (15 + 36 + 16 + 30 + 15 + centers * (kernel_operations(3) + 18));
  print_row("its mesh",
            static_cast<double>(statistics.values - statistics.gradients) * value +
                static_cast<double>(statistics.gradients) * gradient,
            model + static_cast<double>(mesh.vertices.cols()) * 6 * bytes_per_number +
                static_cast<double>(mesh.triangles.cols()) * 3 * sizeof(int),
            0, time, rates);
}

void segment_row(const Rates& rates) {
  constexpr Index side = 256;
  VolumeLayout layout;
  layout.grid.axes = 3;
  layout.grid.size = {side, side, side};
  Volume<float> image(layout);
  std::mt19937_64 random(1);
  std::normal_distribution<float> noise(0, 20);
  for (Index z = 0, i = 0; z < side; ++z)
    for (Index y = 0; y < side; ++y)
      for (Index x = 0; x < side; ++x, ++i) {
        const double k = 2 * pi / 64;
        const double g = std::sin(k * static_cast<double>(x)) * std::cos(k * static_cast<double>(y)) +
                         std::sin(k * static_cast<double>(y)) * std::cos(k * static_cast<double>(z)) +
                         std::sin(k * static_cast<double>(z)) * std::cos(k * static_cast<double>(x));
        image.values[i] = (g > 0 ? 200.F : 0.F) + noise(random);
      }
  Segmentation<3> result;
  const Time time = time_of([&] { result = segment<3>(image); });
  // Each iteration evaluates the level set at every voxel and spreads the force back to the coefficients.
  const SegmentReport& report = result.report;
  const double taps = 4.0 / 3 * pi * std::pow(LatticeOptions{}.support, 3);
  const auto voxels = static_cast<double>(side * side * side);
  print_row("segment, 256^3 voxels", voxels * report.iterations * 2 * 2 * taps,
            voxels * (static_cast<double>(sizeof(float)) * (1 + report.iterations) + 1), 0, time, rates);
}

}  // namespace

int main() {
  const Rates rates{arithmetic_rate(), memory_rate()};
  std::printf("# What the machine allows\n\n");
  std::printf("%d threads; %.0f Gflop/s, %.1f GB/s, both measured by this program.\n\n", thread_count(),
              rates.operations * 1e-9, rates.bytes * 1e-9);
  std::printf(
      "| job | Gflop | GB | arithmetic s | memory s | sorting s | measured s | spread | ratio to the larger of "
      "arithmetic and memory | with sorting |\n"
      "|---|---:|---:|---:|---:|---:|---:|---|---:|---:|\n");
  fit_rows<2>(rates, "fit, 1e6 samples in 2D", "evaluate it at 1e6 points");
  fit_rows<3>(rates, "fit, 1e6 samples in 3D", "evaluate it at 1e6 points");
  surface_rows(rates);
  segment_row(rates);
  std::printf(R"(
Arithmetic: assembling the rows, normal equations and factors of the local systems at their actual sizes; weights,
polynomials and radial functions of every evaluation; the stencils of every iteration. Memory: inputs are read once,
outputs written once. Sorting: unordered points, such as these, must be sorted by cell before anything can be done cell
by cell; the measurement is one radix sort by known cells and one copy in that order, on all threads, best case. Sorting
comes before the rest, so it adds to the larger of the other two floors. No floor counts searching: finding the cell of
a point, nearest neighbours, choosing options by cross-validation, merging duplicates, errors at the samples, following
the surface. Median of %d runs.
)",
              runs);
}
