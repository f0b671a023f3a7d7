// The part of the library that links GDAL: csrbf-gdal, loaded by io/gdal/gdal.cpp when it is needed.

#include "gdal/rasters.hpp"
#include "gdal/reference_system.hpp"
#include "gdal/vectors.hpp"

#include <gdal.h>

namespace csrbf {
namespace {

std::string version() {
  return GDALVersionInfo("RELEASE_NAME");
}

}  // namespace
}  // namespace csrbf

extern "C" __attribute__((visibility("default"))) const csrbf::GdalFunctions* CSRBF_GDAL_ENTRY() {
  static const csrbf::GdalFunctions functions{csrbf::read_raster,  csrbf::write_raster, csrbf::read_table,
                                              csrbf::write_table,  csrbf::read_lines,   csrbf::write_lines,
                                              csrbf::describe_crs, csrbf::version};
  GDALAllRegister();
  return &functions;
}
