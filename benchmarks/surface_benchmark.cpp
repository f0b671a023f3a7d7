// The kernels of surface reconstruction, from the smallest to the whole. The comment above each says what it cannot do
// without (its floor), to compare with what the machine can do: a core with AVX2 does 16 flops in double precision per
// cycle when all are fused multiply-adds, and four square roots in 9 to 12 cycles.

#include "csrbf/csrbf.hpp"
#include "csrbf/linalg/batched_cholesky.hpp"
#include "csrbf/linalg/gram.hpp"
#include "csrbf/spatial/partition.hpp"
#include "csrbf/surface/composite/composite.hpp"
#include "csrbf/surface/prepare/prepare.hpp"
#include "csrbf/surface/winding/winding_number.hpp"

#include <benchmark/benchmark.h>

#include <map>
#include <numbers>
#include <random>
#include <string>
#include <vector>

namespace {

using csrbf::Derivatives;
using csrbf::Index;
using csrbf::Point;
using csrbf::Points;
using std::numbers::pi;

constexpr Index many = 100'000;   // points of the larger cloud
constexpr Index queries = 8'192;  // points evaluated per iteration
constexpr double major_radius = 1;
constexpr double minor_radius = 0.35;

// n samples of uniform density on the torus around the z axis, with outward normals.
csrbf::PointCloud torus(Index n) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> uniform(0, 1);
  csrbf::PointCloud cloud{Points<3>(3, n), Points<3>(3, n), {}};
  for (Index i = 0; i < n; ++i) {
    const double phi = 2 * pi * uniform(random);
    double theta = 0;
    do {
      theta = 2 * pi * uniform(random);
    } while (uniform(random) * (major_radius + minor_radius) > major_radius + minor_radius * std::cos(theta));
    const Point<3> out(std::cos(phi), std::sin(phi), 0);
    cloud.normals.col(i) = std::cos(theta) * out + std::sin(theta) * Point<3>::UnitZ();
    cloud.points.col(i) = major_radius * out + minor_radius * cloud.normals.col(i);
  }
  return cloud;
}

// The same ready to fit: scaled, in Morton order, with its spacing. Made once.
const csrbf::OrientedPoints& prepared_torus(Index n) {
  static std::map<Index, csrbf::OrientedPoints> made;
  auto found = made.find(n);
  if (found == made.end()) found = made.emplace(n, csrbf::prepare(torus(n), csrbf::Normals::file).cloud).first;
  return found->second;
}

const csrbf::CompositeFit& fitted_torus() {
  static const csrbf::CompositeFit fit = fit_composite(prepared_torus(many), {});
  return fit;
}

const csrbf::Reconstruction& reconstructed_torus() {
  static const csrbf::Reconstruction surface = csrbf::reconstruct(torus(many));
  return surface;
}

// Neighbours in space, as a polygonizer asks for them: consecutive samples of a part of the cloud, each moved along its
// normal by up to `offset` spacings.
Points<3> shell_points(const csrbf::OrientedPoints& cloud, double offset) {
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> uniform(-offset, offset);
  Points<3> x = cloud.points.leftCols(queries);
  for (Index i = 0; i < queries; ++i) x.col(i) += uniform(random) * cloud.spacing[i] * cloud.normals.col(i);
  return x;
}

std::vector<double> random_numbers(Index n) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  std::vector<double> numbers(n);
  for (double& x : numbers) x = normal(random);
  return numbers;
}

void count_items(benchmark::State& state, Index per_iteration) {
  state.SetItemsProcessed(state.iterations() * per_iteration);
}

void count_flops(benchmark::State& state, Index per_iteration) {
  state.counters["flops"] = benchmark::Counter(
      static_cast<double>(per_iteration), benchmark::Counter::kIsIterationInvariantRate, benchmark::Counter::kIs1000);
}

// Entry by entry, F is read once from the first-level cache and A written once: rows n (n + 1) flops per system, eight
// systems. Tiles of 3 x 3 need 6 loads for 9 multiply-adds, so arithmetic is the bound.
void batch_gram(benchmark::State& state) {
  const Index n = state.range(0), rows = 4 * n;
  const std::vector<double> F = random_numbers(csrbf::batch_lanes * rows * n);
  std::vector<double> A(csrbf::batch_matrix_size(n));
  for (auto _ : state) {
    csrbf::batch_gram(F.data(), rows, n, A.data());
    benchmark::ClobberMemory();
  }
  count_items(state, csrbf::batch_lanes);
  count_flops(state, csrbf::batch_lanes * rows * n * (n + 1));
}
BENCHMARK(batch_gram)->ArgName("n")->Arg(10)->Arg(20)->Arg(40);

// n^3 / 3 flops per factor and 2 n^2 per solution, eight systems; the copy that restores the matrix (32 n^2 bytes read
// and written) is part of the time.
void batch_cholesky(benchmark::State& state) {
  const Index n = state.range(0), size = csrbf::batch_matrix_size(n);
  const std::vector<double> F = random_numbers(csrbf::batch_lanes * 2 * n * n);
  std::vector<double> A(size), b = random_numbers(csrbf::batch_lanes * n);
  csrbf::batch_gram(F.data(), 2 * n, n, A.data());
  std::vector<double> L(A.size()), x(b.size());
  for (auto _ : state) {
    L = A;
    x = b;
    csrbf::BatchMask failed = csrbf::batch_cholesky(L.data(), n);
    benchmark::DoNotOptimize(failed);
    csrbf::batch_solve(L.data(), n, x.data());
    benchmark::ClobberMemory();
  }
  count_items(state, csrbf::batch_lanes);
  count_flops(state, csrbf::batch_lanes * (n * n * n / 3 + 2 * n * n));
}
BENCHMARK(batch_cholesky)->ArgName("n")->Arg(10)->Arg(20)->Arg(40);

// rows n (n + 1) flops; 128 rows are 32 samples with their gradients, 11 and 17 columns the quadric and the 16 centres
// of a patch, each with its data. B fits the first-level cache.
void gram(benchmark::State& state) {
  const Index rows = state.range(0), n = state.range(1);
  const std::vector<double> B = random_numbers(rows * n);
  std::vector<double> A(n * n);
  for (auto _ : state) {
    csrbf::gram(B.data(), rows, n, A.data());
    benchmark::ClobberMemory();
  }
  count_items(state, 1);
  count_flops(state, rows * n * (n + 1));
}
BENCHMARK(gram)->ArgNames({"rows", "n"})->Args({128, 11})->Args({128, 17});

// One pass over the points (24 bytes each, 4 for the index) for each of the log2(n / 16) levels: 360 bytes per point at
// 1e5 points, most of them from the caches.
void kd_tree_build(benchmark::State& state) {
  const csrbf::OrientedPoints& cloud = prepared_torus(state.range(0));
  for (auto _ : state) {
    csrbf::KdTree<3> tree(cloud.points);
    benchmark::DoNotOptimize(tree.size());
  }
  count_items(state, cloud.size());
}
BENCHMARK(kd_tree_build)->ArgName("points")->Arg(many / 10)->Arg(many)->Unit(benchmark::kMillisecond);

// A descent of log2(n / 16) levels and the distances to the points of one leaf of 16: 128 flops, 400 bytes; in three
// dimensions a ball of ten points meets several leaves.
void kd_tree_nearest(benchmark::State& state) {
  const csrbf::OrientedPoints& cloud = prepared_torus(state.range(0));
  const csrbf::KdTree<3> tree(cloud.points);
  constexpr Index k = 10;
  Index indices[k];
  double squared_distances[k];
  for (auto _ : state)
    for (Index i = 0; i < queries; ++i) {
      tree.nearest(cloud.points.col(i), k, indices, squared_distances);
      benchmark::ClobberMemory();
    }
  count_items(state, queries);
}
BENCHMARK(kd_tree_nearest)->ArgName("points")->Arg(many / 10)->Arg(many)->Unit(benchmark::kMillisecond);

// Covariance and projection, about 24 flops and 32 bytes per point, for each of the log2(n / 8) levels: 330 flops per
// point at 1e5 points.
void partition(benchmark::State& state) {
  const csrbf::OrientedPoints& cloud = prepared_torus(state.range(0));
  for (auto _ : state) {
    csrbf::PointPartition parts = csrbf::partition<3>(cloud.points, cloud.normals, cloud.spacing, {.leaf_size = 8});
    benchmark::DoNotOptimize(parts.order.data());
  }
  count_items(state, cloud.size());
}
BENCHMARK(partition)
    ->ArgName("points")
    ->Arg(many / 10)
    ->Arg(many)
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime();

// One item is one patch: 32 samples, 128 rows. Rows of the quadric and of 16 centres 20,000 flops, normal matrices
// 56,000, the rest 8,000, and 650 square roots; without centres a fifth of that. On top come, per patch, one search in
// the tree and its share of tree and partition.
void fit_patches(benchmark::State& state) {
  const csrbf::OrientedPoints& cloud = prepared_torus(many / 4);
  csrbf::CompositeOptions options;
  options.centers_per_patch = state.range(0);
  Index patches = 0;
  for (auto _ : state) patches = fit_composite(cloud, options).patches.size();
  count_items(state, patches);
}
BENCHMARK(fit_patches)
    ->ArgName("centers")
    ->Arg(0)
    ->Arg(16)
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime();

// About 4 patches hold a point, and all 16 points of a batch go through every patch that holds one of them. Per point
// and patch: 16 square roots and about 400 flops for values, 600 for gradients, 1,300 for Hessians; 700 bytes of each
// patch, shared by the batch.
void accumulate(benchmark::State& state) {
  const csrbf::Patches& patches = fitted_torus().patches;
  const Points<3> x = shell_points(prepared_torus(many), 1);
  const auto derivatives = static_cast<Derivatives>(state.range(0));
  csrbf::PatchSums sums;
  for (auto _ : state)
    for (Index i = 0; i < queries; i += csrbf::PatchSums::lanes) {
      patches.accumulate(x.middleCols(i, csrbf::PatchSums::lanes), derivatives, sums);
      benchmark::ClobberMemory();
    }
  count_items(state, queries);
}
BENCHMARK(accumulate)->ArgName("derivatives")->DenseRange(0, 2)->Unit(benchmark::kMillisecond);

// The whole field: what accumulate() does, on all threads, and sometimes coarser patches and the winding number.
void evaluate_field(benchmark::State& state) {
  const Points<3> samples = reconstructed_torus().field->seeds();
  const Points<3> x = samples.leftCols(std::min(queries, samples.cols()));
  const auto derivatives = static_cast<Derivatives>(state.range(0));
  for (auto _ : state) {
    csrbf::Jet<3> jet = reconstructed_torus().field->evaluate(x, derivatives);
    benchmark::DoNotOptimize(jet.value.data());
  }
  count_items(state, x.cols());
}
BENCHMARK(evaluate_field)
    ->ArgName("derivatives")
    ->DenseRange(0, 2)
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime();

// Points up to `offset` spacings from the surface. A tricubic polynomial in single precision, 128 flops and 256 bytes,
// and up to 250 samples of 28 bytes nearby with 20 flops and a square root each; fewer further out. The cubes are
// there already.
void winding_number(benchmark::State& state) {
  const csrbf::OrientedPoints& cloud = prepared_torus(many);
  const Eigen::VectorXd& areas = fitted_torus().areas;
  const csrbf::WindingNumber winding(
      csrbf::WindingNumber::Data{cloud.points, cloud.normals, areas, 0.7 * areas.cwiseSqrt()});
  const Points<3> x = shell_points(cloud, static_cast<double>(state.range(0)));
  std::vector<double> value(queries);
  winding.evaluate_block(x, {value.data()});
  for (auto _ : state) {
    winding.evaluate_block(x, {value.data()});
    benchmark::ClobberMemory();
  }
  count_items(state, queries);
}
BENCHMARK(winding_number)->ArgName("offset")->Arg(2)->Arg(30)->Unit(benchmark::kMillisecond);

// The sum of its parts: tree and ten neighbours of every point, 12,500 patches (by default) with 16 centres and a third
// as many without, a gradient at every point; besides, the choice of the options, which costs the same for every n.
void reconstruct(benchmark::State& state) {
  const csrbf::PointCloud cloud = torus(state.range(0));
  for (auto _ : state) {
    csrbf::Reconstruction surface = csrbf::reconstruct(cloud);
    benchmark::DoNotOptimize(surface.field.get());
  }
  count_items(state, cloud.size());
}
BENCHMARK(reconstruct)
    ->ArgName("points")
    ->Arg(many)
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime();

// One item is one vertex: about two values and one gradient of the field each, see evaluate_field.
void polygonize(benchmark::State& state) {
  csrbf::PolygonizeStatistics statistics;
  Index vertices = 0;
  for (auto _ : state)
    vertices = csrbf::polygonize(*reconstructed_torus().field, {.statistics = &statistics}).vertices.cols();
  count_items(state, vertices);
  state.counters["vertices"] = static_cast<double>(vertices);
  state.counters["values/vertex"] = static_cast<double>(statistics.values) / static_cast<double>(vertices);
  state.counters["gradients/vertex"] = static_cast<double>(statistics.gradients) / static_cast<double>(vertices);
}
BENCHMARK(polygonize)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime()->UseRealTime();

}  // namespace

BENCHMARK_MAIN();
