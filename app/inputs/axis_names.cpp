#include "inputs/axis_names.hpp"

#include "csrbf/io/files/text.hpp"

#include <algorithm>
#include <initializer_list>

namespace csrbf::app {
namespace {

bool is_name_of(std::string_view word, std::initializer_list<std::string_view> words) {
  return std::find(words.begin(), words.end(), lower_case(word)) != words.end();
}

}  // namespace

bool is_longitude(std::string_view name) {
  return is_name_of(name, {"lon", "long", "longitude", "lng", "x_lon"});
}

bool is_latitude(std::string_view name) {
  return is_name_of(name, {"lat", "latitude", "y_lat"});
}

bool are_northward_and_eastward(const std::vector<std::string>& names) {
  return names.size() > 1 && (is_latitude(names[0]) || is_name_of(names[0], {"y", "northing", "north"})) &&
         (is_longitude(names[1]) || is_name_of(names[1], {"x", "easting", "east"}));
}

}  // namespace csrbf::app
