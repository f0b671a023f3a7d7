#include "csrbf/io/image.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/io/files/atomic_file.hpp"
#include "csrbf/io/files/read_file.hpp"
#include "csrbf/io/images/formats.hpp"

namespace csrbf {

void write_png(const std::string& path, const RgbImage& image) {
  if (file_extension(path) != ".png") refuse_extension(path, file_extension(path), "pictures are .png");
  require(image.width > 0 && image.height > 0, "write_png", "size",
          std::to_string(image.width) + "x" + std::to_string(image.height), "both sides must be positive");
  const std::size_t bytes = std::size_t{3} * image.width * image.height;
  require(image.pixels.size() == bytes, "write_png", "bytes of pixels", image.pixels.size(),
          "three per pixel are needed");

  VolumeLayout layout;
  layout.grid.axes = 2;
  layout.grid.size = {image.width, image.height, 1};
  layout.components = 3;
  layout.type = SampleType::uint8;
  const std::string_view samples(reinterpret_cast<const char*>(image.pixels.data()), bytes);
  write_file(path, format_png(layout, samples, path).head);
}

}  // namespace csrbf
