#include "csrbf/io/vtk/vtk.hpp"

#include "csrbf/io/files/bytes.hpp"
#include "csrbf/io/files/deflate.hpp"
#include "csrbf/io/mesh.hpp"
#include "csrbf/io/points.hpp"
#include "csrbf/io/polylines.hpp"
#include "csrbf/io/volume.hpp"
#include "csrbf/io/vtk/formats.hpp"

#include "io/io_testing.hpp"

#include <Eigen/Geometry>

namespace csrbf::vtk_test {
namespace {

using testing::content;
using testing::io_error;
using testing::TemporaryFolder;

Mesh two_triangles() {
  Mesh mesh;
  mesh.vertices.resize(3, 4);
  mesh.vertices << 0, 1, 1, 0, 0, 0, 1, 1, 0, 0, 0, 0.5;
  mesh.triangles.resize(3, 2);
  mesh.triangles << 0, 0, 1, 2, 2, 3;
  return mesh;
}

std::string base64(std::string_view bytes) {
  constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const auto byte = [&](std::size_t k) { return k < bytes.size() ? static_cast<unsigned char>(bytes[k]) : 0u; };
    const unsigned bits = byte(i) << 16 | byte(i + 1) << 8 | byte(i + 2);
    for (unsigned k = 0; k < 4; ++k) text += k <= bytes.size() - i ? digits[bits >> (18 - 6 * k) & 63] : '=';
  }
  return text;
}

template <class T>
std::string packed(std::initializer_list<double> values) {
  std::string bytes;
  for (const double value : values) append_scalar(bytes, static_cast<T>(value));
  return bytes;
}

// An image of 3 x 2 points with one array, of which `array` says the format and holds the data.
std::string image_text(const std::string& file, const std::string& array, const std::string& appended = "") {
  return "<?xml version=\"1.0\"?>\n<!-- by hand -->\n<VTKFile type=\"ImageData\" " + file +
         ">\n<ImageData WholeExtent=\"0 2 0 1 0 0\" Origin=\"1 2 3\" Spacing='2 1 1'>\n<Piece Extent=\"0 2 0 1 0 0\">\n"
         "<PointData>\n<DataArray Name=\"a\" " +
         array + "</DataArray>\n</PointData>\n</Piece>\n</ImageData>\n" + appended + "</VTKFile>\n";
}

const std::vector<double> six{0, 1, 2, 3, 4, 5};

TEST(VtkFiles, AreReadInEveryEncoding) {
  const TemporaryFolder folder;
  const std::string plain = packed<float>({0, 1, 2, 3, 4, 5}), size = packed<std::uint32_t>({24});
  const std::string wide_size = packed<std::uint64_t>({24});
  // Blocks of 16 bytes, the last of 8.
  const std::string_view bytes = plain;
  const std::string first = deflate_bytes({bytes.substr(0, 16)}, DeflateFormat::zlib);
  const std::string last = deflate_bytes({bytes.substr(16)}, DeflateFormat::zlib);
  const auto length = [](const std::string& block) { return static_cast<double>(block.size()); };
  const std::string header = packed<std::uint32_t>({2, 16, 8, length(first), length(last)});
  const std::string big("\0\0\0\x18\0\0\0\0\x3f\x80\0\0\x40\0\0\0\x40\x40\0\0\x40\x80\0\0\x40\xa0\0\0", 28);
  const std::string here = "type=\"Float32\" format=\"binary\">\n  ",
                    there = "type=\"Float32\" format=\"appended\" offset=\"3\">";
  const std::string zlib = "compressor=\"vtkZLibDataCompressor\" byte_order=\"LittleEndian\"";
  const auto appended = [](const std::string& encoding, const std::string& data) {
    return "<AppendedData encoding=\"" + encoding + "\">\n _xyz" + data + "\n</AppendedData>\n";
  };
  const std::vector<std::pair<std::string, std::string>> files{
      {"text", image_text("", "type=\"Float32\" format=\"ascii\">\n 0 1 2\n3 4\t5\n")},
      {"base64", image_text("", here + base64(size + plain) + "\n")},
      {"64-bit sizes", image_text("header_type=\"UInt64\"", here + base64(wide_size + plain))},
      {"compressed", image_text(zlib, here + base64(header) + base64(first + last))},
      {"raw", image_text("", there, appended("raw", size + plain))},
      {"raw, compressed", image_text(zlib, there, appended("raw", header + first + last))},
      {"appended base64", image_text("", there, appended("base64", base64(size + plain)))},
      {"big-endian", image_text("byte_order=\"BigEndian\"", there, appended("raw", big))}};
  for (const auto& file : files) {
    SCOPED_TRACE(file.first);
    Volume<double> read;
    ASSERT_EQ(io_error([&] { read = read_volume<double>(folder.with("a.vti", file.second)); }), "no exception");
    EXPECT_EQ(read.values, six);
    EXPECT_EQ(read.type, SampleType::float32);
    EXPECT_EQ(read.grid.size, (std::array<Index, 3>{3, 2, 1}));
    EXPECT_EQ(read.grid.origin, Point<3>(1, 2, 3));
    EXPECT_EQ(read.grid.spacing, Point<3>(2, 1, 1));
  }
}

TEST(VtkFiles, SayWhatIsWrong) {
  const TemporaryFolder folder;
  const auto error = [&](const std::string& text) {
    const std::string path = folder.with("a.vti", text);
    const std::string message = io_error([&] { read_volume(path); });
    return message.starts_with(path) ? message.substr(path.size() + 2) : message;
  };
  const std::string ascii = "type=\"Float32\" format=\"ascii\">";
  EXPECT_EQ(error("nothing"), "not an XML file");
  EXPECT_EQ(error("<html></html>"), "not a VTK file: its XML begins with \"html\"");
  EXPECT_EQ(error("<VTKFile type=\"PolyData\"></VTKFile>"), "the file holds \"PolyData\", expected \"ImageData\"");
  EXPECT_EQ(error("<VTKFile type=\"ImageData\"><ImageData>"), "the file ends within the element \"ImageData\"");
  EXPECT_EQ(error("<VTKFile type=\"ImageData\"><ImageData></VTKFile>"),
            "element \"ImageData\" is closed as \"VTKFile\"");
  EXPECT_EQ(error("<VTKFile type=ImageData>"), "tag \"VTKFile\": the value of \"type\" is not in quotes");
  EXPECT_EQ(error(image_text("compressor=\"vtkLZ4DataCompressor\"", ascii)),
            "compressor \"vtkLZ4DataCompressor\" is not supported; write the data with zlib or without compression");
  EXPECT_EQ(error(image_text("", ascii + "0 1 2 3 4")), "array \"a\" is truncated");
  EXPECT_EQ(error(image_text("", ascii + "0 1 2 3 4 five")), "array \"a\": \"five\" is not a number");
  EXPECT_EQ(error(image_text("", "type=\"String\">0")), "array \"a\" has a type other than UInt8 to Float64");
  const std::string binary = "type=\"Float32\" format=\"binary\">";
  EXPECT_EQ(error(image_text("", binary + "AAAA")), "array \"a\": the data are truncated");
  EXPECT_EQ(error(image_text("", binary + base64(packed<std::uint32_t>({25}) + std::string(25, 'x')))),
            "array \"a\": the data have 25 bytes, 24 are expected");
  EXPECT_EQ(error(image_text("", "type=\"Float32\" format=\"appended\" offset=\"9\">")),
            "array \"a\" begins beyond the end of the file");
  const std::string zlib = "compressor=\"vtkZLibDataCompressor\"";
  EXPECT_EQ(error(image_text(zlib, binary + base64(packed<std::uint32_t>({4e9, 16, 8, 1, 1})))),
            "array \"a\": the data are truncated");
  std::string deep;
  for (int i = 0; i < 100000; ++i) deep += "<a>";
  EXPECT_EQ(error(deep), "more than 32 levels of XML elements");
  std::string part = image_text("", ascii + "0 1 2 3 4 5");
  part.replace(part.find("Piece Extent=\"0 2"), 17, "Piece Extent=\"0 1");
  EXPECT_EQ(error(part), "the piece holds a part of the image only");
  std::string huge = image_text("", ascii + "0 1 2 3 4 5");
  while (huge.find("0 2 0 1 0 0") != std::string::npos)
    huge.replace(huge.find("0 2 0 1 0 0"), 11, "0 1073741823 0 1073741823 0 1073741823");
  EXPECT_EQ(error(huge), "the header promises more than 2^40 samples");
}

TEST(VtkFiles, SurviveEveryTruncationOfTheirBytes) {
  const TemporaryFolder folder;
  write_mesh(folder.file("a.vtp"), two_triangles());
  const std::string bytes = content(folder.file("a.vtp"));
  const std::string end = "\n</AppendedData>\n</VTKFile>\n";
  for (std::size_t size = 0; size + end.size() < bytes.size(); ++size)
    EXPECT_NE(io_error([&] { read_mesh(folder.with("cut.vtp", bytes.substr(0, size))); }), "no exception") << size;
}

TEST(VtkFiles, KeepDirectionsOfImages) {
  const TemporaryFolder folder;
  Volume<double> volume;
  volume.grid.size = {4, 3, 2};
  volume.grid.spacing = {0.5, 2, 3};
  volume.grid.origin = {-10.5, 20, 5};
  volume.grid.direction = Eigen::AngleAxisd(2.5, Point<3>(1, 2, 3).normalized()).toRotationMatrix();
  volume.grid.space = Space::right_anterior_superior;
  volume.type = SampleType::int16;
  volume.values.assign(24, 7);
  write_volume(folder.file("a.vti"), volume);
  const Grid read = read_volume<double>(folder.file("a.vti")).grid;
  EXPECT_TRUE(read.direction.isApprox(volume.grid.direction, 1e-14));
  EXPECT_TRUE(read.spacing.isApprox(volume.grid.spacing, 1e-14));
  EXPECT_EQ(read.origin, volume.grid.origin);  // the numbers of the file, whatever their space
  EXPECT_EQ(read.space, Space::unknown);
}

TEST(VtkFiles, KeepComponentsAndRefuseSequences) {
  const TemporaryFolder folder;
  VolumeLayout layout;
  layout.grid.size = {3, 2, 1};
  layout.grid.axes = 2;
  layout.components = 3;
  layout.type = SampleType::uint8;
  Volume<double> colors(layout);
  for (std::size_t i = 0; i < colors.values.size(); ++i) colors.values[i] = static_cast<double>(i);
  write_volume(folder.file("a.vti"), colors);
  const auto read = read_volume<double>(folder.file("a.vti"));
  EXPECT_EQ(read.values, colors.values);
  EXPECT_EQ(read.components, 3);
  EXPECT_EQ(read.grid.axes, 2);
  layout.frames = 2;
  EXPECT_EQ(io_error([&] { write_volume(folder.file("b.vti"), Volume<double>(layout)); }),
            folder.file("b.vti") + ": .vti files hold no time axis; write .nii.gz, .nrrd or .npy");
}

TEST(VtkFiles, TakeTheActiveArrayAndCellsAsVoxels) {
  const TemporaryFolder folder;
  Grid grid;
  grid.size = {2, 1, 1};
  write_vti(folder.file("a.vti"), grid,
            {{"depth", SampleType::float64, 1, packed<double>({4, 5})},
             {"depth_gradient", SampleType::float64, 3, packed<double>({1, 2, 3, 4, 5, 6})}});
  std::string text = content(folder.file("a.vti"));
  EXPECT_EQ(read_volume<double>(folder.file("a.vti")).values, (std::vector<double>{4, 5}));
  text.replace(text.find("Scalars=\"depth\""), 15, "Scalars=\"depth_gradient\"");
  EXPECT_EQ(read_volume<double>(folder.with("b.vti", text)).components, 3);
  EXPECT_EQ(io_error([&] { write_vti(folder.file("a.vtk"), grid, {}); }),
            folder.file("a.vtk") + ": unknown extension \".vtk\"; several arrays go to .vti");
  EXPECT_THROW(write_vti(folder.file("a.vti"), grid, {{"short", SampleType::uint8, 1, "x"}}), InvalidInput);

  const Grid cells =
      read_volume<double>(
          folder.with(
              "c.vti",
              "<VTKFile type=\"ImageData\"><ImageData WholeExtent=\"4 6 0 1 0 0\" Spacing=\"2 1 1\"><Piece>\n<CellData>"
              "<DataArray type=\"UInt8\" Name=\"a\" format=\"ascii\">8 "
              "9</DataArray></CellData></Piece></ImageData></VTKFile>"))
          .grid;
  EXPECT_EQ(cells.size, (std::array<Index, 3>{2, 1, 1}));
  EXPECT_EQ(cells.origin, Point<3>(9, 0.5, 0));
}

TEST(VtkFiles, KeepVectorsAndTypesOfVertices) {
  const TemporaryFolder folder;
  Mesh mesh = two_triangles();
  const Eigen::Vector4d values(1, 2, 3, 4);
  mesh.properties = {{"k1", "float", values},      {"d1x", "float", values},  {"d1y", "float", -values},
                     {"d1z", "float", 2 * values}, {"kind", "char", -values}, {"mass", "double", values / 3}};
  for (const char* name : {"red", "green", "blue"}) mesh.properties.push_back({name, "uchar", 50 * values});
  write_mesh(folder.file("a.vtp"), mesh);
  const std::string text = content(folder.file("a.vtp"));
  EXPECT_NE(text.find("Name=\"d1\" NumberOfComponents=\"3\""), std::string::npos);
  EXPECT_NE(text.find("type=\"UInt8\" Name=\"RGB\" NumberOfComponents=\"3\""), std::string::npos);
  const Mesh read = read_mesh(folder.file("a.vtp"));
  ASSERT_EQ(read.properties.size(), mesh.properties.size());
  for (const Property& expected : mesh.properties) {
    const auto found = std::find_if(read.properties.begin(), read.properties.end(),
                                    [&](const Property& p) { return p.name == expected.name; });
    ASSERT_NE(found, read.properties.end()) << expected.name;
    EXPECT_EQ(found->type, expected.type) << expected.name;
    EXPECT_EQ(found->values, expected.values) << expected.name;
  }
}

TEST(VtkFiles, ReadPolygonsAndStripsAsTriangles) {
  const TemporaryFolder folder;
  const auto array = [](const std::string& name, const std::string& type, const std::string& numbers) {
    return "<DataArray Name=\"" + name + "\" type=\"" + type + "\" format=\"ascii\"" +
           (name == "p" ? " NumberOfComponents=\"3\">" : ">") + numbers + "</DataArray>";
  };
  const std::string points = "<Points>" + array("p", "Float32", "0 0 0 1 0 0 1 1 0 0 1 0") + "</Points>";
  const auto file = [&](const std::string& kind, const std::string& corners) {
    return "<VTKFile type=\"PolyData\"><PolyData><Piece NumberOfPoints=\"4\" NumberOf" + kind + "=\"1\">" + points +
           "<" + kind + ">" + array("connectivity", "Int32", corners) + array("offsets", "Int32", "4") + "</" + kind +
           "></Piece></PolyData></VTKFile>";
  };
  Triangles fan(3, 2), strip(3, 2);
  fan << 0, 0, 1, 2, 2, 3;
  strip << 0, 3, 1, 1, 3, 2;
  EXPECT_EQ(read_mesh(folder.with("a.vtp", file("Polys", "0 1 2 3"))).triangles, fan);
  EXPECT_EQ(read_mesh(folder.with("a.vtp", file("Strips", "0 1 3 2"))).triangles, strip);
  const std::string path = folder.with("b.vtp", file("Polys", "0 1 2 4"));
  EXPECT_EQ(io_error([&] { read_mesh(path); }), path + ": Polys refer to vertices that are not among the 4 points");
}

TEST(VtkFiles, ListPointsAsVerticesAndCurvesAsLines) {
  const TemporaryFolder folder;
  PointCloud cloud;
  cloud.points = two_triangles().vertices;
  cloud.normals = cloud.points;
  write_points(folder.file("a.vtp"), cloud);
  EXPECT_NE(content(folder.file("a.vtp")).find("NumberOfVerts=\"4\""), std::string::npos);
  const PointCloud read = read_points(folder.file("a.vtp"));
  EXPECT_EQ(read.points, cloud.points);
  EXPECT_EQ(read.normals, cloud.normals);
  Polylines lines;
  lines.vertices = cloud.points;
  lines.edges.resize(2, 3);
  lines.edges << 0, 1, 2, 1, 2, 3;
  write_polylines(folder.file("l.vtp"), lines);
  const std::string text = content(folder.file("l.vtp"));
  EXPECT_NE(text.find("NumberOfLines=\"3\""), std::string::npos);
  const VtkReader reader(text, "PolyData", "l.vtp");
  EXPECT_EQ(reader.values(reader.piece().child("Lines")->children[0], 6).reshaped(2, 3), lines.edges.cast<double>());
}

}  // namespace
}  // namespace csrbf::vtk_test
