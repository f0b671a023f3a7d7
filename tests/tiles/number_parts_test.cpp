#include "csrbf/tiles/stages/number_parts.hpp"

#include "core/topology_testing.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <random>

namespace csrbf::number_parts_test {
namespace {

constexpr std::int32_t columns = 12, rows = 9;

// A grid of quads closed to a torus; its vertices are anywhere.
Mesh torus() {
  Mesh mesh;
  mesh.vertices = Points<3>::Random(3, columns * rows);
  mesh.normals = Points<3>::Zero(3, columns * rows);
  mesh.triangles.resize(3, 2 * columns * rows);
  Index t = 0;
  for (std::int32_t i = 0; i < columns; ++i)
    for (std::int32_t j = 0; j < rows; ++j) {
      const auto at = [](std::int32_t a, std::int32_t b) { return a % columns * rows + b % rows; };
      mesh.triangles.col(t++) << at(i, j), at(i + 1, j), at(i + 1, j + 1);
      mesh.triangles.col(t++) << at(i, j), at(i + 1, j + 1), at(i, j + 1);
    }
  return mesh;
}

// The mesh without the vertices that no triangle has.
Mesh used(Mesh mesh) {
  std::vector<polygonization::SharedVertex> none;
  polygonization::drop_unused_vertices(mesh, none);
  return mesh;
}

class NumberParts : public testing::Test {
 protected:
  void TearDown() override { folder_.remove("whole"); }

  static std::string path() {
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    return (std::filesystem::temp_directory_path() / (std::string("csrbf_number_parts_") + test->name())).string();
  }

  // Deals the triangles to parts; vertices are known by their number in the whole mesh.
  std::vector<TilePart> deal(const Mesh& mesh, const std::vector<std::size_t>& part_of, std::size_t parts) {
    std::vector<std::set<std::size_t>> users(mesh.vertices.cols());
    for (Index t = 0; t < mesh.triangles.cols(); ++t)
      for (const std::int32_t v : mesh.triangles.col(t)) users[v].insert(part_of[t]);
    std::vector<TilePart> result(parts);
    for (std::size_t p = 0; p < parts; ++p) {
      Mesh part = mesh;
      std::vector<Index> own;
      for (Index t = 0; t < mesh.triangles.cols(); ++t)
        if (part_of[t] == p) own.push_back(t);
      part.triangles = Triangles(mesh.triangles(Eigen::all, own));
      std::vector<polygonization::SharedVertex> shared;
      for (std::int32_t v = 0; v < mesh.vertices.cols(); ++v)
        if (users[v].count(p) > 0 && users[v].size() > 1) shared.push_back({v, 1000 + v});
      polygonization::drop_unused_vertices(part, shared);
      result[p] = {std::move(part), std::move(shared)};
    }
    return result;
  }

  // The parts' seams as files.
  std::vector<std::string> seams(const std::vector<TilePart>& parts) {
    std::vector<std::string> paths;
    for (std::size_t p = 0; p < parts.size(); ++p) {
      Index count = 0;
      const std::vector<Index> component = component_labels(parts[p].mesh, count);
      PartSeam seam = make_seam(parts[p], component);
      seam.supports.assign(static_cast<std::size_t>(count), {.area = 1, .samples = 100, .sample_area = 0.01});
      paths.push_back(folder_.file("seam", static_cast<Index>(p)));
      write_seam(paths.back(), seam);
    }
    return paths;
  }

  TileFolder folder_{path()};
};

TEST_F(NumberParts, CountsAreThoseOfTheWholeMesh) {
  std::mt19937 random(1);
  const Mesh closed = torus();
  for (int trial = 0; trial < 60; ++trial) {
    const std::size_t parts = 1 + trial % 4;
    Mesh mesh = closed;
    std::vector<Index> kept;
    for (Index t = 0; t < closed.triangles.cols(); ++t)
      if (trial % 3 == 0 || random() % 20 > 0) kept.push_back(t);  // holes, and vertices with several fans
    mesh.triangles = Triangles(closed.triangles(Eigen::all, kept));
    for (Index t = 0; t < mesh.triangles.cols(); ++t)
      if (trial % 5 == 0 && random() % 30 == 0) mesh.triangles.col(t).reverseInPlace();
    mesh = used(mesh);
    std::vector<std::size_t> part_of(mesh.triangles.cols());
    for (std::size_t& p : part_of) p = random() % parts;
    const std::vector<std::string> files = seams(deal(mesh, part_of, parts));
    const DroppedComponents dropped = find_dropped(files);
    const Topology expected = topology(mesh);
    EXPECT_EQ(dropped.kept, expected.components);
    EXPECT_EQ(dropped.dropped, 0);
    const Topology found = number_parts(files, dropped.kept, folder_).topology;
    expect_equal(found, expected);
  }
}

TEST_F(NumberParts, NumbersAreTheSameForTheSameVertex) {
  const Mesh mesh = torus();
  std::vector<std::size_t> part_of(mesh.triangles.cols());
  for (std::size_t t = 0; t < part_of.size(); ++t) part_of[t] = 3 * t / part_of.size();
  const std::vector<TilePart> parts = deal(mesh, part_of, 3);
  const WholeMesh whole = number_parts(seams(parts), 1, folder_);
  ASSERT_TRUE(whole.topology.watertight());
  std::map<std::int64_t, std::int32_t> known;
  Index next = 0, triangles = 0;
  for (std::size_t p = 0; p < parts.size(); ++p) {
    const PartNumbers numbers = read_numbers(folder_, static_cast<Index>(p));
    EXPECT_EQ(numbers.first, next);
    EXPECT_EQ(numbers.first_triangle, triangles);
    ASSERT_EQ(numbers.shared.size(), parts[p].shared.size());
    next += parts[p].mesh.vertices.cols();
    triangles += parts[p].mesh.triangles.cols();
    for (std::size_t i = 0; i < numbers.shared.size(); ++i) {
      const auto [entry, added] = known.emplace(parts[p].shared[i].key, numbers.shared[i]);
      EXPECT_EQ(entry->second, numbers.shared[i]);
      if (added)
        EXPECT_GE(numbers.shared[i], numbers.first);
      else
        --next;
    }
  }
  EXPECT_EQ(next, whole.topology.vertices);
}

TEST_F(NumberParts, ComponentsWithoutDataAreLeftOutOfAllParts) {
  const Mesh one = torus();
  Mesh two = one;  // a second torus, in other parts of the file
  two.vertices.conservativeResize(3, 2 * one.vertices.cols());
  two.vertices.rightCols(one.vertices.cols()) = one.vertices.array() + 10.0;
  two.normals = Points<3>::Zero(3, two.vertices.cols());
  two.triangles.conservativeResize(3, 2 * one.triangles.cols());
  two.triangles.rightCols(one.triangles.cols()) =
      one.triangles.array() + static_cast<std::int32_t>(one.vertices.cols());
  std::vector<std::size_t> part_of(two.triangles.cols());
  for (std::size_t t = 0; t < part_of.size(); ++t) part_of[t] = t % 2;
  const std::vector<std::string> files = seams(deal(two, part_of, 2));
  for (const std::string& file : files) {
    PartSeam seam = read_seam(file);
    ASSERT_EQ(seam.supports.size(), 2U);
    seam.supports[1].samples = 0;
    write_seam(file, seam);
  }
  write_dropped(folder_.file("dropped"), find_dropped(files));
  const DroppedComponents dropped = read_dropped(folder_.file("dropped"), 2);
  EXPECT_EQ(dropped.kept, 1);
  EXPECT_EQ(dropped.dropped, 1);
  for (const std::set<std::int32_t>& of_part : dropped.of_part) EXPECT_EQ(of_part, std::set<std::int32_t>{1});
}

}  // namespace
}  // namespace csrbf::number_parts_test
