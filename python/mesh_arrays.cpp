#include "mesh_arrays.hpp"

#include <array>

namespace csrbf::python {
namespace {

using Numbers = py::array_t<std::int32_t, py::array::c_style | py::array::forcecast>;

// Types of .ply files and of numpy.
struct TypeName {
  const char* ply;
  const char* numpy;
};
constexpr std::array<TypeName, 8> type_names{{{"char", "int8"},
                                              {"uchar", "uint8"},
                                              {"short", "int16"},
                                              {"ushort", "uint16"},
                                              {"int", "int32"},
                                              {"uint", "uint32"},
                                              {"float", "float32"},
                                              {"double", "float64"}}};

py::dict to_dict(std::vector<Property>&& properties) {
  py::dict result;
  for (Property& property : properties) {
    const auto* type = std::find_if(type_names.begin(), type_names.end(),
                                    [&](const TypeName& name) { return property.type == name.ply; });
    const char* const numpy = type == type_names.end() ? "float64" : type->numpy;
    const py::array_t<double> values(property.values.size(), property.values.data());
    result[py::str(property.name)] = values.attr("astype")(numpy);
  }
  return result;
}

std::vector<Property> properties_from(const py::dict& given, Index count) {
  std::vector<Property> properties;
  for (const auto& [name, array] : given) {
    Property property{name.cast<std::string>(), "double", {}};
    const auto numpy = py::array::ensure(py::reinterpret_borrow<py::object>(array)).attr("dtype").attr("name");
    for (const TypeName& type : type_names)
      if (numpy.cast<std::string>() == type.numpy) property.type = type.ply;
    const Array values = Array::ensure(py::reinterpret_borrow<py::object>(array));
    if (!values) throw py::error_already_set();
    property.values = vector(values, property.name.c_str());
    require(property.values.size() == count, "Mesh", "size of the property " + property.name, property.values.size(),
            "must be that of the vertices or points, " + std::to_string(count));
    properties.push_back(std::move(property));
  }
  return properties;
}

// Rows of Columns vertex indices.
template <int Columns>
Eigen::Matrix<std::int32_t, Columns, Eigen::Dynamic> numbers_from(const py::handle& given, const char* name,
                                                                  Index vertices) {
  const auto array = given.cast<Numbers>();
  require(array.ndim() == 2 && array.shape(1) == Columns, "Mesh", std::string("dimension of ") + name, array.ndim(),
          "must be an array of " + std::to_string(Columns) + " columns");
  Eigen::Matrix<std::int32_t, Columns, Eigen::Dynamic> numbers =
      Eigen::Map<const Eigen::Matrix<std::int32_t, Columns, Eigen::Dynamic>>(array.data(), Columns, array.shape(0));
  require(numbers.size() == 0 || (numbers.minCoeff() >= 0 && numbers.maxCoeff() < vertices), "Mesh", name,
          "out of range", "must be vertex indices, from 0 on");
  return numbers;
}

Points<3> normals_from(const py::handle& given, Index count) {
  const auto array = given.cast<Array>();
  Points<3> normals = points<3>(array, "normals");
  require(normals.cols() == 0 || normals.cols() == count, "Mesh", "number of normals", normals.cols(),
          "there must be one for each vertex or point, or none");
  return normals;
}

}  // namespace

py::tuple to_tuple(Mesh&& mesh) {
  return py::make_tuple(to_array(std::move(mesh.vertices)), to_array(std::move(mesh.triangles)),
                        to_array(std::move(mesh.normals)), to_dict(std::move(mesh.properties)));
}

Mesh mesh_from(const py::tuple& given) {
  Mesh mesh;
  const auto vertices = given[0].cast<Array>();
  mesh.vertices = points<3>(vertices, "vertices");
  mesh.triangles = numbers_from<3>(given[1], "faces", mesh.vertices.cols());
  mesh.normals = normals_from(given[2], mesh.vertices.cols());
  mesh.properties = properties_from(given[3].cast<py::dict>(), mesh.vertices.cols());
  return mesh;
}

py::tuple to_tuple(PointCloud&& cloud) {
  return py::make_tuple(to_array(std::move(cloud.points)), to_array(std::move(cloud.normals)),
                        to_dict(std::move(cloud.properties)));
}

PointCloud cloud_from(const py::tuple& given) {
  PointCloud cloud;
  const auto coordinates = given[0].cast<Array>();
  cloud.points = points<3>(coordinates, "points");
  cloud.normals = normals_from(given[1], cloud.points.cols());
  cloud.properties = properties_from(given[2].cast<py::dict>(), cloud.points.cols());
  return cloud;
}

py::tuple to_tuple(Polylines&& lines) {
  return py::make_tuple(to_array(std::move(lines.vertices)), to_array(std::move(lines.edges)),
                        to_dict(std::move(lines.properties)));
}

Polylines polylines_from(const py::tuple& given) {
  Polylines lines;
  const auto vertices = given[0].cast<Array>();
  lines.vertices = points<3>(vertices, "vertices");
  lines.edges = numbers_from<2>(given[1], "edges", lines.vertices.cols());
  lines.properties = properties_from(given[2].cast<py::dict>(), lines.vertices.cols());
  return lines;
}

}  // namespace csrbf::python
