#include "csrbf/implicit/polygonize_part.hpp"

#include "implicit/polygonize_fields.hpp"

#include <map>

namespace csrbf::polygonize_part_test {
namespace {

using polygonization::Cell;
using polygonization::CellLattice;
using polygonization::CellRange;

CellLattice lattice_of(const Field<3>& field, const PolygonizeOptions& options) {
  return polygonization::lattice_around(field.bounds(), field.bounds().extent().maxCoeff() / options.resolution);
}

// The lattice cut at some cells along each axis.
std::vector<CellRange> cut(const CellLattice& lattice, const std::array<std::vector<int>, 3>& at) {
  std::vector<CellRange> ranges{{Cell::Zero(), lattice.cells}};
  for (int axis = 0; axis < 3; ++axis)
    for (const int cell : at[axis]) {
      std::vector<CellRange> next;
      for (CellRange range : ranges) {
        if (range.first[axis] < cell && cell < range.last[axis]) {
          CellRange below = range;
          below.last[axis] = range.first[axis] = cell;
          next.push_back(below);
        }
        next.push_back(range);
      }
      ranges = next;
    }
  return ranges;
}

// Makes the parts, again where others find the surface to go on, and joins them by their keys.
Mesh weld(const Field<3>& field, const CellLattice& lattice, const std::vector<CellRange>& ranges,
          const PolygonizeOptions& options) {
  std::vector<MeshPart> parts(ranges.size());
  std::vector<std::vector<Cell>> starts(ranges.size());
  for (bool complete = false; !complete;) {
    complete = true;
    for (std::size_t r = 0; r < ranges.size(); ++r)
      parts[r] = polygonize_part(field, lattice, ranges[r], starts[r], options);
    for (const MeshPart& part : parts)
      for (const Cell& cell : part.beyond)
        for (std::size_t r = 0; r < ranges.size(); ++r) {
          const auto same = [&](const Cell& other) { return (other == cell).all(); };
          if (!ranges[r].contains(cell)) continue;
          if (std::any_of(parts[r].border.begin(), parts[r].border.end(), same)) continue;
          if (std::any_of(starts[r].begin(), starts[r].end(), same)) continue;
          starts[r].push_back(cell);
          complete = false;
        }
  }
  Mesh mesh;
  std::map<std::int64_t, std::int32_t> known;
  std::vector<Point<3>> vertices;
  std::vector<Eigen::Vector3i> triangles;
  for (const MeshPart& part : parts) {
    std::vector<std::int32_t> number(part.mesh.vertices.cols(), -1);
    for (const polygonization::SharedVertex& s : part.shared) {
      const auto found = known.find(s.key);
      if (found == known.end()) continue;
      number[s.vertex] = found->second;
      EXPECT_EQ(vertices[found->second], part.mesh.vertices.col(s.vertex));  // the same bits
    }
    for (std::size_t v = 0; v < number.size(); ++v) {
      if (number[v] >= 0) continue;
      number[v] = static_cast<std::int32_t>(vertices.size());
      vertices.emplace_back(part.mesh.vertices.col(static_cast<Index>(v)));
    }
    for (const polygonization::SharedVertex& s : part.shared) known.emplace(s.key, number[s.vertex]);
    for (Index t = 0; t < part.mesh.triangles.cols(); ++t) {
      const Eigen::Vector3i v = part.mesh.triangles.col(t);
      triangles.emplace_back(number[v[0]], number[v[1]], number[v[2]]);
    }
  }
  mesh.vertices = columns(vertices);
  mesh.triangles.resize(3, std::ssize(triangles));
  for (Index t = 0; t < mesh.triangles.cols(); ++t) mesh.triangles.col(t) = triangles[t];
  return mesh;
}

// Triangles by the positions of their corners, in no order.
std::vector<std::array<double, 9>> sorted_triangles(const Mesh& mesh) {
  std::vector<std::array<double, 9>> all;
  for (Index t = 0; t < mesh.triangles.cols(); ++t) {
    std::array<std::array<double, 3>, 3> corners;
    for (int c = 0; c < 3; ++c) {
      const Point<3> p = mesh.vertices.col(mesh.triangles(c, t));
      corners[c] = {p[0], p[1], p[2]};
    }
    std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
    all.push_back({});
    for (int c = 0; c < 9; ++c) all.back()[c] = corners[c / 3][c % 3];
  }
  std::sort(all.begin(), all.end());
  return all;
}

// The same triangles; but edges that are too short are not collapsed where parts meet.
void expect_same(const Mesh& parts, const Mesh& whole) {
  const std::vector<std::array<double, 9>> a = sorted_triangles(parts), b = sorted_triangles(whole);
  std::vector<std::array<double, 9>> common;
  std::set_intersection(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(common));
  const std::size_t collapsed = a.size() - b.size();
  EXPECT_LE(collapsed, 4);
  EXPECT_GE(common.size() + 3 * collapsed, b.size());
}

Implicit two_balls() {
  const auto f = [](const Point<3>& p, Point<3>& gradient) {
    Point<3> other;
    const double a = ball(p, {-0.5, 0.03, 0.01}, 0.6, gradient), b = ball(p, {0.52, 0, 0}, 0.55, other);
    if (b > a) gradient = other;
    return std::max(a, b);
  };
  return Implicit(f, cube(1.2), columns({Point<3>(-1.1, 0.03, 0.01)}));
}

// A ball that is not symmetric on the lattice, where vertices would meet.
Implicit lopsided(const Point<3>& seed = off_center + Point<3>(1, 0, 0)) {
  const auto f = [](const Point<3>& p, Point<3>& gradient) { return ball(p, off_center, 1, gradient); };
  return Implicit(f, cube(1.07), columns({seed}));
}

class PolygonizePart : public testing::TestWithParam<PolygonizeMethod> {};

TEST_P(PolygonizePart, PartsOfASmoothSurfaceFitTogetherToTheWholeMesh) {
  const Implicit field = lopsided();
  const PolygonizeOptions options{.resolution = 20, .method = GetParam()};
  const CellLattice lattice = lattice_of(field, options);
  for (const auto& at :
       {std::array<std::vector<int>, 3>{{{13}, {}, {}}}, {{{6, 15}, {14}, {9, 16}}}, {{{10, 11, 12}, {5, 6}, {17}}}}) {
    const Mesh mesh = weld(field, lattice, cut(lattice, at), options);
    expect_closed_manifold(mesh);
    expect_same(mesh, polygonize(field, options));
  }
}

TEST_P(PolygonizePart, PartsOfACreasedSurfaceAreAClosedManifold) {
  const Implicit field = two_balls();
  const PolygonizeOptions options{.resolution = 33, .method = GetParam()};
  const CellLattice lattice = lattice_of(field, options);
  const Mesh mesh = weld(field, lattice, cut(lattice, {{{12, 21, 30}, {18}, {20, 21}}}), options);
  expect_closed_manifold(mesh);
  EXPECT_EQ(topology(mesh).euler, 2);
  EXPECT_EQ(topology(mesh).components, 1);
}

// Random values at the corners: loops of neighbouring cells meet twice on their common faces.
TEST_P(PolygonizePart, PartsOfNoiseAreAClosedManifold) {
  constexpr int n = 12;
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    const Implicit values = noise(n, seed);
    Points<3> everywhere(3, n * n * n);
    const Box<3> box = values.bounds();
    for (Index i = 0; i < everywhere.cols(); ++i) {
      const Point<3> place(static_cast<double>(i % n), static_cast<double>(i / n % n), static_cast<double>(i / n / n));
      everywhere.col(i) = box.lo + box.extent().cwiseProduct((place.array() + 0.5).matrix()) / n;
    }
    const Implicit field([&](const Point<3>& p, Point<3>& g) { return g.setZero(), values(p); }, box, everywhere);
    PolygonizeOptions options = lattice_of_noise(n);
    options.method = GetParam();
    const double size = box.extent().maxCoeff() / options.resolution;
    const CellLattice lattice = polygonization::lattice_in(options.bounds, size);
    expect_closed_manifold(weld(field, lattice, cut(lattice, {{{4, 5, 9}, {7}, {3, 6, 10}}}), options));
  }
}

// Bridges are cut and holes filled inside parts only: where parts meet, they stay the same bits.
TEST_P(PolygonizePart, PartsOfNoiseWithoutWeakFeaturesAreAClosedManifold) {
  constexpr int n = 24;
  Index euler_of_all = 0, euler = 0;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    const Implicit values = noise(n, seed);
    const Box<3> box = values.bounds();
    Points<3> everywhere(3, n * n * n);
    for (Index i = 0; i < everywhere.cols(); ++i)
      everywhere.col(i) << static_cast<double>(i % n), static_cast<double>(i / n % n), static_cast<double>(i / n / n);
    const Implicit field([&](const Point<3>& p, Point<3>& g) { return g.setZero(), values(p); }, box, everywhere);
    PolygonizeOptions options = lattice_of_noise(n);
    options.method = GetParam();
    const CellLattice lattice = polygonization::lattice_in(options.bounds, box.extent().maxCoeff() / (n - 1));
    const std::vector<CellRange> ranges = cut(lattice, {{{12}, {10}, {13}}});
    euler_of_all += topology(weld(field, lattice, ranges, options)).euler;
    options.persistence = 0.3;
    const Mesh mesh = weld(field, lattice, ranges, options);
    expect_closed_manifold(mesh);
    euler += topology(mesh).euler;
  }
  EXPECT_GT(euler, euler_of_all);
}

// The only seed is in one part: others learn from their neighbours where the surface goes on.
TEST_P(PolygonizePart, ASurfaceIsFollowedThroughPartsWithoutSeeds) {
  const Implicit field = lopsided();
  const PolygonizeOptions options{.resolution = 16, .method = GetParam()};
  const CellLattice lattice = lattice_of(field, options);
  const Mesh mesh = weld(field, lattice, cut(lattice, {{{7, 13, 20}, {13}, {9, 16}}}), options);
  expect_closed_manifold(mesh);
  expect_same(mesh, polygonize(field, options));
}

TEST_P(PolygonizePart, ARangeWithoutSurfaceHasNoTriangles) {
  const Implicit field = sphere(0.3);
  const PolygonizeOptions options{.resolution = 20, .method = GetParam()};
  const CellLattice lattice = lattice_of(field, options);
  const MeshPart part = polygonize_part(field, lattice, {Cell::Zero(), Cell::Constant(4)}, {}, options);
  EXPECT_EQ(part.mesh.triangles.cols(), 0);
  EXPECT_TRUE(part.beyond.empty());
}

INSTANTIATE_TEST_SUITE_P(Methods, PolygonizePart,
                         testing::Values(PolygonizeMethod::marching_cubes, PolygonizeMethod::dual_contouring),
                         [](const auto& instance) {
                           return instance.param == PolygonizeMethod::marching_cubes ? "MarchingCubes"
                                                                                     : "DualContouring";
                         });

TEST(PolygonizePartOptions, MethodsWithoutPartsAreRefused) {
  const Implicit field = sphere();
  const PolygonizeOptions options{.resolution = 20, .method = PolygonizeMethod::adaptive};
  const CellLattice lattice = lattice_of(field, options);
  EXPECT_THROW((void)polygonize_part(field, lattice, {Cell::Zero(), lattice.cells}, {}, options), InvalidInput);
}

}  // namespace
}  // namespace csrbf::polygonize_part_test
