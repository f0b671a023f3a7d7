#include "csrbf/io/files/guessed_format.hpp"

#include <algorithm>

namespace csrbf {
namespace {

using namespace std::string_view_literals;

struct Mark {
  std::size_t place;
  std::string_view bytes, extension;
};

constexpr std::size_t nifti_1 = 344, nifti_2 = 4;  // where these say what they are

// The first that fits counts.
constexpr Mark marks[] = {{0, "ply\n"sv, ".ply"},       {0, "ply\r"sv, ".ply"},      {0, "LASF"sv, ".las"},
                          {0, "ASTM-E57"sv, ".e57"},    {0, "# .PCD"sv, ".pcd"},     {0, "\x93NUMPY"sv, ".npy"},
                          {0, "OFF"sv, ".off"},         {0, "COFF"sv, ".off"},       {0, "NOFF"sv, ".off"},
                          {0, "solid "sv, ".stl"},      {0, "\x89PNG"sv, ".png"},    {0, "\xFF\xD8\xFF"sv, ".jpg"},
                          {0, "BM"sv, ".bmp"},          {0, "II*\0"sv, ".tif"},      {0, "MM\0*"sv, ".tif"},
                          {0, "II+\0"sv, ".tif"},       {0, "MM\0+"sv, ".tif"},      {0, "NRRD000"sv, ".nrrd"},
                          {0, "ObjectType"sv, ".mha"},  {0, "P5\n"sv, ".pgm"},       {0, "P2\n"sv, ".pgm"},
                          {0, "P6\n"sv, ".ppm"},        {0, "P3\n"sv, ".ppm"},       {0, "SQLite format 3"sv, ".gpkg"},
                          {0, "CDF\x01"sv, ".nc"},      {0, "CDF\x02"sv, ".nc"},     {0, "glTF"sv, ".glb"},
                          {nifti_1, "n+1\0"sv, ".nii"}, {nifti_2, "n+2\0"sv, ".nii"}};

}  // namespace

std::string guessed_format(std::string_view bytes) {
  for (const auto& [place, mark, extension] : marks)
    if (bytes.size() >= place && bytes.substr(place).starts_with(mark)) {
      // Compressed points of LAS have a bit of their format set.
      constexpr std::size_t point_format = 104, bitmap_reserved = 6;
      if (extension == ".bmp" && bytes.substr(std::min(bitmap_reserved, bytes.size()), 4) != "\0\0\0\0"sv) continue;
      if (extension == ".las" && bytes.size() > point_format && (bytes[point_format] & 0x80) != 0) return ".laz";
      return std::string(extension);
    }
  constexpr std::size_t head = 400;  // bytes, in which XML says what it is
  const std::string_view beginning = bytes.substr(0, head);
  if (beginning.find("<VTKFile") != std::string_view::npos)
    return beginning.find("ImageData") != std::string_view::npos ? ".vti" : ".vtp";
  return "";
}

}  // namespace csrbf
