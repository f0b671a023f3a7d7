#include "csrbf/io/files/guessed_format.hpp"

#include "csrbf/io/files/process_files.hpp"
#include "csrbf/io/mesh.hpp"
#include "csrbf/io/points.hpp"
#include "csrbf/io/samples.hpp"
#include "csrbf/io/volume.hpp"

#include "io/io_testing.hpp"

namespace csrbf::guessed_format_test {
namespace {

using testing::content;
using testing::io_error;
using testing::TemporaryFolder;

TEST(GuessedFormat, KnowsFilesByTheirFirstBytes) {
  EXPECT_EQ(guessed_format("ply\nformat ascii 1.0\n"), ".ply");
  EXPECT_EQ(guessed_format("OFF\n3 1 0\n"), ".off");
  EXPECT_EQ(guessed_format("# .PCD v0.7\n"), ".pcd");
  EXPECT_EQ(guessed_format(std::string("II*\0", 4)), ".tif");
  EXPECT_EQ(guessed_format("<?xml version=\"1.0\"?>\n<VTKFile type=\"ImageData\">"), ".vti");
  EXPECT_EQ(guessed_format("<VTKFile type=\"PolyData\">"), ".vtp");
  EXPECT_EQ(guessed_format("x,y,depth\n1,2,3\n"), "");
  EXPECT_EQ(guessed_format("P5 is a column\n"), "");
  EXPECT_EQ(guessed_format("BMI,age\n22,40\n"), "");
  EXPECT_EQ(guessed_format(""), "");
}

TEST(GuessedFormat, TellsCompressedPointsFromPlainOnes) {
  std::string las(227, '\0');
  las.replace(0, 4, "LASF");
  EXPECT_EQ(guessed_format(las), ".las");
  las[104] = static_cast<char>(0x83);
  EXPECT_EQ(guessed_format(las), ".laz");
}

TEST(GuessedFormat, FilesWithoutAnExtensionAreReadByTheirContent) {
  const TemporaryFolder folder;
  PointCloud cloud;
  cloud.points = Points<3>::Random(3, 7);
  Mesh mesh;
  mesh.vertices = cloud.points;
  mesh.triangles = Triangles::Zero(3, 1);
  mesh.triangles.col(0) << 0, 1, 2;
  write_points(folder.file("a.ply"), cloud);
  write_mesh(folder.file("a.off"), mesh);
  Volume<float> image;
  image.grid.size = {4, 3, 2};
  image.values.assign(24, 1.5F);
  write_volume(folder.file("a.nii.gz"), image);
  EXPECT_EQ(read_points(folder.with("points", content(folder.file("a.ply")))).size(), 7);
  EXPECT_EQ(read_points(folder.with("text", "1 2 3\n4 5 6\n")).size(), 2);
  EXPECT_EQ(read_mesh(folder.with("mesh", content(folder.file("a.off")))).triangles.cols(), 1);
  EXPECT_EQ(read_volume<float>(folder.with("image", content(folder.file("a.nii.gz")))).values, image.values);
  EXPECT_EQ(read_samples(folder.with("samples", "x,y,v\n1,2,3\n")).value_names, std::vector<std::string>{"v"});
  EXPECT_EQ(io_error([&] { (void)read_points(folder.with("picture", "\x89PNG")); })
                .find(folder.file("picture") + ": its content looks like that of .png files; "
                                               "point files are .ply"),
            0U);
}

TEST(GuessedFormat, AnAssumedFormatOverridesTheName) {
  const TemporaryFolder folder;
  const std::string path = folder.with("cloud.dat",
                                       "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float "
                                       "y\nproperty float z\nend_header\n1 2 3\n");
  EXPECT_NE(io_error([&] { (void)read_points(path); }).find("unknown extension \".dat\""), std::string::npos);
  assume_format(path, ".ply");
  EXPECT_EQ(read_points(path).size(), 1);
}

}  // namespace
}  // namespace csrbf::guessed_format_test
