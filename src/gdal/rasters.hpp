#pragma once

#include "csrbf/io/gdal/gdal_interface.hpp"

namespace csrbf {

// See GdalFunctions.
std::string read_raster(const std::string& path, GdalRaster& raster);
std::string write_raster(const std::string& path, const GdalRaster& raster);

}  // namespace csrbf
