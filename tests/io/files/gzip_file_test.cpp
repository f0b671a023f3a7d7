#include "csrbf/io/files/gzip_file.hpp"

#include "csrbf/io/files/deflate.hpp"
#include "csrbf/io/mesh.hpp"
#include "csrbf/io/points.hpp"
#include "csrbf/io/samples.hpp"

#include "io/io_testing.hpp"

namespace csrbf::gzip_file_test {
namespace {

using testing::content;
using testing::io_error;
using testing::TemporaryFolder;

std::string gzip(const std::string& text) {
  return deflate_bytes({text}, DeflateFormat::gzip);
}

TEST(GzipFile, HoldsWhatItsNameSaysBefore) {
  EXPECT_EQ(content_extension("a/soundings.CSV.gz"), ".csv");
  EXPECT_EQ(content_extension("a.ply"), ".ply");
  EXPECT_EQ(content_extension("a.gz"), "");
}

TEST(GzipFile, IsReadWhateverItsSizeAndName) {
  const TemporaryFolder folder;
  std::string large;
  for (int i = 0; i < 200000; ++i) large += i % 1000 == 0 ? std::to_string(i) : "0 ";
  for (const std::string& text : {std::string(), std::string("x\n"), std::string(100000, 'a'), large}) {
    EXPECT_EQ(read_content(folder.with("a.txt.gz", gzip(text))), text);
    EXPECT_EQ(read_content(folder.with("a.txt", gzip(text))), text);
    EXPECT_EQ(read_content(folder.with("two.gz", gzip(text) + gzip(text))), text + text);
    EXPECT_EQ(read_content(folder.with("plain", text)), text);
  }
}

TEST(GzipFile, ThatIsDamagedIsRefused) {
  const TemporaryFolder folder;
  const std::string bytes = gzip(std::string(1000, 'a') + "b");
  for (std::size_t size = 2; size < bytes.size(); ++size) {
    const std::string path = folder.with("a.csv.gz", bytes.substr(0, size));
    EXPECT_NE(io_error([&] { read_content(path); }).find("a.csv.gz: the file is truncated"), std::string::npos) << size;
  }
  std::string other = bytes;
  other[other.size() - 6] ^= 1;  // in the checksum
  const std::string path = folder.with("a.csv.gz", other);
  EXPECT_NE(io_error([&] { read_content(path); }).find("damaged"), std::string::npos);
}

TEST(GzipFile, OfPointsSamplesAndMeshesIsWrittenAndRead) {
  const TemporaryFolder folder;
  PointCloud cloud;
  cloud.points = Points<3>::Random(3, 50);
  for (const char* name : {"a.csv.gz", "a.xyz.gz", "a.npy.gz"}) {
    write_points(folder.file(name), cloud);
    EXPECT_EQ(content(folder.file(name)).substr(0, 2), "\x1F\x8B") << name;
    EXPECT_EQ(read_points(folder.file(name)).points, cloud.points) << name;
  }
  EXPECT_TRUE(is_point_file("a.ply.gz"));
  Mesh mesh;
  mesh.vertices = Points<3>::Identity(3, 3);
  mesh.triangles = Eigen::Vector3i(0, 1, 2);
  write_mesh(folder.file("a.ply.gz"), mesh);
  EXPECT_EQ(read_mesh(folder.file("a.ply.gz")).vertices, mesh.vertices);
  EXPECT_NE(io_error([&] { read_points(folder.with("a.laz", "LASF")); }).find("truncated"), std::string::npos);
}

}  // namespace
}  // namespace csrbf::gzip_file_test
