#pragma once

#include "csrbf/io/gdal/gdal_interface.hpp"

namespace csrbf {

// See GdalFunctions.
std::string read_table(const std::string& path, GdalTable& table);
std::string write_table(const std::string& path, const GdalTable& table);
std::string read_lines(const std::string& path, GdalLines& lines);
std::string write_lines(const std::string& path, const GdalLines& lines);

}  // namespace csrbf
