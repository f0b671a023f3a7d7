#include "csrbf/approx/fit.hpp"
#include "csrbf/core/parallel.hpp"
#include "csrbf/implicit/polygonize.hpp"
#include "csrbf/levelset/segment.hpp"
#include "csrbf/surface/estimate_normals.hpp"
#include "csrbf/surface/reconstruct.hpp"

#include "property/random_cloud.hpp"

#include <algorithm>
#include <cstdint>
#include <functional>
#include <numeric>
#include <string>

namespace csrbf::determinism_test {
namespace {

/// Of bytes, in a row.
class Hash {
 public:
  template <class Matrix>
  Hash& of(const Matrix& matrix) {
    return of_bytes(matrix.data(), static_cast<std::size_t>(matrix.size()) * sizeof(*matrix.data()));
  }
  [[nodiscard]] std::uint64_t value() const { return std::hash<std::string>{}(bytes_); }

 private:
  Hash& of_bytes(const void* data, std::size_t count) {
    bytes_.append(static_cast<const char*>(data), count);
    return *this;
  }

  std::string bytes_;
};

// Runs `work` with six numbers of threads, four times each with the numbers 0 to 3, and expects the same bits.
template <class Work>
void expect_same_bits(Work&& work) {
  std::uint64_t expected = 0;
  for (const int threads : {1, 2, 3, 4, 7, 16})
    for (int order = 0; order < 4; ++order) {
      set_thread_count(threads);
      const std::uint64_t bits = work(order);
      if (threads == 1 && order == 0) expected = bits;
      EXPECT_EQ(bits, expected) << threads << " threads, order " << order;
    }
  set_thread_count(0);
}

// The numbers 0 to n - 1: ascending, descending, by stride, at random.
std::vector<Index> order_of(Index n, int order) {
  std::vector<Index> ids(n);
  std::iota(ids.begin(), ids.end(), 0);
  if (order == 1) std::reverse(ids.begin(), ids.end());
  if (order == 2) std::stable_sort(ids.begin(), ids.end(), [](Index a, Index b) { return a % 37 < b % 37; });
  if (order == 3) std::shuffle(ids.begin(), ids.end(), std::mt19937_64(1));
  return ids;
}

// Values, gradients and Hessians at points asked for in that order, put back into their own.
template <int Dim>
std::uint64_t evaluated(const Field<Dim>& field, const Points<Dim>& x, int order) {
  const std::vector<Index> ids = order_of(x.cols(), order);
  const Jet<Dim> jet = field.evaluate(x(Eigen::all, ids), Derivatives::hessian);
  Jet<Dim> sorted = jet;
  for (std::size_t i = 0; i < ids.size(); ++i) {
    const auto from = static_cast<Index>(i);
    sorted.value[ids[i]] = jet.value[from];
    sorted.gradient.col(ids[i]) = jet.gradient.col(from);
    sorted.hessian.col(ids[i]) = jet.hessian.col(from);
  }
  return Hash().of(sorted.value).of(sorted.gradient).of(sorted.hessian).value();
}

PointCloud sphere_and_box() {
  Random random(1);
  PointCloud cloud{Points<3>(3, 0), Points<3>(3, 0), {}};
  for (const Shape shape : {onto_sphere, onto_box}) {
    PointCloud part{random.in_unit_cube<3>(500), Points<3>(3, 500), {}};
    for (Index i = 0; i < part.size(); ++i) {
      Point<3> x = part.points.col(i), normal = random.direction<3>();
      shape(i, part.size(), x, normal);
      part.points.col(i) = x + 1e-3 * random.direction<3>();
      part.normals.col(i) = normal;
    }
    if (cloud.size() > 0) part.points.array() += 2;
    append(cloud, part);
  }
  return cloud;
}

TEST(Determinism, OfReconstructAndPolygonize) {
  const PointCloud cloud = sphere_and_box();
  expect_same_bits([&](int /*order*/) {
    const Reconstruction surface = reconstruct(cloud);
    Hash hash;
    hash.of(surface.normals);
    for (const auto method : {PolygonizeMethod::marching_cubes, PolygonizeMethod::adaptive}) {
      const Mesh mesh = polygonize(*surface.field, {.resolution = 24, .method = method});
      hash.of(mesh.vertices).of(mesh.triangles).of(mesh.normals);
    }
    return hash.value();
  });
}

TEST(Determinism, OfEvaluatingASurface) {
  const Reconstruction surface = reconstruct(sphere_and_box());
  const Points<3> x = 4 * Random(2).in_unit_cube<3>(1100);
  expect_same_bits([&](int order) { return evaluated<3>(*surface.field, x, order); });
}

TEST(Determinism, OfEstimatedNormals) {
  const Points<3> points = sphere_and_box().points;
  expect_same_bits([&](int /*order*/) { return Hash().of(estimate_normals(points)).value(); });
}

class DeterminismOfFit : public testing::TestWithParam<std::string> {};

TEST_P(DeterminismOfFit, AndOfEvaluatingIt) {
  Random random(3);
  const Index n = GetParam() == "interpolate" ? 100 : 600;
  Samples<2> samples{random.in_unit_cube<2>(n), Eigen::VectorXd(n), {}};
  for (Index i = 0; i < n; ++i)
    samples.values(i) = std::sin(9 * samples.points(0, i)) + samples.points(1, i) + 0.01 * random.normal();
  const Points<2> x = random.in_unit_cube<2>(1100);
  Fit<2> fit;
  expect_same_bits([&](int order) {
    if (order % 2 == 0) fit = csrbf::fit<2>(samples, {.method = GetParam()});
    return evaluated<2>(*fit.components[0], x, order);
  });
}

INSTANTIATE_TEST_SUITE_P(Methods, DeterminismOfFit,
                         testing::Values("interpolate", "partition-of-unity", "fixed-budget", "error-bounded",
                                         "moving-least-squares"),
                         [](const auto& method) {
                           std::string name = method.param;
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

// So many that they are evaluated in larger blocks, each in an order of its own.
TEST(Determinism, OfEvaluatingManyPoints) {
  Random random(5);
  Samples<2> samples{random.in_unit_cube<2>(3000), Eigen::VectorXd(3000), {}};
  for (Index i = 0; i < samples.size(); ++i) samples.values(i) = std::sin(9 * samples.points(0, i));
  const Points<2> x = random.in_unit_cube<2>(300000);
  for (const char* method : {"partition-of-unity", "error-bounded"}) {
    const auto field = fit<2>(samples, {.method = method}).components[0];
    const std::uint64_t expected = evaluated<2>(*field, x, 0);
    for (const int threads : {1, 3})
      for (const int order : {0, 1, 3}) {
        set_thread_count(threads);
        EXPECT_EQ(evaluated<2>(*field, x, order), expected) << method << ", " << threads << " threads, order " << order;
      }
    set_thread_count(0);
  }
}

TEST(Determinism, OfSegment) {
  VolumeLayout layout;
  layout.grid.size = {16, 14, 12};
  Volume<float> image(layout);
  Random random(4);
  const Points<3> x = layout.grid.centers<3>();
  for (Index i = 0; i < x.cols(); ++i) {
    const double inside = (x.col(i) - Point<3>(7, 6, 5)).norm() < 4 ? 1 : 0;
    image.values[i] = static_cast<float>(inside + 0.3 * random.normal());
  }
  Segmentation<3> result;
  expect_same_bits([&](int order) {
    if (order % 2 == 0) result = segment<3>(image);
    return Hash().of(result.labels).value() ^ evaluated<3>(*result.fields[0], x, order);
  });
}

}  // namespace
}  // namespace csrbf::determinism_test
