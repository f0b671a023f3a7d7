#include "csrbf/core/taylor.hpp"

#include "implicit/polygonize_fields.hpp"

#include <tuple>

namespace csrbf::weak_features_test {
namespace {

using Distance = std::function<double(const Point<3>&)>;

// A field whose gradient is that of differences, good enough for crossings.
class Solid final : public Field<3> {
 public:
  Solid(Distance distance, double half, double persistence = 0)
      : distance_(std::move(distance)), half_(half), persistence_(persistence) {}

  void evaluate_block(const PointsRef<3>& x, const JetBlock& out) const override {
    constexpr double step = 1e-6;
    for (Index i = 0; i < x.cols(); ++i) {
      const Point<3> p = x.col(i) - off_center;
      out.value[i] = distance_(p);
      if (out.gradient == nullptr) continue;
      for (int axis = 0; axis < 3; ++axis) {
        const Point<3> d = step * Point<3>::Unit(axis);
        out.gradient[3 * i + axis] = (distance_(p + d) - distance_(p - d)) / (2 * step);
      }
    }
  }
  [[nodiscard]] Box<3> bounds() const override { return cube(half_); }
  [[nodiscard]] double least_persistence() const override { return persistence_; }

 private:
  Distance distance_;
  double half_, persistence_;
};

constexpr int cells = 40;  // of .07: a corner is within .061 of any point

// A ring about z of radius 1 and thickness .3, but `neck` where it passes the x axis.
double ring(const Point<3>& p, double neck) {
  const double along = std::hypot(p[0] - 1, p[1]);
  const double thickness = neck + (0.3 - neck) * smooth_step(std::min(along / 0.6, 1.0));
  return thickness - std::hypot(std::hypot(p[0], p[1]) - 1, p[2]);
}

// A thick disc with a hole along z.
double washer(const Point<3>& p, double hole) {
  const double r = std::hypot(p[0], p[1]);
  return std::min({0.3 - std::abs(p[2]), r - hole, 1 - r});
}

// Two balls on the x axis joined by a rod.
double dumbbell(const Point<3>& p, double rod) {
  const double balls = 0.4 - std::hypot(std::abs(p[0]) - 0.7, p[1], p[2]);
  return std::max(balls, std::min(rod - std::hypot(p[1], p[2]), 0.7 - std::abs(p[0])));
}

Topology topology_of(const Distance& distance, double persistence, PolygonizeMethod method, Index* removed = nullptr) {
  PolygonizeStatistics statistics;
  const Mesh mesh =
      polygonize(Solid(distance, 1.4),
                 {.resolution = cells, .method = method, .persistence = persistence, .statistics = &statistics});
  expect_closed_manifold(mesh);
  if (removed != nullptr) *removed = statistics.weak_features;
  return topology(mesh);
}

class WeakFeatures : public testing::TestWithParam<PolygonizeMethod> {};

TEST_P(WeakFeatures, ThinBridgesOfRingsAreCut) {
  const auto thin = [](const Point<3>& p) { return ring(p, 0.08); };
  Index removed = -1;
  EXPECT_EQ(topology_of(thin, 0.02, GetParam(), &removed).euler, 0);
  EXPECT_EQ(removed, 0);
  const Topology cut = topology_of(thin, 0.1, GetParam(), &removed);
  EXPECT_EQ(cut.euler, 2);
  EXPECT_EQ(cut.components, 1);
  EXPECT_EQ(removed, 1);
}

TEST_P(WeakFeatures, NarrowHolesAreFilled) {
  const auto narrow = [](const Point<3>& p) { return washer(p, 0.08); };
  Index removed = -1;
  EXPECT_EQ(topology_of(narrow, 0.02, GetParam(), &removed).euler, 0);
  EXPECT_EQ(removed, 0);
  EXPECT_EQ(topology_of(narrow, 0.1, GetParam(), &removed).euler, 2);
  EXPECT_EQ(removed, 1);
}

// A bridge that joins what is separate without it, and a bubble.
TEST_P(WeakFeatures, PartsStayTogetherAndBubblesStay) {
  const auto joined = [](const Point<3>& p) { return dumbbell(p, 0.08); };
  EXPECT_EQ(topology_of(joined, 0.1, GetParam()).components, 1);
  const auto hollow = [](const Point<3>& p) { return std::min(0.6 - p.norm(), p.norm() - 0.08); };
  const Topology bubble = topology_of(hollow, 0.1, GetParam());
  EXPECT_EQ(bubble.components, 2);
  EXPECT_EQ(bubble.euler, 4);
}

// Nothing of them is farther from the level.
TEST_P(WeakFeatures, ThinPlatesAndThinRingsStay) {
  const auto plate = [](const Point<3>& p) { return std::min(0.08 - std::abs(p[2]), 0.9 - p.head<2>().norm()); };
  EXPECT_EQ(topology_of(plate, 0.1, GetParam()).euler, 2);
  const auto thin_ring = [](const Point<3>& p) { return 0.08 - std::hypot(std::hypot(p[0], p[1]) - 1, p[2]); };
  EXPECT_EQ(topology_of(thin_ring, 0.1, GetParam()).euler, 0);
}

INSTANTIATE_TEST_SUITE_P(Methods, WeakFeatures,
                         testing::Values(PolygonizeMethod::marching_cubes, PolygonizeMethod::dual_contouring),
                         [](const auto& instance) {
                           return instance.param == PolygonizeMethod::marching_cubes ? "MarchingCubes"
                                                                                     : "DualContouring";
                         });

// What is cut is where the ring is thin, and the mesh stays as it was elsewhere.
TEST(WeakFeaturesOf, ARingTheMeshChangesBesideTheBridgeOnly) {
  const Solid thin([](const Point<3>& p) { return ring(p, 0.08); }, 1.4);
  const Mesh all = polygonize(thin, {.resolution = cells, .persistence = 0.0});
  const Mesh cut = polygonize(thin, {.resolution = cells, .persistence = 0.1});
  const auto far_vertices = [](const Mesh& mesh) {
    std::vector<std::tuple<double, double, double>> far;
    for (Index i = 0; i < mesh.vertices.cols(); ++i) {
      const Point<3> p = mesh.vertices.col(i);
      if ((p - off_center - Point<3>(1, 0, 0)).norm() > 0.3) far.emplace_back(p[0], p[1], p[2]);
    }
    std::sort(far.begin(), far.end());
    return far;
  };
  EXPECT_EQ(far_vertices(all), far_vertices(cut));
  EXPECT_NE(topology(all).euler, topology(cut).euler);
}

TEST(WeakFeaturesOf, AFieldAreRemovedAsItSaysUnlessToldOtherwise) {
  const auto thin = [](const Point<3>& p) { return ring(p, 0.08); };
  EXPECT_EQ(topology(polygonize(Solid(thin, 1.4, 0.1), {.resolution = cells})).euler, 2);
  EXPECT_EQ(topology(polygonize(Solid(thin, 1.4, 0.1), {.resolution = cells, .persistence = 0})).euler, 0);
  EXPECT_EQ(topology(polygonize(Solid(thin, 1.4), {.resolution = cells})).euler, 0);
}

TEST(WeakFeaturesOf, NoiseLeaveClosedManifoldsWithFewerHandles) {
  Index before = 0, after = 0, parts_before = 0, parts_after = 0;
  for (std::uint64_t seed = 0; seed < 60; ++seed)
    for (const auto method : {PolygonizeMethod::marching_cubes, PolygonizeMethod::dual_contouring,
                              PolygonizeMethod::marching_tetrahedra, PolygonizeMethod::adaptive}) {
      const Implicit field = noise(12, seed, seed % 3 == 2);
      PolygonizeOptions options = lattice_of_noise(12);
      options.method = method;
      const Topology all = topology(polygonize(field, options));
      options.persistence = 0.3;
      const Mesh mesh = polygonize(field, options);
      expect_closed_manifold(mesh);
      EXPECT_TRUE(mesh.vertices.allFinite());
      if (method != PolygonizeMethod::marching_cubes) continue;
      const Topology left = topology(mesh);
      before += all.euler;
      after += left.euler;
      parts_before += all.components;
      parts_after += left.components;
    }
  EXPECT_GT(after, before + 60);
  EXPECT_LE(parts_after, parts_before + 6);  // new parts are those that were not reached before
}

TEST(WeakFeaturesOf, AnyFieldNeedAPersistenceThatIsANumber) {
  for (const double wrong : {-1.0, std::nan(""), std::numeric_limits<double>::infinity()}) try {
      polygonize(sphere(), {.persistence = wrong});
      ADD_FAILURE() << wrong;
    } catch (const InvalidInput& error) {
      EXPECT_TRUE(std::string_view(error.what()).starts_with("polygonize: persistence = ")) << error.what();
    }
}

}  // namespace
}  // namespace csrbf::weak_features_test
