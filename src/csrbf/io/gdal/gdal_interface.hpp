#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace csrbf {

// What the library and its part that links GDAL tell each other. That part is a file of its own, csrbf-gdal, loaded
// when the first such file is read or written: GDAL and what it needs would double the time that the program takes to
// start.

/// An image on a map: rows from the first one of the file on.
struct GdalRaster {
  std::int64_t width = 0, height = 0, bands = 1;
  int type = 8;                                 ///< a SampleType
  std::array<double, 6> map{0, 1, 0, 0, 0, 1};  ///< x = map[0] + map[1] column + map[2] row, likewise y; of corners
  bool is_placed = false;                       ///< `map` is from the file
  std::string crs;                              ///< "EPSG:32633", or WKT
  std::vector<std::string> names;               ///< of the bands, all different, for formats that have names; or none
  std::vector<double> values;  ///< the band varies fastest, then the column; NaN where there are no data
};

/// Points with numbers: columns x, y, z where there is one, and the numeric fields.
struct GdalTable {
  std::vector<std::string> names;
  std::vector<std::vector<double>> columns;
  std::vector<std::string> texts;  ///< names of fields that hold none
  std::string crs;
};

/// Lines in the plane, with one number each, or none.
struct GdalLines {
  std::vector<std::vector<double>> vertices;  ///< of each line: x, y of the first vertex, of the second one, ...
  std::string field;                          ///< name of the numbers; empty: none
  std::vector<double> numbers;
  std::string crs;
};

/// The functions of csrbf-gdal. Each returns why it failed, or an empty text.
struct GdalFunctions {
  std::string (*read_raster)(const std::string& path, GdalRaster& raster);
  std::string (*write_raster)(const std::string& path, const GdalRaster& raster);
  std::string (*read_table)(const std::string& path, GdalTable& table);
  std::string (*write_table)(const std::string& path, const GdalTable& table);
  std::string (*read_lines)(const std::string& path, GdalLines& lines);
  std::string (*write_lines)(const std::string& path, const GdalLines& lines);
  /// Is it in degrees of longitude and latitude? Also gives its short name where it has one.
  std::string (*describe_crs)(const std::string& crs, bool& geographic, std::string& short_name);
  std::string (*version)();
};

/// Of the function that returns the others: another version has another one.
#define CSRBF_GDAL_ENTRY csrbf_gdal_functions_4

}  // namespace csrbf
