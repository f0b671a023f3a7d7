#include "csrbf/io/mesh.hpp"

#include "csrbf/io/files/bytes.hpp"
#include "csrbf/io/image.hpp"
#include "csrbf/io/points.hpp"
#include "csrbf/io/polylines.hpp"

#include "core/error_testing.hpp"
#include "io/io_testing.hpp"

namespace csrbf::mesh_file_test {
namespace {

using testing::content;
using testing::io_error;
using testing::TemporaryFolder;

// A tetrahedron; coordinates are exact in single precision.
Mesh tetrahedron() {
  Mesh mesh;
  mesh.vertices.resize(3, 4);
  mesh.vertices << 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1;
  mesh.triangles.resize(3, 4);
  mesh.triangles << 0, 0, 0, 1, 2, 1, 3, 2, 1, 3, 2, 3;
  return mesh;
}

std::string without_folder(const std::string& message, const std::string& path, const std::string& name) {
  return message.starts_with(path) ? name + message.substr(path.size()) : message;
}

TEST(MeshFiles, WriteWhatTheyRead) {
  const TemporaryFolder folder;
  Mesh mesh = tetrahedron();
  mesh.normals = mesh.vertices;
  for (const char* name : {"red", "green", "blue"})
    mesh.properties.push_back({name, "uchar", Eigen::Vector4d(0, 1, 128, 255)});
  for (const std::string name : {"a.ply", "a.obj", "a.off", "a.vtp", "A.OBJ"}) {
    write_mesh(folder.file(name), mesh);
    const Mesh read = read_mesh(folder.file(name));
    EXPECT_EQ(read.vertices, mesh.vertices) << name;
    EXPECT_EQ(read.triangles, mesh.triangles) << name;
    EXPECT_EQ(read.normals, mesh.normals) << name;
    ASSERT_EQ(read.properties.size(), 3u) << name;
    EXPECT_EQ(read.properties[1].values, mesh.properties[1].values) << name;
  }
}

// 3D Slicer takes meshes for LPS that do not say where they are.
TEST(MeshFiles, SayInWhichPatientSpaceTheyAre) {
  const TemporaryFolder folder;
  Mesh mesh = tetrahedron();
  for (const std::string name : {"a.ply", "a.obj", "a.stl", "a.vtp"}) {
    mesh.space = Space::unknown;
    write_mesh(folder.file(name), mesh);
    EXPECT_EQ(content(folder.file(name)).find("SPACE"), std::string::npos) << name;
    EXPECT_EQ(read_mesh(folder.file(name)).space, Space::unknown) << name;
    mesh.space = Space::right_anterior_superior;
    write_mesh(folder.file(name), mesh);
    const std::string bytes = content(folder.file(name));
    EXPECT_NE(bytes.find(name == "a.vtp" ? ">82 65 83 0<" : "SPACE=RAS"), std::string::npos) << name;
    const Mesh read = read_mesh(folder.file(name));
    EXPECT_EQ(read.vertices.cols(), mesh.vertices.cols()) << name;
    EXPECT_EQ(read.triangles.cols(), mesh.triangles.cols()) << name;
    EXPECT_EQ(read.space, Space::right_anterior_superior) << name;
  }
  mesh.space = Space::left_posterior_superior;
  write_mesh(folder.file("a.ply"), mesh);
  EXPECT_EQ(read_mesh(folder.file("a.ply")).space, Space::left_posterior_superior);
  EXPECT_NE(content(folder.file("a.ply")).find("\ncomment SPACE=LPS\n"), std::string::npos);
  std::string other = content(folder.file("a.ply"));
  other.replace(other.find("SPACE=LPS"), 9, "SPACE=LPSX");
  EXPECT_EQ(parse_mesh_or_points(".ply", other, "other").space, Space::unknown);
}

TEST(MeshFiles, KeepTheSurfaceThroughStl) {
  const TemporaryFolder folder;
  write_mesh(folder.file("a.stl"), tetrahedron());
  const Mesh read = read_mesh(folder.file("a.stl"));
  ASSERT_EQ(read.vertices.cols(), 4);
  const Mesh original = tetrahedron();
  for (Index t = 0; t < 4; ++t)
    for (int corner = 0; corner < 3; ++corner)
      EXPECT_EQ(read.vertices.col(read.triangles(corner, t)), original.vertices.col(original.triangles(corner, t)));
  EXPECT_EQ(std::filesystem::file_size(folder.file("a.stl")), 84u + 4u * 50u);
}

TEST(MeshFiles, KeepCoordinatesFarFromTheOriginOrWarn) {
  const TemporaryFolder folder;
  Mesh mesh = tetrahedron();
  for (const std::string name : {"a.ply", "a.obj", "a.off", "a.stl", "a.vtp"})
    EXPECT_TRUE(write_mesh(folder.file(name), mesh).empty()) << name;
  mesh.vertices = (mesh.vertices.array() / 3).matrix().colwise() + Point<3>(500000, 5300000, 300);
  for (const std::string name : {"a.ply", "a.obj", "a.off", "a.vtp"}) {
    EXPECT_TRUE(write_mesh(folder.file(name), mesh).empty()) << name;
    EXPECT_EQ(read_mesh(folder.file(name)).vertices, mesh.vertices) << name;
  }
  const std::string path = folder.file("a.stl");
  const std::vector<std::string> warnings = write_mesh(path, mesh);
  ASSERT_EQ(warnings.size(), 1u);
  // A third is a sixth from the next multiple of a half, which is what floats above 2^22 are.
  EXPECT_EQ(without_folder(warnings[0], path, "a.stl"),
            "a.stl: .stl holds single precision, which moves coordinates by up to 0.17 here; write .ply, .obj or .off, "
            "or bring the data nearer to the origin");
}

TEST(MeshFiles, ReadTextStl) {
  const TemporaryFolder folder;
  const std::string text =
      "solid two triangles\nfacet normal 0 0 1\n outer loop\n  vertex 0 0 0\n  vertex 1 0 0\n  vertex 0 1 0\n endloop\n"
      "endfacet\nfacet normal 0 0 1\n outer loop\n  vertex 1 0 0\n  vertex 1e0 1 -0\n  vertex 0 1 0\n "
      "endloop\nendfacet\n"
      "endsolid two triangles\n";
  const Mesh mesh = read_mesh(folder.with("t.stl", text));
  EXPECT_EQ(mesh.vertices.cols(), 4);
  Triangles expected(3, 2);
  expected << 0, 1, 1, 3, 2, 2;
  EXPECT_EQ(mesh.triangles, expected);
}

TEST(MeshFiles, ReadStlOfOtherPrograms) {
  const TemporaryFolder folder;
  const std::string loud =
      "SOLID A\nFACET NORMAL 0 0 1\nOUTER LOOP\nVERTEX 0 0 0\nVERTEX 1E0 0 0\nVERTEX 0 1 "
      "0\nENDLOOP\nENDFACET\nENDSOLID A\n";
  EXPECT_EQ(read_mesh(folder.with("loud.stl", loud)).triangles.cols(), 1);
  write_mesh(folder.file("t.stl"), tetrahedron());
  std::string binary = content(folder.file("t.stl"));
  binary.replace(0, 10, "solid cube");
  EXPECT_EQ(read_mesh(folder.with("longer.stl", binary + std::string(2, '\0'))).triangles.cols(), 4);
  const std::string path = folder.with("cut.stl", binary.substr(0, 84 + 150));
  EXPECT_EQ(without_folder(io_error([&] { read_mesh(path); }), path, "cut.stl"),
            "cut.stl: the header promises 4 triangles, the file has room for 3");
}

TEST(MeshFiles, ReadTheFacesOfObjInAllTheirForms) {
  const TemporaryFolder folder;
  const std::string vertices = "v 0 0 0\nv 1 0 0\nv 1 1 0 1.0\nv 0 1 0\nvt 0 0\nvn 0 0 1\n";
  Triangles expected(3, 2);
  expected << 0, 0, 1, 2, 2, 3;
  for (const std::string face : {"f 1 2 3 4", "f 1/1 2/1 3/1 4/1", "f 1//1 2//1 3//1 4//1", "f 1/1/1 2/1/1 3/1/1 4/1/1",
                                 "f -4 -3 -2 -1", "f 1 2 3\nf 1 3 4"}) {
    const Mesh mesh = read_mesh(folder.with("a.obj", vertices + face + "\n"));
    EXPECT_EQ(mesh.triangles, expected) << face;
    EXPECT_EQ(mesh.normals.cols(), 0) << face;
  }
}

TEST(MeshFiles, DropNormalsThatBelongToOtherCorners) {
  const TemporaryFolder folder;
  const std::string text = "v 0 0 0\nv 1 0 0\nv 1 1 0\nvn 0 0 1\nvn 0 1 0\nvn 1 0 0\nf 1//2 2//3 3//1\n";
  EXPECT_EQ(read_mesh(folder.with("a.obj", text)).normals.cols(), 0);
}

TEST(MeshFiles, SayWhatIsWrong) {
  const TemporaryFolder folder;
  const auto error = [&](const std::string& name, const std::string& text) {
    const std::string path = folder.with(name, text);
    return without_folder(io_error([&] { read_mesh(path); }), path, name);
  };
  EXPECT_EQ(error("p.obj", "v 1 2 3\n"), "p.obj: the file holds 1 points but no faces");
  EXPECT_EQ(error("f.obj", "v 1 2 3\nf 1 2 3\n"), "f.obj:2: face 1: vertex index 2 is not one of the 1 before it");
  EXPECT_EQ(error("f.obj", "v 1 2 3\nf 1 1\n"), "f.obj:2: face 1 has 2 corners");
  EXPECT_EQ(error("f.obj", "v 1 2 3\nf 0 1 1\n"), "f.obj:2: face 1: \"0\" is not a vertex index");
  EXPECT_EQ(error("f.obj", "v 1 2 3\nf 1/a/b 1 1\n"), "f.obj:2: face 1: \"1/a/b\" is not a vertex index");
  EXPECT_EQ(error("f.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n"),
            "f.off:6: face 0: vertex index 3 is not one of the 3 vertices");
  EXPECT_EQ(error("f.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1\n"), "f.off:6: face 0: \"\" is not a vertex index");
  EXPECT_EQ(error("f.off", "OFF\n3 2 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"), "f.off:6: the file ends after 1 of 2 faces");
  EXPECT_EQ(error("f.stl", ""), "f.stl: the file is empty");
  EXPECT_EQ(error("f.stl", "garbage"), "f.stl: not an STL file");
  EXPECT_EQ(error("f.stl", "solid\nfacet\nvertex 1 2\n"), "f.stl:3: expected 3 coordinates, found 2");
  EXPECT_EQ(error("f.stl", "solid\nfacet\nvertex 1 2 3\nendfacet\nendsolid"),
            "f.stl:4: expected 3 vertices in the facet, found 1");
  EXPECT_EQ(error("f.stl", "solid\nfacet\nvertex 1 2 3\nvertex 1 2 4\nvertex 1 2 5\n"),
            "f.stl:5: the file ends before endsolid");
  std::string binary(80, ' ');
  append_scalar(binary, std::uint32_t{4000000000u});
  EXPECT_EQ(error("f.stl", binary + std::string(70, '\0')),
            "f.stl: the header promises 4000000000 triangles, the file has room for 1");
}

TEST(MeshFiles, RefuseToWriteIndicesWithoutVertices) {
  const TemporaryFolder folder;
  Mesh mesh = tetrahedron();
  mesh.triangles(0, 0) = 4;
  EXPECT_THROW(write_mesh(folder.file("a.ply"), mesh), InvalidInput);
  EXPECT_EQ(io_error([&] { write_mesh("a.vtk", mesh); }),
            "a.vtk: unknown extension \".vtk\"; mesh files are .ply .obj .off .stl .vtp .glb .3mf");
  EXPECT_EQ(folder.files(), 0);
}

TEST(WritePng, WritesSizeAndPixelFormat) {
  const TemporaryFolder folder;
  RgbImage image(3, 2);
  image.pixels[0] = 255;
  write_png(folder.file("a.png"), image);
  const std::string png = content(folder.file("a.png"));
  EXPECT_EQ(png.substr(0, 8), "\x89PNG\r\n\x1a\n");
  EXPECT_EQ(png.substr(12, 4), "IHDR");
  EXPECT_EQ(load_scalar<std::uint32_t>(png.data() + 16, std::endian::big), 3u);
  EXPECT_EQ(load_scalar<std::uint32_t>(png.data() + 20, std::endian::big), 2u);
  EXPECT_EQ(png[24], 8);  // bits per channel
  EXPECT_EQ(png[25], 2);  // RGB
}

TEST(MeshFiles, RefuseToWritePropertiesOfAnotherSize) {
  const TemporaryFolder folder;
  Mesh mesh = tetrahedron();
  for (const char* name : {"red", "green", "blue"})
    mesh.properties.push_back({name, "uchar", Eigen::Vector3d(1, 2, 3)});
  for (const std::string name : {"a.ply", "a.obj", "a.off", "a.stl", "a.vtp", "a.glb", "a.3mf"})
    EXPECT_EQ(invalid_input_message([&] { write_mesh(folder.file(name), mesh); }),
              "write_mesh: size of property red = 3: must be 4, one value per point")
        << name;
  const PointCloud cloud{mesh.vertices, {}, mesh.properties};
  EXPECT_THROW(write_points(folder.file("a.xyz"), cloud), InvalidInput);
  Polylines lines;
  lines.properties = mesh.properties;
  EXPECT_THROW(write_polylines(folder.file("a.vtp"), lines), InvalidInput);
  EXPECT_EQ(folder.files(), 0);
}

TEST(WritePng, RefusesOtherFormatsAndWrongSizes) {
  const TemporaryFolder folder;
  EXPECT_EQ(io_error([&] { write_png("a.jpg", RgbImage(1, 1)); }),
            "a.jpg: unknown extension \".jpg\"; pictures are .png");
  EXPECT_THROW(write_png(folder.file("a.png"), RgbImage(0, 1)), InvalidInput);
  RgbImage image(2, 2);
  image.pixels.pop_back();
  EXPECT_THROW(write_png(folder.file("a.png"), image), InvalidInput);
}

}  // namespace
}  // namespace csrbf::mesh_file_test
