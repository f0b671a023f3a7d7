#include "csrbf/tiles/folder/model_places.hpp"

#include "csrbf/io/files/open_file.hpp"

namespace csrbf {

std::vector<TilePlace> model_places(const TileFolder& folder, Index tiles) {
  std::vector<TilePlace> places;
  for (Index t = 0; t < tiles; ++t) {
    const std::string file = folder.file("model", t);
    places.push_back({file, 0, static_cast<std::int64_t>(std::filesystem::file_size(utf8_path(file)))});
  }
  return places;
}

}  // namespace csrbf
