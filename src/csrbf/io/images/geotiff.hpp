#pragma once

#include "csrbf/io/images/sample_codec.hpp"

#include <tiffio.h>

namespace csrbf {

// The place of an image on a map: GeoTIFF 1.1 (OGC 19-008), and world files.

/// Takes the place, the coordinate reference system and the value that means no data from the tags of the first page.
/// Throws IoError when they are damaged.
void read_geo_tags(TIFF* tiff, RawVolume& raw, const std::string& name);

/// Writes the place of the layout into the tags of a page; nothing when it has none. Throws IoError for reference
/// systems that are not known here.
void write_geo_tags(TIFF* tiff, const VolumeLayout& layout, const std::string& name);

/// True when the layout says more than the numbers of the pixels.
bool is_placed(const VolumeLayout& layout);

/// Is the reference system in degrees of longitude and latitude? By GDAL where it is at hand, else for the EPSG codes
/// whose kind is certain; nullopt when it is not known.
std::optional<bool> is_geographic(const std::string& crs);

/// The text of a world file: the map from pixels to the plane in six lines.
std::string format_world_file(const Grid& grid);

/// Places the image by such a text. Throws IoError "name:line: ...".
void parse_world_file(std::string_view text, Grid& grid, const std::string& name);

}  // namespace csrbf
