#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace csrbf::app {

/// Whether a column has a usual name of longitudes, in capitals or not.
bool is_longitude(std::string_view name);
/// Whether a column has a usual name of latitudes, in capitals or not.
bool is_latitude(std::string_view name);
/// Whether the first two names are usual ones of a latitude, northing or y, and of a longitude, easting or x.
bool are_northward_and_eastward(const std::vector<std::string>& names);

}  // namespace csrbf::app
