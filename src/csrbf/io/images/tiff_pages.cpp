#include "csrbf/io/images/tiff_pages.hpp"

#include "csrbf/io/files/text.hpp"

#include <cmath>
#include <string_view>

namespace csrbf {
namespace {

// What follows `before` up to `end`; empty where it does not occur.
std::string_view text_after(std::string_view text, std::string_view before, char end) {
  const std::size_t at = text.find(before);
  if (at == std::string_view::npos) return {};
  const std::string_view rest = text.substr(at + before.size());
  return rest.substr(0, rest.find(end));
}

Index count_of(std::string_view text) {
  constexpr std::int64_t most = 1 << 20;
  const auto count = parse_integer(trimmed(text));
  return count && *count > 0 && *count < most ? static_cast<Index>(*count) : 1;
}

double length_of(std::string_view text) {
  const auto length = parse_number(trimmed(text));
  return length && *length > 0 && std::isfinite(*length) ? *length : 1;
}

// Pixels per unit are in the tags, the rest in lines key=value.
TiffPages pages_of_imagej(TIFF* tiff, std::string_view text) {
  const auto value = [&](const std::string& key) { return text_after(text, "\n" + key + "=", '\n'); };
  TiffPages pages;
  pages.channels = count_of(value("channels"));
  pages.slices = count_of(value("slices"));
  pages.frames = count_of(value("frames"));
  if (pages.count() == 1) pages.slices = count_of(value("images"));
  pages.spacing.z() = length_of(value("spacing"));
  const std::string_view unit = trimmed(value("unit"));
  if (unit.empty() || unit == "pixel") return pages;
  float x = 0, y = 0;
  if (TIFFGetField(tiff, TIFFTAG_XRESOLUTION, &x) != 0 && x > 0) pages.spacing.x() = 1 / static_cast<double>(x);
  if (TIFFGetField(tiff, TIFFTAG_YRESOLUTION, &y) != 0 && y > 0) pages.spacing.y() = 1 / static_cast<double>(y);
  return pages;
}

// The attributes of the first image.
TiffPages pages_of_ome(std::string_view text) {
  const std::string_view tag = text_after(text, "<Pixels", '>');
  const auto value = [&](const std::string& key) { return text_after(tag, " " + key + "=\"", '"'); };
  TiffPages pages;
  pages.channels = count_of(value("SizeC"));
  pages.slices = count_of(value("SizeZ"));
  pages.frames = count_of(value("SizeT"));
  pages.spacing << length_of(value("PhysicalSizeX")), length_of(value("PhysicalSizeY")),
      length_of(value("PhysicalSizeZ"));
  const std::string_view order = value("DimensionOrder");
  for (const char* known : {"CZT", "CTZ", "ZCT", "ZTC", "TCZ", "TZC"})
    if (order == std::string("XY") + known) pages.order = known;
  return pages;
}

}  // namespace

TiffPages::Place TiffPages::place(Index page) const {
  Place at{0, 0, 0};
  for (const char axis : order) {
    const Index size = axis == 'C' ? channels : axis == 'Z' ? slices : frames;
    (axis == 'C' ? at.channel : axis == 'Z' ? at.slice : at.frame) = page % size;
    page /= size;
  }
  return at;
}

std::optional<TiffPages> tiff_pages(TIFF* tiff, Index pages, Index components) {
  const char* description = nullptr;
  if (TIFFGetField(tiff, TIFFTAG_IMAGEDESCRIPTION, &description) == 0 || description == nullptr) return std::nullopt;
  const std::string_view text = description;
  const bool imagej = text.starts_with("ImageJ="), ome = text.find("<OME") != std::string_view::npos;
  if (!imagej && !ome) return std::nullopt;
  TiffPages found = imagej ? pages_of_imagej(tiff, text) : pages_of_ome(text);
  if (components > 1 && found.channels == components) found.channels = 1;  // those of each pixel
  if (found.count() != pages || (components > 1 && found.channels > 1)) return std::nullopt;
  return found;
}

std::string frames_text(const VolumeLayout& layout) {
  const Index slices = layout.grid.size[2];
  std::string text = "ImageJ=1.53\nimages=" + std::to_string(slices * layout.frames);
  if (slices > 1) text += "\nslices=" + std::to_string(slices);
  return text + "\nframes=" + std::to_string(layout.frames) + "\nhyperstack=true\n";
}

}  // namespace csrbf
