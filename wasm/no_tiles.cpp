// In a page there are neither processes nor files to work in tiles with: these take the place of the library's.
#include "csrbf/core/error.hpp"
#include "csrbf/tiles/fit_tiles.hpp"
#include "csrbf/tiles/inpaint_slices.hpp"
#include "csrbf/tiles/reconstruct_tiles.hpp"

namespace csrbf {
namespace {

[[noreturn]] void refuse() {
  throw InvalidInput("work in tiles or by slices needs the program outside the browser");
}

}  // namespace

TileReport reconstruct_tiles(const std::string& /*points*/, const std::string& /*mesh*/,
                             const TileOptions& /*options*/) {
  refuse();
}

FitTileReport fit_tiles(const std::string& /*samples*/, const std::string& /*model*/,
                        const FitTileOptions& /*options*/) {
  refuse();
}

InpaintSlicesReport inpaint_slices(const std::string& /*image*/, const std::string& /*output*/,
                                   const InpaintSlicesOptions& /*options*/) {
  refuse();
}

}  // namespace csrbf
