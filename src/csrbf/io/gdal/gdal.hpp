#pragma once

#include "csrbf/io/files/table.hpp"
#include "csrbf/io/gdal/gdal_interface.hpp"

#include <optional>

namespace csrbf {

// Files of maps, read and written by GDAL where csrbf-gdal is installed; without it, all but the first four functions
// throw IoError that says what to do.

/// The version of GDAL; empty when csrbf-gdal is not there.
std::string gdal_version();

/// Is a reference system in degrees of longitude and latitude? nullopt without GDAL, and when it does not know it.
std::optional<bool> gdal_is_geographic(const std::string& crs);

/// The number of "EPSG:32633", if it has this form.
std::optional<int> epsg_code(std::string_view crs);

/// The name of a reference system that GDAL understands, as "EPSG:32633" where it has such a name, else as it is. A
/// number is an EPSG code. Throws IoError when GDAL does not know it; without GDAL, EPSG codes are known only.
std::string checked_crs(const std::string& crs);

/// An image of one or more bands, with its place on the map.
GdalRaster read_gdal_raster(const std::string& path);

/// Writes one in the format of the extension, complete or not at all.
void write_gdal_raster(const std::string& path, const GdalRaster& raster);

/// True for the extensions of points and lines on maps.
bool is_gdal_table(const std::string& extension);

/// Points with their numeric fields, as columns x, y and z where they have one.
Table read_gdal_table(const std::string& path, std::string& crs);

/// Writes points (columns x, y) with the other columns as fields, complete or not at all.
void write_gdal_table(const std::string& path, const std::vector<std::string>& names,
                      const Eigen::Ref<const Eigen::MatrixXd>& columns, const std::string& crs);

/// The lines of a file, a line with several parts as several ones; outlines and holes of polygons are closed lines,
/// which end where they begin.
std::vector<Points<2>> read_gdal_lines(const std::string& path);

/// Writes lines with one number each as a field, complete or not at all.
void write_gdal_lines(const std::string& path, const std::vector<Points<2>>& lines, const std::string& field,
                      const Eigen::VectorXd& numbers, const std::string& crs);

}  // namespace csrbf
