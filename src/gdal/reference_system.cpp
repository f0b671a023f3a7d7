#include "gdal/reference_system.hpp"

#include "gdal/handles.hpp"

#include <cpl_conv.h>

namespace csrbf {
namespace {

std::string short_name_of(OGRSpatialReferenceH system) {
  const char *authority = OSRGetAuthorityName(system, nullptr), *code = OSRGetAuthorityCode(system, nullptr);
  return authority != nullptr && code != nullptr ? std::string(authority) + ":" + code : "";
}

// The name of the system in the register of EPSG that is the same but for its name, as of the .prj files of ESRI.
std::string registered_name_of(OGRSpatialReferenceH system) {
  constexpr int same = 90;  // per cent, by GDAL
  int count = 0;
  int* confidences = nullptr;
  OGRSpatialReferenceH* matches = OSRFindMatches(system, nullptr, &count, &confidences);
  const std::string name = count > 0 && confidences[0] >= same ? short_name_of(matches[0]) : "";
  OSRFreeSRSArray(matches);
  CPLFree(confidences);
  return name;
}

}  // namespace

std::string name_of(OGRSpatialReferenceH system) {
  if (system == nullptr) return "";
  if (std::string name = short_name_of(system); !name.empty()) return name;
  if (std::string name = registered_name_of(system); !name.empty()) return name;
  char* text = nullptr;
  const std::string wkt = OSRExportToWkt(system, &text) == OGRERR_NONE && text != nullptr ? text : "";
  CPLFree(text);
  return wkt;
}

ReferenceSystem system_of(const std::string& crs) {
  if (crs.empty()) return nullptr;
  ReferenceSystem system(OSRNewSpatialReference(nullptr));
  if (OSRSetFromUserInput(system.get(), crs.c_str()) != OGRERR_NONE) return nullptr;
  OSRSetAxisMappingStrategy(system.get(), OAMS_TRADITIONAL_GIS_ORDER);
  return system;
}

std::string describe_crs(const std::string& crs, bool& geographic, std::string& short_name) {
  const Quiet quiet;
  const ReferenceSystem system = system_of(crs);
  if (!system) return Quiet::reason("no such reference system");
  geographic = OSRIsGeographic(system.get()) != 0;
  short_name = name_of(system.get());
  return "";
}

}  // namespace csrbf
