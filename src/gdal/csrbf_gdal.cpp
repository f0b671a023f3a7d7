// The part of the library that links GDAL: csrbf-gdal, loaded by io/gdal/gdal.cpp when it is needed.

#include "csrbf/io/gdal/gdal_interface.hpp"

#include "csrbf/core/grid.hpp"
#include "gdal/handles.hpp"

#include <cpl_conv.h>
#include <cpl_string.h>
#include <gdal.h>
#include <ogr_api.h>
#include <ogr_srs_api.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <type_traits>

namespace csrbf {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double no_data_of_integers = -9999;

struct Destroy {
  void operator()(OGRSpatialReferenceH system) const { OSRDestroySpatialReference(system); }
};
using ReferenceSystem = std::unique_ptr<std::remove_pointer_t<OGRSpatialReferenceH>, Destroy>;

std::string short_name_of(OGRSpatialReferenceH system) {
  const char *authority = OSRGetAuthorityName(system, nullptr), *code = OSRGetAuthorityCode(system, nullptr);
  return authority != nullptr && code != nullptr ? std::string(authority) + ":" + code : "";
}

// The name of the system in the register of EPSG that is the same but for its name, as of the .prj files of ESRI.
std::string registered_name_of(OGRSpatialReferenceH system) {
  constexpr int same = 90;  // per cent, by GDAL
  int count = 0;
  int* confidences = nullptr;
  OGRSpatialReferenceH* matches = OSRFindMatches(system, nullptr, &count, &confidences);
  const std::string name = count > 0 && confidences[0] >= same ? short_name_of(matches[0]) : "";
  OSRFreeSRSArray(matches);
  CPLFree(confidences);
  return name;
}

std::string name_of(OGRSpatialReferenceH system) {
  if (system == nullptr) return "";
  if (std::string name = short_name_of(system); !name.empty()) return name;
  if (std::string name = registered_name_of(system); !name.empty()) return name;
  char* text = nullptr;
  const std::string wkt = OSRExportToWkt(system, &text) == OGRERR_NONE && text != nullptr ? text : "";
  CPLFree(text);
  return wkt;
}

// Null when there is none, or it is not known.
ReferenceSystem system_of(const std::string& crs) {
  if (crs.empty()) return nullptr;
  ReferenceSystem system(OSRNewSpatialReference(nullptr));
  if (OSRSetFromUserInput(system.get(), crs.c_str()) != OGRERR_NONE) return nullptr;
  OSRSetAxisMappingStrategy(system.get(), OAMS_TRADITIONAL_GIS_ORDER);
  return system;
}

struct TypePair {
  SampleType ours;
  GDALDataType theirs;
};
// What GDAL has no type for is written as the next larger one.
constexpr TypePair types[] = {{SampleType::uint8, GDT_Byte},      {SampleType::uint16, GDT_UInt16},
                              {SampleType::int16, GDT_Int16},     {SampleType::uint32, GDT_UInt32},
                              {SampleType::int32, GDT_Int32},     {SampleType::float32, GDT_Float32},
                              {SampleType::float64, GDT_Float64}, {SampleType::int8, GDT_Int16},
                              {SampleType::uint64, GDT_Float64},  {SampleType::int64, GDT_Float64}};

SampleType ours(GDALDataType type) {
  for (const TypePair& pair : types)
    if (pair.theirs == type) return pair.ours;
  return SampleType::float64;
}

GDALDataType theirs(SampleType type) {
  for (const TypePair& pair : types)
    if (pair.ours == type) return pair.theirs;
  return GDT_Float64;
}

// The variables of a file that holds several.
std::string variables_of(GDALDatasetH dataset) {
  char** list = GDALGetMetadata(dataset, "SUBDATASETS");
  std::string names;
  for (int i = 0; list != nullptr && list[i] != nullptr; i += 2) {
    const std::string entry = list[i];
    names += (names.empty() ? "" : ", ") + entry.substr(entry.find('=') + 1);
  }
  return names;
}

std::string read_band(GDALRasterBandH band, int index, GdalRaster& raster) {
  const auto width = static_cast<int>(raster.width), height = static_cast<int>(raster.height);
  const auto stride = static_cast<GSpacing>(raster.bands * static_cast<std::int64_t>(sizeof(double)));
  if (GDALRasterIOEx(band, GF_Read, 0, 0, width, height, raster.values.data() + index, width, height, GDT_Float64,
                     stride, stride * width, nullptr) != CE_None)
    return Quiet::reason("the pixels cannot be read");
  int has_no_data = 0, has_scale = 0, has_offset = 0;
  const double no_data = GDALGetRasterNoDataValue(band, &has_no_data);
  const double scale = GDALGetRasterScale(band, &has_scale), offset = GDALGetRasterOffset(band, &has_offset);
  const bool scaled = (has_scale != 0 && scale != 1) || (has_offset != 0 && offset != 0);
  const bool keeps = GDALGetRasterDataType(band) == GDT_Byte && !scaled;
  if (scaled) raster.type = static_cast<int>(SampleType::float64);
  const auto type = static_cast<SampleType>(raster.type);
  if (has_no_data != 0 && !keeps && !is_floating(type))
    raster.type = static_cast<int>(type == SampleType::int32 || type == SampleType::uint32 ? SampleType::float64
                                                                                           : SampleType::float32);
  const std::size_t count = static_cast<std::size_t>(raster.width * raster.height);
  for (std::size_t i = 0; i < count; ++i) {
    double& value = raster.values[i * static_cast<std::size_t>(raster.bands) + static_cast<std::size_t>(index)];
    if (has_no_data != 0 && !keeps && value == no_data)
      value = nan;
    else if (scaled)
      value = value * (has_scale != 0 ? scale : 1) + (has_offset != 0 ? offset : 0);
  }
  return "";
}

std::string read_raster(const std::string& path, GdalRaster& raster) {
  const Quiet quiet;
  const Dataset dataset(GDALOpenEx(path.c_str(), GDAL_OF_RASTER | GDAL_OF_READONLY, nullptr, nullptr, nullptr));
  if (!dataset) return Quiet::reason("the file is not known");
  raster.bands = GDALGetRasterCount(dataset.get());
  if (raster.bands == 0) {
    const std::string variables = variables_of(dataset.get());
    return variables.empty() ? "the file holds no image"
                             : "the file holds several variables; write one of them by gdal_translate: " + variables;
  }
  raster.width = GDALGetRasterXSize(dataset.get());
  raster.height = GDALGetRasterYSize(dataset.get());
  raster.type = static_cast<int>(ours(GDALGetRasterDataType(GDALGetRasterBand(dataset.get(), 1))));
  raster.is_placed = GDALGetGeoTransform(dataset.get(), raster.map.data()) == CE_None;
  raster.crs = name_of(GDALGetSpatialRef(dataset.get()));
  constexpr std::int64_t most = std::int64_t{1} << 36;
  if (raster.width * raster.height > most / raster.bands) return "the image has more than 2^36 numbers";
  raster.values.resize(static_cast<std::size_t>(raster.width * raster.height * raster.bands));
  for (int band = 0; band < raster.bands; ++band)
    if (std::string failure = read_band(GDALGetRasterBand(dataset.get(), band + 1), band, raster); !failure.empty())
      return failure;
  return "";
}

std::string extension_of(const std::string& path) {
  return path.substr(path.rfind('.') + 1);
}

GDALDriverH driver_of(const std::string& path) {
  struct Format {
    const char *extension, *driver;
  };
  constexpr Format formats[] = {{"asc", "AAIGrid"},     {"nc", "netCDF"},     {"tif", "GTiff"},
                                {"tiff", "GTiff"},      {"gpkg", "GPKG"},     {"shp", "ESRI Shapefile"},
                                {"geojson", "GeoJSON"}, {"fgb", "FlatGeobuf"}};
  for (const Format& format : formats)
    if (EQUAL(extension_of(path).c_str(), format.extension)) return GDALGetDriverByName(format.driver);
  return nullptr;
}

// Fills an image in memory, of which the file is a copy: several formats can be written in no other way.
std::string fill(GDALDatasetH memory, const GdalRaster& raster) {
  if (raster.is_placed) GDALSetGeoTransform(memory, const_cast<double*>(raster.map.data()));
  if (!raster.crs.empty()) {
    const ReferenceSystem system = system_of(raster.crs);
    if (!system) return "the reference system " + raster.crs + " is not known to GDAL";
    GDALSetSpatialRef(memory, system.get());
  }
  const auto width = static_cast<int>(raster.width), height = static_cast<int>(raster.height);
  for (int band = 0; band < raster.bands; ++band) {
    GDALRasterBandH target = GDALGetRasterBand(memory, band + 1);
    std::vector<double> values(static_cast<std::size_t>(raster.width * raster.height));
    bool has_gaps = false;
    for (std::size_t i = 0; i < values.size(); ++i) {
      values[i] = raster.values[i * static_cast<std::size_t>(raster.bands) + static_cast<std::size_t>(band)];
      has_gaps = has_gaps || std::isnan(values[i]);
      if (std::isnan(values[i])) values[i] = no_data_of_integers;
    }
    if (has_gaps) GDALSetRasterNoDataValue(target, no_data_of_integers);
    if (GDALRasterIOEx(target, GF_Write, 0, 0, width, height, values.data(), width, height, GDT_Float64, sizeof(double),
                       static_cast<GSpacing>(sizeof(double)) * width, nullptr) != CE_None)
      return Quiet::reason("the image does not fit into memory");
  }
  return "";
}

// Drivers do not tell of all that they could not write, as on a full disk, least of all when they close a file: what
// was written is read again.
constexpr const char* incomplete = "the file could not be written in full, as when no space is left on the device";

Dataset open_raster(const char* path) {
  return Dataset(GDALOpenEx(path, GDAL_OF_RASTER | GDAL_OF_READONLY, nullptr, nullptr, nullptr));
}

// Of a file that holds one image, or bands as variables, as several do in .nc.
std::vector<Dataset> open_bands(const std::string& path) {
  std::vector<Dataset> parts;
  parts.push_back(open_raster(path.c_str()));
  if (!parts.front() || GDALGetRasterCount(parts.front().get()) > 0) return parts;
  char** list = GDALGetMetadata(parts.front().get(), "SUBDATASETS");
  for (int i = 0; list != nullptr && list[i] != nullptr; i += 2)
    parts.push_back(open_raster(std::string(list[i]).substr(std::string(list[i]).find('=') + 1).c_str()));
  return parts;
}

bool is_same_band(GDALRasterBandH written, GDALRasterBandH copy) {
  const int width = GDALGetRasterBandXSize(written), height = GDALGetRasterBandYSize(written);
  if (GDALGetRasterBandXSize(copy) != width || GDALGetRasterBandYSize(copy) != height) return false;
  const auto is_same = [](double a, double b) {  // in text numbers have fewer digits
    return a == b || (std::isnan(a) && std::isnan(b)) ||
           std::abs(a - b) <= 1e-6 * std::abs(a) + std::numeric_limits<float>::min();
  };
  std::vector<double> row(static_cast<std::size_t>(width)), row_of_copy(row.size());
  const auto read = [&](GDALRasterBandH band, int y, std::vector<double>& values) {
    return GDALRasterIO(band, GF_Read, 0, y, width, 1, values.data(), width, 1, GDT_Float64, 0, 0) == CE_None;
  };
  for (int y = 0; y < height; ++y)
    if (!read(written, y, row) || !read(copy, y, row_of_copy) ||
        !std::equal(row.begin(), row.end(), row_of_copy.begin(), is_same))
      return false;
  return true;
}

// Are the numbers of a file those of the image that it is a copy of?
std::string check_copy(const std::string& path, GDALDatasetH memory) {
  int found = 0;
  for (const Dataset& part : open_bands(path))
    for (int band = 1; part && band <= GDALGetRasterCount(part.get()); ++band)
      if (++found > GDALGetRasterCount(memory) ||
          !is_same_band(GDALGetRasterBand(memory, found), GDALGetRasterBand(part.get(), band)))
        return incomplete;
  return found == GDALGetRasterCount(memory) ? "" : incomplete;
}

std::string write_raster(const std::string& path, const GdalRaster& raster) {
  const Quiet quiet;
  GDALDriverH driver = driver_of(path);
  if (driver == nullptr) return "this GDAL cannot write ." + extension_of(path) + " files";
  const Dataset memory(GDALCreate(GDALGetDriverByName("MEM"), "", static_cast<int>(raster.width),
                                  static_cast<int>(raster.height), static_cast<int>(raster.bands),
                                  theirs(static_cast<SampleType>(raster.type)), nullptr));
  if (!memory) return Quiet::reason("the image does not fit into memory");
  if (std::string failure = fill(memory.get(), raster); !failure.empty()) return failure;
  const bool is_netcdf = EQUAL(extension_of(path).c_str(), "nc");
  for (int k = 0; is_netcdf && k < std::ssize(raster.names); ++k)
    GDALSetMetadataItem(GDALGetRasterBand(memory.get(), k + 1), "NETCDF_VARNAME", raster.names[k].c_str(), nullptr);
  const char* const no_history[] = {"WRITE_GDAL_HISTORY=NO", nullptr};  // it would name a file that is moved
  char** const options = is_netcdf ? const_cast<char**>(no_history) : nullptr;
  Dataset file(GDALCreateCopy(driver, path.c_str(), memory.get(), 0, options, nullptr, nullptr));
  if (!file) return Quiet::reason("the file cannot be written");
  file.reset();
  return check_copy(path, memory.get());
}

bool is_number(OGRFieldType type) {
  return type == OFTInteger || type == OFTInteger64 || type == OFTReal;
}

std::string read_features(OGRLayerH layer, GdalTable& table) {
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
  for (OGRFeatureH feature = OGR_L_GetNextFeature(layer); feature != nullptr; feature = OGR_L_GetNextFeature(layer)) {
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
    OGR_F_Destroy(feature);
  }
  if (table.columns.front().empty())
    return others > 0 ? "the file holds lines or polygons but no points" : "the file holds no points";
  return "";
}

std::string read_table(const std::string& path, GdalTable& table) {
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
  table.crs = name_of(OGR_L_GetSpatialRef(layer));
  return read_features(layer, table);
}

std::string write_features(OGRLayerH layer, const GdalTable& table, std::size_t first) {
  for (std::size_t c = first; c < table.names.size(); ++c) {
    OGRFieldDefnH field = OGR_Fld_Create(table.names[c].c_str(), OFTReal);
    const bool done = OGR_L_CreateField(layer, field, 1) == OGRERR_NONE;
    OGR_Fld_Destroy(field);
    if (!done) return Quiet::reason("the field " + table.names[c] + " cannot be made");
  }
  OGRFeatureDefnH definition = OGR_L_GetLayerDefn(layer);
  const std::size_t rows = table.columns.front().size();
  for (std::size_t row = 0; row < rows; ++row) {
    OGRFeatureH feature = OGR_F_Create(definition);
    OGRGeometryH point = OGR_G_CreateGeometry(first == 3 ? wkbPoint25D : wkbPoint);
    if (first == 3)
      OGR_G_SetPoint(point, 0, table.columns[0][row], table.columns[1][row], table.columns[2][row]);
    else
      OGR_G_SetPoint_2D(point, 0, table.columns[0][row], table.columns[1][row]);
    OGR_F_SetGeometryDirectly(feature, point);
    for (std::size_t c = first; c < table.names.size(); ++c)
      if (!std::isnan(table.columns[c][row]))
        OGR_F_SetFieldDouble(feature, static_cast<int>(c - first), table.columns[c][row]);
    const bool done = OGR_L_CreateFeature(layer, feature) == OGRERR_NONE;
    OGR_F_Destroy(feature);
    if (!done) return Quiet::reason("point " + std::to_string(row + 1) + " cannot be written");
  }
  return "";
}

std::string write_table(const std::string& path, const GdalTable& table) {
  const Quiet quiet;
  GDALDriverH driver = driver_of(path);
  if (driver == nullptr) return "this GDAL cannot write ." + extension_of(path) + " files";
  Dataset dataset(GDALCreate(driver, path.c_str(), 0, 0, 0, GDT_Unknown, nullptr));
  if (!dataset) return Quiet::reason("the file cannot be written");
  const ReferenceSystem system = system_of(table.crs);
  if (!system && !table.crs.empty()) return "the reference system " + table.crs + " is not known to GDAL";
  const std::size_t coordinates = table.names.size() > 2 && table.names[2] == "z" ? 3 : 2;
  std::string name = path.substr(path.rfind('/') + 1);
  name = name.substr(0, name.rfind('.'));
  // FlatGeobuf sorts points for its index.
  const char* const in_order[] = {"SPATIAL_INDEX=NO", nullptr};
  const bool sorts = EQUAL(extension_of(path).c_str(), "fgb");
  OGRLayerH layer =
      GDALDatasetCreateLayer(dataset.get(), name.c_str(), system.get(), coordinates == 3 ? wkbPoint25D : wkbPoint,
                             sorts ? const_cast<char**>(in_order) : nullptr);
  if (layer == nullptr) return Quiet::reason("the layer cannot be made");
  const bool transaction = OGR_L_StartTransaction(layer) == OGRERR_NONE;
  std::string failure = write_features(layer, table, coordinates);
  if (transaction && failure.empty() && OGR_L_CommitTransaction(layer) != OGRERR_NONE)
    failure = Quiet::reason("the points cannot be written");
  if (!failure.empty()) return failure;
  dataset.reset();
  GdalTable again;
  const bool is_complete =
      read_table(path, again).empty() && again.columns.front().size() == table.columns.front().size();
  return is_complete ? "" : incomplete;
}

std::string describe_crs(const std::string& crs, bool& geographic, std::string& short_name) {
  const Quiet quiet;
  const ReferenceSystem system = system_of(crs);
  if (!system) return Quiet::reason("no such reference system");
  geographic = OSRIsGeographic(system.get()) != 0;
  short_name = name_of(system.get());
  return "";
}

std::string version() {
  return GDALVersionInfo("RELEASE_NAME");
}

}  // namespace
}  // namespace csrbf

extern "C" __attribute__((visibility("default"))) const csrbf::GdalFunctions* CSRBF_GDAL_ENTRY() {
  static const csrbf::GdalFunctions functions{csrbf::read_raster, csrbf::write_raster, csrbf::read_table,
                                              csrbf::write_table, csrbf::describe_crs, csrbf::version};
  GDALAllRegister();
  return &functions;
}
