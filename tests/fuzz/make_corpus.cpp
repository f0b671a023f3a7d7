// Writes the small files from which the fuzzer starts: FOLDER/READER.EXTENSION/NAME. Most come from the writers of the
// library, the others are the forms that only others write.

#include "csrbf/io/mesh.hpp"
#include "csrbf/io/model.hpp"
#include "csrbf/io/points.hpp"
#include "csrbf/io/polylines.hpp"
#include "csrbf/io/samples.hpp"
#include "csrbf/io/volume.hpp"
#include "csrbf/levelset/segment.hpp"
#include "csrbf/surface/reconstruct.hpp"

#include <filesystem>
#include <fstream>
#include <iostream>

namespace csrbf {
namespace {

namespace fs = std::filesystem;

class Corpus {
 public:
  explicit Corpus(fs::path folder) : folder_(std::move(folder)) {}

  // The path of the seed `name` of a target. Its extension is that of the target: the writers go by it.
  [[nodiscard]] std::string path(const std::string& target, const std::string& name = "written") const {
    fs::create_directories(folder_ / target);
    return (folder_ / target / (name + target.substr(target.find('.')))).string();
  }
  void text(const std::string& target, const std::string& name, const std::string& content) const {
    std::ofstream(path(target, name), std::ios::binary) << content;
  }

 private:
  fs::path folder_;
};

Points<3> on_sphere(Index n) {
  Points<3> points(3, n);
  constexpr double golden_angle = 2.399963229728653;
  for (Index i = 0; i < n; ++i) {
    const double z = 1 - (2 * static_cast<double>(i) + 1) / static_cast<double>(n);
    const double angle = golden_angle * static_cast<double>(i), r = std::sqrt(1 - z * z);
    points.col(i) = Point<3>(r * std::cos(angle), r * std::sin(angle), z);
  }
  return points;
}

std::vector<Property> properties(Index n) {
  const auto ramp = [n](double hi) { return Eigen::VectorXd::LinSpaced(n, 0, hi).array().floor().matrix().eval(); };
  return {
      {"red", "uchar", ramp(255)}, {"green", "uchar", ramp(9)}, {"blue", "uchar", ramp(99)}, {"q", "float", ramp(3)}};
}

void write_geometry(const Corpus& corpus) {
  Mesh mesh;
  mesh.vertices = mesh.normals = on_sphere(4);
  mesh.triangles.resize(3, 4);
  mesh.triangles << 0, 0, 0, 1, 1, 2, 3, 2, 2, 3, 1, 3;
  mesh.properties = properties(4);
  const PointCloud cloud{mesh.vertices, mesh.normals, mesh.properties};
  for (const char* target : {"points.ply", "points.csv", "points.xyz", "points.pts", "points.txt", "points.obj",
                             "points.off", "points.npy", "points.vtp"})
    write_points(corpus.path(target), cloud);
  for (const char* target : {"mesh.ply", "mesh.obj", "mesh.off", "mesh.stl", "mesh.vtp"})
    write_mesh(corpus.path(target), mesh);
  corpus.text("points.pcd", "ascii",
              "VERSION 0.7\nFIELDS x y z rgb\nSIZE 4 4 4 4\nTYPE F F F U\nCOUNT 1 1 1 1\nWIDTH 2\nHEIGHT 1\nPOINTS 2\n"
              "DATA ascii\n1 2 3 9\n4 5 6 7\n");
  corpus.text("points.pcd", "compressed",
              std::string("FIELDS x y z\nSIZE 1 1 1\nTYPE U U U\nPOINTS 2\nDATA binary_compressed\n") +
                  std::string("\4\0\0\0\6\0\0\0\0\1\140\0", 12));
  std::string las(227 + 2 * 28, '\1');  // version 1.1 of format 1
  las.replace(0, 4, "LASF");
  las.replace(96, 15, std::string("\343\0\0\0\0\0\0\0\1\34\0\2\0\0\0", 15));
  corpus.text("points.las", "format1", las);

  corpus.text("points.ptx", "written",
              "2\n1\n1 2 3\n0 1 0\n-1 0 0\n0 0 1\n0 1 0 0\n-1 0 0 0\n0 0 1 0\n1 2 3 1\n1 2 3 .5 9 8 7\n0 0 0 .5 0 0 0\n"
              "0\n0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n");
  las[104] = static_cast<char>(0x81);
  corpus.text("points.laz", "format1", las);
  corpus.text("points.e57", "mark", "ASTM-E57");
  write_mesh(corpus.path("points.stl"), mesh);

  Polylines lines{mesh.vertices, {}, mesh.properties};
  lines.edges.resize(2, 3);
  lines.edges << 0, 1, 2, 1, 2, 0;
  write_polylines(corpus.path("polylines.ply"), lines);
  corpus.text("polylines.csv", "written",
              "x,y,z,contour,closed\n0,0,0,0,1\n1,0,0,0,1\n1,1,0,0,1\n0,0,1,1,0\n2,0,1,1,0\n");
  corpus.text("polylines.obj", "written", "v 0 0 0\nv 1 0 0\nv 1 1 0\nl 1 2 3 1\nl -1 -2\n");

  corpus.text("mesh.ply", "ascii",
              "ply\nformat ascii 1.0\ncomment c\nelement vertex 3\nproperty float x\nproperty float y\n"
              "property float z\nproperty list uchar short e\nelement face 1\nproperty list uchar int vertex_indices\n"
              "end_header\n0 0 0 1 7\n1 0 0 0\n0 1 0 2 1 2\n3 0 1 2\n");
  corpus.text("mesh.ply", "big",
              std::string("ply\nformat binary_big_endian 1.0\nelement vertex 1\nproperty double x\nproperty short y\n"
                          "property uchar z\nend_header\n") +
                  std::string(11, '\1'));
  corpus.text("mesh.stl", "ascii",
              "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n"
              "endsolid a\n");
  corpus.text("mesh.obj", "quads", "v 0 0 0\nv 1 0 0\nv 1 1 0 1 0 0\nv 0 1 0\nvn 0 0 1\nvt 0 0\nf 1//1 2/1/1 -2 4\n");
  corpus.text("mesh.off", "colours",
              "STCNOFF\n# c\n3 1 0\n0 0 0 0 0 1 9 9 9 255 0 0\n1 0 0 0 0 1 9 9 9 255 0 0\n"
              "0 1 0 0 0 1 9 9 9 255 0 0\n3 0 1 2 0.5 0.5 0.5\n");
}

void write_samples(const Corpus& corpus) {
  ResultTable table{{"x", "y"}, {"value"}, Eigen::MatrixXd::Identity(2, 3), Eigen::MatrixXd::Ones(3, 1)};
  write_table(corpus.path("samples.csv"), table);
  corpus.text("samples.csv", "missing", "\"x\";y;name;w;\n1;2;a;;\n# c\n1e5;-2;b;NA;\n0;nan;c;3;\n");
  PointCloud cloud;
  cloud.points = on_sphere(3);
  write_points(corpus.path("samples.npy"), cloud);
}

Volume<float> ball_image(Index length, int axes, SampleType type) {
  VolumeLayout layout;
  layout.grid.axes = axes;
  layout.grid.size = {length, length, axes == 3 ? length : 1};
  layout.grid.spacing = {1, 2, 3};
  layout.type = type;
  Volume<float> image(layout);
  const double middle = static_cast<double>(length - 1) / 2;
  for (Index i = 0; i < layout.grid.voxels(); ++i) {
    const Point<3> p(static_cast<double>(i % length) - middle, static_cast<double>(i / length % length) - middle,
                     axes == 3 ? static_cast<double>(i / (length * length)) - middle : 0.0);
    image.values[i] = p.norm() < middle / 2 ? 200.0F : 10.0F;
  }
  return image;
}

void write_images(const Corpus& corpus) {
  for (const char* target : {"volume.png", "volume.pgm", "volume.tif"})
    write_volume(corpus.path(target), ball_image(4, 2, SampleType::uint16));
  for (const char* target : {"volume.bmp", "volume.jpg"})
    write_volume(corpus.path(target), ball_image(4, 2, SampleType::uint8));
  corpus.text("volume.bmp", "palette",
              std::string("BM\112\0\0\0\0\0\0\0\102\0\0\0\50\0\0\0\3\0\0\0\2\0\0\0\1\0\4\0", 30) +
                  std::string(16, '\0') +
                  std::string("\3\0\0\0\0\0\0\0\0\0\0\0\0\0\377\0\377\377\377\0\1\40\0\0\42\20\0\0", 28));
  Volume<float> map = ball_image(4, 2, SampleType::float32);
  map.grid.direction(1, 1) = -1;
  map.crs = "EPSG:32633";
  write_volume(corpus.path("volume.tif", "map"), map);
  for (const char* name : {"written", "map"})
    fs::remove(fs::path(corpus.path("volume.tif", name)).replace_extension(".tfw"));
  for (const char* target : {"volume.nii", "volume.nii.gz", "volume.nrrd", "volume.mha", "volume.npy", "volume.vti"})
    write_volume(corpus.path(target), ball_image(3, 3, SampleType::uint8));
  corpus.text("volume.pgm", "ascii", "P2 # c\n3 2 9\n1 2 3\n4 5 9\n");
  corpus.text(
      "volume.nrrd", "ascii",
      "NRRD0004\n# c\ntype: short\ndimension: 3\nsizes: 2 2 1\nspace: left-posterior-superior\n"
      "space directions: (1,0,0) (0,2,0) (0,0,3)\nspace origin: (1,2,3)\nencoding: ascii\nkey:=value\n\n1 2 3 4\n");
  corpus.text("volume.mha", "ascii",
              "ObjectType = Image\nNDims = 2\nDimSize = 2 2\nBinaryData = False\nElementSpacing = 1 2\n"
              "TransformMatrix = 0 1 1 0\nOffset = 1 2\nElementType = MET_SHORT\nElementDataFile = LOCAL\n1 2 3 4\n");
}

void write_models(const Corpus& corpus) {
  PointCloud cloud;
  cloud.points = cloud.normals = on_sphere(40);
  write_model(corpus.path("model.csrbf"), *reconstruct(cloud).field);
  write_model(corpus.path("function.csrbf", "level_set"), to_function(segment<2>(ball_image(8, 2, SampleType::uint8))));
  const Eigen::MatrixXd x = on_sphere(12).topRows(2);
  for (const char* method : {"interpolate", "partition-of-unity"}) {
    FitOptions options;
    options.method = method;
    write_model(corpus.path("function.csrbf", method),
                {fit_function(x, x.row(0).transpose(), Eigen::VectorXd(), options)});
  }
}

}  // namespace
}  // namespace csrbf

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "usage: csrbf-fuzz-corpus FOLDER\n";
    return 2;
  }
  const csrbf::Corpus corpus(argv[1]);
  csrbf::write_geometry(corpus);
  csrbf::write_samples(corpus);
  csrbf::write_images(corpus);
  csrbf::write_models(corpus);
}
