#include "csrbf/io/files/text.hpp"
#include "csrbf/io/gdal/gdal.hpp"
#include "csrbf/io/images/formats.hpp"

#include <set>

namespace csrbf {

RawVolume read_gdal_image(const std::string& path) {
  const GdalRaster raster = read_gdal_raster(path);
  RawVolume raw;
  VolumeLayout& layout = raw.layout;
  layout.grid.axes = 2;
  layout.grid.size = {static_cast<Index>(raster.width), static_cast<Index>(raster.height), 1};
  layout.components = raster.bands;
  layout.type = static_cast<SampleType>(raster.type);
  layout.crs = raster.crs;
  if (raster.is_placed) {
    const auto& m = raster.map;
    Eigen::Matrix3d linear = Eigen::Matrix3d::Identity();
    linear.topLeftCorner<2, 2>() << m[1], m[2], m[4], m[5];
    layout.grid.origin << m[0] + (m[1] + m[2]) / 2, m[3] + (m[4] + m[5]) / 2, 0;
    set_axes(layout.grid, linear, path);
  }
  with_sample_type(layout.type, [&](auto sample) {
    using T = decltype(sample);
    raw.bytes.resize(raster.values.size() * sizeof(T));
    for (std::size_t i = 0; i < raster.values.size(); ++i)
      store_scalar(raw.bytes.data() + i * sizeof(T), narrow_scalar<T>(raster.values[i]));
  });
  raw.order = std::endian::little;
  return raw;
}

void write_gdal_image(const std::string& path, const VolumeLayout& layout, const std::string& samples,
                      const std::vector<std::string>& names) {
  const Grid& grid = layout.grid;
  GdalRaster raster;
  raster.width = grid.size[0];
  raster.height = grid.size[1];
  raster.bands = layout.components;
  raster.type = static_cast<int>(layout.type);
  raster.crs = layout.crs;
  if (std::ssize(names) == layout.components)
    for (const std::string& name : names) raster.names.push_back(single_word(name));
  if (std::set<std::string>(raster.names.begin(), raster.names.end()).size() < raster.names.size())
    raster.names.clear();
  raster.is_placed = true;
  const Eigen::Matrix3d linear = grid.direction * grid.spacing.asDiagonal();
  const Point<3> corner = grid.origin - 0.5 * (linear.col(0) + linear.col(1));
  raster.map = {corner.x(), linear(0, 0), linear(0, 1), corner.y(), linear(1, 0), linear(1, 1)};
  with_sample_type(layout.type, [&](auto sample) {
    using T = decltype(sample);
    raster.values.resize(samples.size() / sizeof(T));
    for (std::size_t i = 0; i < raster.values.size(); ++i)
      raster.values[i] = static_cast<double>(load_scalar<T>(samples.data() + i * sizeof(T)));
  });
  write_gdal_raster(path, raster);
}

}  // namespace csrbf
