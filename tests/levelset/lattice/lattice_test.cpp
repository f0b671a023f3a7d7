#include "csrbf/levelset/lattice/lattice.hpp"

#include "core/error_testing.hpp"
#include "csrbf/core/parallel.hpp"

#include <gtest/gtest.h>

#include <random>

namespace csrbf::lattice_test {
namespace {

constexpr double float_sums = 2e-6;  // rounding of the sums of a few hundred floats of size 1

std::vector<float> random_coefficients(Index size, unsigned seed) {
  std::mt19937 generator(seed);
  std::uniform_real_distribution<float> uniform(-1, 1);
  std::vector<float> coefficients(size);
  for (float& c : coefficients) c = uniform(generator);
  return coefficients;
}

struct Sampled {
  std::vector<double> value;
  std::vector<std::array<double, 3>> gradient;
};

template <int Dim>
Sampled sample(const Lattice<Dim>& lattice, const std::vector<float>& coefficients) {
  Index voxels = 1;
  for (const Index n : lattice.size()) voxels *= n;
  Sampled result;
  result.value.assign(voxels, std::numeric_limits<double>::quiet_NaN());
  result.gradient.resize(result.value.size());
  lattice.sweep(
      coefficients.data(), true,
      [&](const LatticeRow& row) {
        for (Index i = 0; i < row.count; ++i) {
          const auto voxel = static_cast<std::size_t>(row.voxel + i * row.stride);
          result.value[voxel] = row.value[i];
          for (std::size_t a = 0; a < Dim; ++a) result.gradient[voxel][a] = row.gradient[a][i];
        }
        return 0.0;
      },
      nullptr);
  return result;
}

// The definition: a sum over all nodes for each voxel.
template <int Dim>
void expect_sums_over_nodes(const std::array<Index, 3>& size, const Point<3>& spacing, const LatticeOptions& options) {
  const Lattice<Dim> lattice(size, spacing, options);
  const std::vector<float> coefficients = random_coefficients(lattice.array_size(), 1);
  const Sampled sampled = sample(lattice, coefficients);
  const Point<Dim> first = lattice.first_node(), step = lattice.node_step();
  std::array<Index, 3> nodes{1, 1, 1};
  for (int a = 0; a < Dim; ++a) nodes[a] = lattice.nodes(a);
  std::size_t voxel = 0;
  for (Index z = 0; z < size[2]; ++z)
    for (Index y = 0; y < size[1]; ++y)
      for (Index x = 0; x < size[0]; ++x, ++voxel) {
        const std::array<Index, 3> at{x, y, z};
        double value = 0;
        Point<Dim> gradient = Point<Dim>::Zero();
        std::array<Index, 3> k{};
        for (k[2] = 0; k[2] < nodes[2]; ++k[2])
          for (k[1] = 0; k[1] < nodes[1]; ++k[1])
            for (k[0] = 0; k[0] < nodes[0]; ++k[0]) {
              Point<Dim> d;
              for (int a = 0; a < Dim; ++a) {
                const auto axis = static_cast<std::size_t>(a);
                d[a] = (static_cast<double>(at[axis]) - first[a] - static_cast<double>(k[axis]) * step[a]) *
                       spacing[a] * lattice.stretch()[a];
              }
              const double r = d.norm() / lattice.support();
              if (r >= 1) continue;
              const double c = lattice.scale() * static_cast<double>(coefficients[lattice.coefficient(k)]);
              value += c * lattice.kernel().value(r);
              gradient += c * lattice.kernel().g(r) / (lattice.support() * lattice.support()) *
                          d.cwiseProduct(lattice.stretch().template head<Dim>());
            }
        ASSERT_NEAR(sampled.value[voxel], value, float_sums) << x << " " << y << " " << z;
        for (int a = 0; a < Dim; ++a)
          ASSERT_NEAR(sampled.gradient[voxel][a], gradient[a], float_sums / spacing.head<Dim>().minCoeff());
      }
}

TEST(Lattice, SumsOverAllNodesInThePlane) {
  for (const double center_spacing : {1.0, 1.5, 2.0, 2.97, 4.0, 11.15})
    for (const double support : {1.5, 2.5, 4.0})
      expect_sums_over_nodes<2>({37, 23, 1}, Point<3>(1, 1, 1), {center_spacing, support, "wendland-c2"});
}

TEST(Lattice, SumsOverAllNodesInAVolumeWithLongVoxels) {
  expect_sums_over_nodes<3>({11, 9, 7}, Point<3>(0.5, 0.7, 2), {3, 2, "wendland-c4"});
  expect_sums_over_nodes<3>({9, 8, 5}, Point<3>(0.5, 0.5, 4), {2, 2.5, "wendland-c2"});
  expect_sums_over_nodes<3>({8, 9, 10}, Point<3>(1, 1, 1), {1.5, 2.5, "wendland-c2"});
}

TEST(Lattice, ReachesAsManyCentersAlongLongVoxels) {
  const Lattice<3> lattice({20, 20, 10}, Point<3>(0.5, 0.5, 4), {2, 2.5, "wendland-c2"});
  EXPECT_DOUBLE_EQ(lattice.center_spacing(), 1);
  EXPECT_DOUBLE_EQ(lattice.support(), 2.5);
  EXPECT_EQ(lattice.stretch(), Point<3>(1, 1, 0.25));
  EXPECT_EQ((Lattice<3>({20, 20, 10}, Point<3>(0.5, 0.5, 1), {4, 2.5, "wendland-c2"}).stretch()), Point<3>(1, 1, 1));
}

TEST(Lattice, HasDerivativesThatAreTheAdjointOfItsSums) {
  // sum_v w_v f_v + u_v . grad f_v is linear in the coefficients: its derivatives times them give the sum itself.
  const Lattice<3> lattice({13, 12, 9}, Point<3>(1, 1, 1.5), {2, 2.5, "wendland-c2"});
  const std::vector<float> weights = random_coefficients(4 * 13 * 12 * 9, 2);
  const auto row = [&](const LatticeRow& part) {
    double sum = 0;
    for (Index i = 0; i < part.count; ++i) {
      const float* w = weights.data() + 4 * (part.voxel + i * part.stride);
      sum += static_cast<double>(w[0] * part.value[i]);
      part.value[i] = w[0];
      for (std::size_t a = 0; a < 3; ++a) {
        sum += static_cast<double>(w[a + 1] * part.gradient[a][i]);
        part.gradient[a][i] = w[a + 1];
      }
    }
    return sum;
  };
  for (unsigned seed = 3; seed < 6; ++seed) {
    const std::vector<float> coefficients = random_coefficients(lattice.array_size(), seed);
    std::vector<float> derivatives(coefficients.size());
    const double sum = lattice.sweep(coefficients.data(), true, row, derivatives.data());
    double product = 0;
    for (Index i = 0; i < lattice.coefficients(); ++i)
      product += static_cast<double>(coefficients[i]) * static_cast<double>(derivatives[i]);
    EXPECT_NEAR(product, sum, 2e-5 * static_cast<double>(weights.size()) / 100);
  }
}

TEST(Lattice, IsAtMostOneForCoefficientsUpToOne) {
  const Lattice<2> lattice({40, 30, 1}, Point<3>(1, 1, 1), {3, 2.5, "wendland-c2"});
  const std::vector<float> ones(lattice.array_size(), 1.0F);
  const Sampled sampled = sample(lattice, ones);
  EXPECT_NEAR(*std::max_element(sampled.value.begin(), sampled.value.end()), 1, float_sums);
  EXPECT_GT(*std::min_element(sampled.value.begin(), sampled.value.end()), 0.95);  // also at the border
}

TEST(Lattice, IsSteepestBetweenHalfPlanes) {
  const Lattice<2> lattice({80, 80, 1}, Point<3>(1, 1, 1), {4, 2.5, "wendland-c2"});
  std::vector<float> halves(lattice.array_size(), 0.0F);
  for (Index y = 0; y < lattice.nodes(1); ++y)
    for (Index x = 0; x < lattice.nodes(0); ++x)
      halves[lattice.coefficient({x, y, 0})] = 2 * x < lattice.nodes(0) ? 1.0F : -1.0F;
  const Sampled sampled = sample(lattice, halves);
  double steepest = 0;
  for (const auto& gradient : sampled.gradient) steepest = std::max(steepest, std::abs(gradient[0]));
  EXPECT_NEAR(steepest, lattice.steepest(), 0.03 * lattice.steepest());  // voxels need not lie on the steepest line
}

TEST(Lattice, MirrorsWithTheImage) {
  const Lattice<2> lattice({30, 21, 1}, Point<3>(1, 1, 1), {4, 2, "wendland-c2"});
  const Point<2> first = lattice.first_node();
  for (int a = 0; a < 2; ++a) {
    const double last = first[a] + static_cast<double>(lattice.nodes(a) - 1) * lattice.node_step()[a];
    // Nodes that no voxel needs may lie on one side only.
    EXPECT_NEAR(std::remainder(first[a] + last - static_cast<double>(lattice.size()[a] - 1), lattice.node_step()[a]), 0,
                1e-12);
  }
}

TEST(Lattice, GivesTheSameBitsForEveryThreadCount) {
  const Lattice<3> lattice({40, 33, 20}, Point<3>(1, 1, 1), {2, 2.5, "wendland-c2"});
  const std::vector<float> coefficients = random_coefficients(lattice.array_size(), 7);
  std::vector<std::vector<float>> derivatives;
  std::vector<double> sums;
  for (const int threads : {1, 2, 5}) {
    set_thread_count(threads);
    derivatives.emplace_back(coefficients.size());
    sums.push_back(lattice.sweep(
        coefficients.data(), false,
        [](const LatticeRow& row) {
          double sum = 0;
          for (Index i = 0; i < row.count; ++i) sum += static_cast<double>(row.value[i] * row.value[i]);
          return sum;
        },
        derivatives.back().data()));
  }
  set_thread_count(0);
  EXPECT_EQ(sums[0], sums[1]);
  EXPECT_EQ(sums[0], sums[2]);
  EXPECT_EQ(derivatives[0], derivatives[1]);
  EXPECT_EQ(derivatives[0], derivatives[2]);
}

TEST(Lattice, RefusesWhatItCannotDo) {
  const auto expect_refused = [](const std::array<Index, 3>& size, const Point<3>& spacing,
                                 const LatticeOptions& options, const std::string& said) {
    const std::string message = invalid_input_message([&] { Lattice<2>(size, spacing, options); });
    EXPECT_NE(message.find(said), std::string::npos) << message;
  };
  const Point<3> unit(1, 1, 1);
  expect_refused({1, 5, 1}, unit, {}, "size = 1");
  expect_refused({5, 5, 2}, unit, {}, "size = 2");
  expect_refused({5, 5, 1}, Point<3>(0, 1, 1), {}, "spacing = 0");
  expect_refused({5, 5, 1}, unit, {0.5, 2, "wendland-c2"}, "center_spacing = 0.5");
  expect_refused({5, 5, 1}, unit, {2, 1, "wendland-c2"}, "support = 1");
  expect_refused({5, 5, 1}, unit, {2, 2, "wendland-c0"}, "kernel = wendland-c0");
  expect_refused({5, 5, 1}, unit, {2, 2, "gaussian"}, "kernel = gaussian");
}

}  // namespace
}  // namespace csrbf::lattice_test
