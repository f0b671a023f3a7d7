#include "gdal/rasters.hpp"

#include "csrbf/core/grid.hpp"
#include "gdal/formats.hpp"
#include "gdal/handles.hpp"
#include "gdal/reference_system.hpp"

#include <cpl_string.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace csrbf {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double no_data_of_integers = -9999;

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

}  // namespace

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

}  // namespace csrbf
