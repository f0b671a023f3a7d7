#include "gdal/vectors.hpp"

#include "gdal/formats.hpp"
#include "gdal/handles.hpp"
#include "gdal/reference_system.hpp"

#include <cpl_string.h>
#include <ogr_api.h>

#include <cmath>
#include <functional>
#include <limits>

namespace csrbf {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

bool is_number(OGRFieldType type) {
  return type == OFTInteger || type == OFTInteger64 || type == OFTReal;
}

// The only layer of a file; `read` says why it failed, or nothing.
std::string read_layer(const std::string& path, std::string& crs, const std::function<std::string(OGRLayerH)>& read) {
  const Quiet quiet;
  const Dataset dataset(GDALOpenEx(path.c_str(), GDAL_OF_VECTOR | GDAL_OF_READONLY, nullptr, nullptr, nullptr));
  if (!dataset) return Quiet::reason("the file is not known");
  const int layers = GDALDatasetGetLayerCount(dataset.get());
  if (layers != 1) {
    std::string names;
    for (int i = 0; i < layers; ++i)
      names += (i > 0 ? ", " : "") + std::string(OGR_L_GetName(GDALDatasetGetLayer(dataset.get(), i)));
    return "the file holds " + std::to_string(layers) + " layers" + (layers > 0 ? " (" + names + ")" : "") +
           "; write one of them to a file of its own by ogr2ogr";
  }
  OGRLayerH layer = GDALDatasetGetLayer(dataset.get(), 0);
  crs = name_of(OGR_L_GetSpatialRef(layer));
  return read(layer);
}

void for_each_feature(OGRLayerH layer, const std::function<void(OGRFeatureH)>& visit) {
  for (OGRFeatureH feature = OGR_L_GetNextFeature(layer); feature != nullptr; feature = OGR_L_GetNextFeature(layer)) {
    visit(feature);
    OGR_F_Destroy(feature);
  }
}

std::string read_points(OGRLayerH layer, GdalTable& table) {
  OGRFeatureDefnH definition = OGR_L_GetLayerDefn(layer);
  const bool has_z = OGR_GT_HasZ(OGR_L_GetGeomType(layer)) != 0;
  table.names = {"x", "y"};
  if (has_z) table.names.emplace_back("z");
  std::vector<int> fields;
  for (int f = 0; f < OGR_FD_GetFieldCount(definition); ++f) {
    OGRFieldDefnH field = OGR_FD_GetFieldDefn(definition, f);
    std::vector<std::string>& list = is_number(OGR_Fld_GetType(field)) ? table.names : table.texts;
    list.emplace_back(OGR_Fld_GetNameRef(field));
    if (is_number(OGR_Fld_GetType(field))) fields.push_back(f);
  }
  table.columns.resize(table.names.size());
  std::int64_t others = 0;
  for_each_feature(layer, [&](OGRFeatureH feature) {
    OGRGeometryH geometry = OGR_F_GetGeometryRef(feature);
    const bool is_collection = geometry != nullptr && wkbFlatten(OGR_G_GetGeometryType(geometry)) == wkbMultiPoint;
    const int parts = is_collection ? OGR_G_GetGeometryCount(geometry) : 1;
    for (int part = 0; part < parts; ++part) {
      OGRGeometryH point = is_collection ? OGR_G_GetGeometryRef(geometry, part) : geometry;
      if (point == nullptr || wkbFlatten(OGR_G_GetGeometryType(point)) != wkbPoint || OGR_G_IsEmpty(point) != 0) {
        ++others;
        continue;
      }
      std::size_t c = 0;
      table.columns[c++].push_back(OGR_G_GetX(point, 0));
      table.columns[c++].push_back(OGR_G_GetY(point, 0));
      if (has_z) table.columns[c++].push_back(OGR_G_GetZ(point, 0));
      for (const int f : fields)
        table.columns[c++].push_back(OGR_F_IsFieldSetAndNotNull(feature, f) != 0 ? OGR_F_GetFieldAsDouble(feature, f)
                                                                                 : nan);
    }
  });
  if (table.columns.front().empty())
    return others > 0 ? "the file holds lines or polygons but no points" : "the file holds no points";
  return "";
}

// The lines in a geometry, whatever it is made of; curves become straight segments.
void add_lines(OGRGeometryH geometry, std::vector<std::vector<double>>& lines) {
  if (geometry == nullptr) return;
  if (OGR_G_HasCurveGeometry(geometry, 1) != 0) {
    OGRGeometryH straight = OGR_G_GetLinearGeometry(geometry, 0, nullptr);
    add_lines(straight, lines);
    OGR_G_DestroyGeometry(straight);
    return;
  }
  for (int part = 0; part < OGR_G_GetGeometryCount(geometry); ++part)
    add_lines(OGR_G_GetGeometryRef(geometry, part), lines);
  if (wkbFlatten(OGR_G_GetGeometryType(geometry)) != wkbLineString || OGR_G_IsEmpty(geometry) != 0) return;
  std::vector<double> vertices;
  for (int i = 0; i < OGR_G_GetPointCount(geometry); ++i) {
    vertices.push_back(OGR_G_GetX(geometry, i));
    vertices.push_back(OGR_G_GetY(geometry, i));
  }
  lines.push_back(std::move(vertices));
}

bool make_field(OGRLayerH layer, const std::string& name) {
  OGRFieldDefnH field = OGR_Fld_Create(name.c_str(), OFTReal);
  const bool done = OGR_L_CreateField(layer, field, 1) == OGRERR_NONE;
  OGR_Fld_Destroy(field);
  return done;
}

// Writes one feature, with the geometry and with numbers where they are no NaN.
bool write_feature(OGRLayerH layer, OGRGeometryH geometry, const std::vector<double>& numbers) {
  OGRFeatureH feature = OGR_F_Create(OGR_L_GetLayerDefn(layer));
  OGR_F_SetGeometryDirectly(feature, geometry);
  for (std::size_t f = 0; f < numbers.size(); ++f)
    if (!std::isnan(numbers[f])) OGR_F_SetFieldDouble(feature, static_cast<int>(f), numbers[f]);
  const bool done = OGR_L_CreateFeature(layer, feature) == OGRERR_NONE;
  OGR_F_Destroy(feature);
  return done;
}

std::string write_points(OGRLayerH layer, const GdalTable& table, std::size_t first) {
  std::vector<double> numbers(table.names.size() - first);
  for (std::size_t row = 0; row < table.columns.front().size(); ++row) {
    OGRGeometryH point = OGR_G_CreateGeometry(first == 3 ? wkbPoint25D : wkbPoint);
    if (first == 3)
      OGR_G_SetPoint(point, 0, table.columns[0][row], table.columns[1][row], table.columns[2][row]);
    else
      OGR_G_SetPoint_2D(point, 0, table.columns[0][row], table.columns[1][row]);
    for (std::size_t f = 0; f < numbers.size(); ++f) numbers[f] = table.columns[first + f][row];
    if (!write_feature(layer, point, numbers))
      return Quiet::reason("point " + std::to_string(row + 1) + " cannot be written");
  }
  return "";
}

// A file with one layer, which `write` fills; it says why it failed, or nothing.
std::string write_layer(const std::string& path, const std::string& crs, OGRwkbGeometryType type,
                        const std::vector<std::string>& fields, const std::function<std::string(OGRLayerH)>& write) {
  GDALDriverH driver = driver_of(path);
  if (driver == nullptr) return "this GDAL cannot write ." + extension_of(path) + " files";
  const Dataset dataset(GDALCreate(driver, path.c_str(), 0, 0, 0, GDT_Unknown, nullptr));
  if (!dataset) return Quiet::reason("the file cannot be written");
  const ReferenceSystem system = system_of(crs);
  if (!system && !crs.empty()) return "the reference system " + crs + " is not known to GDAL";
  std::string name = path.substr(path.rfind('/') + 1);
  name = name.substr(0, name.rfind('.'));
  // FlatGeobuf sorts features for its index.
  const char* const in_order[] = {"SPATIAL_INDEX=NO", nullptr};
  const bool sorts = EQUAL(extension_of(path).c_str(), "fgb");
  OGRLayerH layer = GDALDatasetCreateLayer(dataset.get(), name.c_str(), system.get(), type,
                                           sorts ? const_cast<char**>(in_order) : nullptr);
  if (layer == nullptr) return Quiet::reason("the layer cannot be made");
  const bool transaction = OGR_L_StartTransaction(layer) == OGRERR_NONE;
  for (const std::string& field : fields)
    if (!make_field(layer, field)) return Quiet::reason("the field " + field + " cannot be made");
  std::string failure = write(layer);
  if (transaction && failure.empty() && OGR_L_CommitTransaction(layer) != OGRERR_NONE)
    failure = Quiet::reason("the layer cannot be written");
  return failure;
}

}  // namespace

std::string read_table(const std::string& path, GdalTable& table) {
  return read_layer(path, table.crs, [&](OGRLayerH layer) { return read_points(layer, table); });
}

std::string write_table(const std::string& path, const GdalTable& table) {
  const Quiet quiet;
  const std::size_t first = table.names.size() > 2 && table.names[2] == "z" ? 3 : 2;
  const std::vector<std::string> fields(table.names.begin() + static_cast<std::ptrdiff_t>(first), table.names.end());
  std::string failure = write_layer(path, table.crs, first == 3 ? wkbPoint25D : wkbPoint, fields,
                                    [&](OGRLayerH layer) { return write_points(layer, table, first); });
  if (!failure.empty()) return failure;
  GdalTable again;
  const bool is_complete =
      read_table(path, again).empty() && again.columns.front().size() == table.columns.front().size();
  return is_complete ? "" : incomplete;
}

std::string read_lines(const std::string& path, GdalLines& lines) {
  return read_layer(path, lines.crs, [&](OGRLayerH layer) -> std::string {
    for_each_feature(layer, [&](OGRFeatureH feature) { add_lines(OGR_F_GetGeometryRef(feature), lines.vertices); });
    return lines.vertices.empty() ? "the file holds no lines" : "";
  });
}

std::string write_lines(const std::string& path, const GdalLines& lines) {
  const Quiet quiet;
  const std::vector<std::string> fields(lines.field.empty() ? 0 : 1, lines.field);
  std::string failure = write_layer(path, lines.crs, wkbLineString, fields, [&](OGRLayerH layer) -> std::string {
    for (std::size_t n = 0; n < lines.vertices.size(); ++n) {
      OGRGeometryH line = OGR_G_CreateGeometry(wkbLineString);
      for (std::size_t i = 0; i < lines.vertices[n].size(); i += 2)
        OGR_G_AddPoint_2D(line, lines.vertices[n][i], lines.vertices[n][i + 1]);
      if (!write_feature(layer, line, fields.empty() ? std::vector<double>{} : std::vector<double>{lines.numbers[n]}))
        return Quiet::reason("line " + std::to_string(n + 1) + " cannot be written");
    }
    return "";
  });
  if (!failure.empty() || lines.vertices.empty()) return failure;
  GdalLines again;
  return read_lines(path, again).empty() && again.vertices.size() == lines.vertices.size() ? "" : incomplete;
}

}  // namespace csrbf
