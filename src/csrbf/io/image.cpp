#include "csrbf/io/image.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/io/atomic_file.hpp"
#include "csrbf/io/read_file.hpp"
#include "csrbf/io/text.hpp"

#include <png.h>

namespace csrbf {

void write_png(const std::string& path, const RgbImage& image) {
  if (file_extension(path) != ".png")
    throw IoError(path + ": unknown extension " + in_quotes(file_extension(path)) + "; pictures are .png");
  require(image.width > 0 && image.height > 0, "write_png", "size",
          std::to_string(image.width) + "x" + std::to_string(image.height), "both sides must be positive");
  const std::size_t bytes =
      std::size_t{3} * static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
  require(image.pixels.size() == bytes, "write_png", "bytes of pixels", image.pixels.size(),
          "three per pixel are needed");

  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  png.width = static_cast<png_uint_32>(image.width);
  png.height = static_cast<png_uint_32>(image.height);
  png.format = PNG_FORMAT_RGB;
  std::string encoded(PNG_IMAGE_PNG_SIZE_MAX(png), '\0');
  png_alloc_size_t size = encoded.size();
  if (png_image_write_to_memory(&png, encoded.data(), &size, 0, image.pixels.data(), 0, nullptr) == 0)
    throw IoError(path + ": cannot encode the picture: " + png.message);
  encoded.resize(size);
  write_file(path, encoded);
}

}  // namespace csrbf
