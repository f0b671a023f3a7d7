#pragma once

#include <ogr_srs_api.h>

#include <memory>
#include <string>
#include <type_traits>

namespace csrbf {

struct Destroy {
  void operator()(OGRSpatialReferenceH system) const { OSRDestroySpatialReference(system); }
};
using ReferenceSystem = std::unique_ptr<std::remove_pointer_t<OGRSpatialReferenceH>, Destroy>;

/// Its name in a register, such as "EPSG:32633", else its WKT; empty for null.
std::string name_of(OGRSpatialReferenceH system);

/// Null when there is none, or it is not known.
ReferenceSystem system_of(const std::string& crs);

/// See GdalFunctions.
std::string describe_crs(const std::string& crs, bool& geographic, std::string& short_name);

}  // namespace csrbf
