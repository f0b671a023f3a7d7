#include "csrbf/io/point_stream.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/io/files/atomic_file.hpp"
#include "csrbf/io/files/read_file.hpp"
#include "csrbf/io/points.hpp"

#include <gtest/gtest.h>

#include <filesystem>

namespace csrbf::point_stream_test {
namespace {

PointCloud some_points(bool normals) {
  PointCloud cloud;
  cloud.points = Points<3>::Random(3, 1000).cast<float>().cast<double>();
  if (normals) cloud.normals = Points<3>::Random(3, 1000).colwise().normalized().cast<float>().cast<double>();
  return cloud;
}

class PointStreamFormats : public ::testing::TestWithParam<const char*> {};

TEST_P(PointStreamFormats, PiecesAreWhatTheWholeFileHas) {
  for (const bool normals : {false, true}) {
    const std::string path = ::testing::TempDir() + "stream" + GetParam();
    write_points(path, some_points(normals));
    const PointCloud whole = read_points(path);
    PointStream stream(path);
    ASSERT_EQ(stream.size(), 1000);
    for (const auto& [begin, end] : {std::pair<Index, Index>{700, 1000}, {0, 1}, {1, 640}, {640, 700}, {5, 5}}) {
      const PointCloud part = stream.read(begin, end);
      EXPECT_EQ(part.points, whole.points.middleCols(begin, end - begin));
      if (normals && end > begin) {
        EXPECT_EQ(part.normals, whole.normals.middleCols(begin, end - begin));
      }
    }
    EXPECT_THROW((void)stream.read(0, 1001), InvalidInput);
    std::filesystem::remove(path);
  }
}

INSTANTIATE_TEST_SUITE_P(Formats, PointStreamFormats, ::testing::Values(".ply", ".npy", ".xyz", ".csv"),
                         [](const auto& instance) { return std::string(instance.param + 1); });

TEST(PointStream, AFileThatEndsEarlyIsAnError) {
  const std::string path = ::testing::TempDir() + "short.ply";
  write_points(path, some_points(true));
  const std::string bytes = read_file(path);
  write_file(path, bytes.substr(0, bytes.size() - 100));
  EXPECT_THROW(PointStream{path}, IoError);
  std::filesystem::remove(path);
  EXPECT_THROW(PointStream{path}, IoError);
}

// Vertices of a mesh are points too; other properties follow.
TEST(PointStream, VerticesOfAMeshWithPropertiesArePoints) {
  const std::string path = ::testing::TempDir() + "mesh.ply";
  std::string bytes =
      "ply\nformat binary_little_endian 1.0\ncomment made by hand\nelement vertex 2\nproperty uchar red\n"
      "property float x\nproperty float y\nproperty float z\nelement face 0\n"
      "property list uchar int vertex_indices\nend_header\n";
  bytes.append("\x07\0\0\x80\x3f\0\0\0\x40\0\0\0\0", 13);
  bytes.append("\x09\0\0\0\0\0\0\x80\x3f\0\0\0\x40", 13);
  write_file(path, bytes);
  PointStream stream(path);
  const PointCloud last = stream.read(1, 2);
  EXPECT_EQ(last.points.col(0), Point<3>(0, 1, 2));
  ASSERT_EQ(last.properties.size(), 1);
  EXPECT_EQ(last.properties[0].values[0], 9);
  std::filesystem::remove(path);
}

}  // namespace
}  // namespace csrbf::point_stream_test
