#include "csrbf/io/vtk/formats.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/io/files/atomic_file.hpp"
#include "csrbf/io/files/read_file.hpp"
#include "csrbf/io/files/text.hpp"

#include <cstdint>

namespace csrbf {
namespace {

constexpr Index extents = 6;

std::string numbers(std::initializer_list<double> values) {
  std::string text;
  for (const double value : values) {
    if (!text.empty()) text += ' ';
    append_number(text, value);
  }
  return text;
}

// The array with the values in an element PointData or CellData; null when there is none.
const XmlElement* find_values(const XmlElement* data) {
  if (data == nullptr) return nullptr;
  const std::string* active = data->attribute("Scalars");
  const XmlElement* first = nullptr;
  for (const XmlElement& array : data->children) {
    if (array.name != "DataArray") continue;
    if (first == nullptr) first = &array;
    const std::string* name = array.attribute("Name");
    if (active != nullptr && name != nullptr && *name == *active) return &array;
  }
  return first;
}

// The lattice of the points.
Grid read_grid(const VtkReader& reader, const std::string& name) {
  const XmlElement& image = reader.data_set();
  const auto extent = reader.numbers(image, "WholeExtent", extents);
  if (!extent) reader.fail("the image has no WholeExtent");
  if (const auto part = reader.numbers(reader.piece(), "Extent", extents); part && *part != *extent)
    reader.fail("the piece holds a part of the image only");
  Grid grid;
  const Eigen::VectorXd spacing = reader.numbers(image, "Spacing", 3).value_or(Eigen::Vector3d::Ones());
  const Eigen::VectorXd origin = reader.numbers(image, "Origin", 3).value_or(Eigen::Vector3d::Zero());
  Eigen::Matrix3d linear = Eigen::Matrix3d::Identity();
  if (const auto rows = reader.numbers(image, "Direction", 9))
    linear = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(rows->data());
  linear = linear * spacing.asDiagonal();
  Eigen::Vector3d first;
  for (Index a = 0; a < 3; ++a) {
    constexpr double most = 1 << 30;  // a limit on damaged files
    const double lo = (*extent)[2 * a], hi = (*extent)[2 * a + 1];
    if (lo != std::floor(lo) || hi != std::floor(hi) || !(hi >= lo && std::abs(lo) <= most && hi <= most))
      reader.fail("axis " + std::to_string(a + 1) + " of the image has no points");
    grid.size[a] = static_cast<Index>(hi - lo) + 1;
    first[a] = lo;
  }
  grid.origin = origin + linear * first;
  set_axes(grid, linear, name);
  return grid;
}

// Cells lie between points.
void turn_into_cells(Grid& grid) {
  for (Index a = 0; a < 3; ++a) {
    Index& size = grid.size[a];
    if (size > 1) grid.origin += grid.spacing[a] / 2 * grid.direction.col(a);
    size = std::max<Index>(1, size - 1);
  }
}

}  // namespace

RawVolume parse_vti(std::string bytes, const std::string& path) {
  const std::string name = display_name(path);
  const VtkReader reader(bytes, "ImageData", name);
  RawVolume raw;
  Grid& grid = raw.layout.grid;
  grid = read_grid(reader, name);
  const XmlElement* values = find_values(reader.piece().child("PointData"));
  if (values == nullptr) {
    values = find_values(reader.piece().child("CellData"));
    if (values == nullptr) reader.fail("the image has no array of points or cells");
    turn_into_cells(grid);
  }
  grid.axes = grid.dimension();
  raw.layout.type = reader.type(*values);
  raw.layout.components = reader.components(*values);
  raw.order = reader.order();
  constexpr std::uint64_t any = std::uint64_t{1} << 60;
  checked_sample_bytes(raw.layout, any, name);
  raw.bytes = reader.bytes(*values, grid.voxels());
  return raw;
}

FileParts format_vti(const VolumeLayout& layout, std::string samples) {
  std::vector<VtkArray> arrays(1);
  arrays.front() = {"values", layout.type, layout.components, std::move(samples)};
  return format_vti(layout.grid, std::move(arrays));
}

FileParts format_vti(const Grid& grid, std::vector<VtkArray> arrays) {
  std::string extent;
  for (const Index n : grid.size) extent += (extent.empty() ? "0 " : " 0 ") + std::to_string(n - 1);
  const Point<3>&origin = grid.origin, &spacing = grid.spacing;
  const Eigen::Matrix3d& d = grid.direction;
  std::string content =
      "<ImageData WholeExtent=\"" + extent + "\" Origin=\"" + numbers({origin.x(), origin.y(), origin.z()}) +
      "\" Spacing=\"" + numbers({spacing.x(), spacing.y(), spacing.z()}) + "\" Direction=\"" +
      numbers({d(0, 0), d(0, 1), d(0, 2), d(1, 0), d(1, 1), d(1, 2), d(2, 0), d(2, 1), d(2, 2)}) +
      "\">\n<Piece Extent=\"" + extent + "\">\n<PointData Scalars=\"" + xml_escaped(arrays.front().name) + "\">\n";
  VtkWriter writer;
  for (VtkArray& array : arrays) content += writer.array(std::move(array));
  return writer.file("ImageData", content + "</PointData>\n</Piece>\n</ImageData>\n");
}

void write_vti(const std::string& path, const Grid& grid, std::vector<VtkArray> arrays) {
  if (file_extension(path) != ".vti") refuse_extension(path, file_extension(path), "several arrays go to .vti");
  require(!arrays.empty(), "write_vti", "arrays", 0, "at least one is needed");
  for (const VtkArray& array : arrays)
    require(array.bytes.size() == array.components * grid.voxels() * sample_size(array.type), "write_vti",
            "bytes of array " + array.name, array.bytes.size(), "one number per component and voxel");
  write_parts(path, format_vti(grid, std::move(arrays)));
}

}  // namespace csrbf
