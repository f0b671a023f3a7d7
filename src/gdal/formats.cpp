#include "gdal/formats.hpp"

#include <cpl_string.h>

namespace csrbf {

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

}  // namespace csrbf
