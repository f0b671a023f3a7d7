#pragma once

#include "csrbf/core/grid.hpp"

#include <tiffio.h>

#include <optional>
#include <string>

namespace csrbf {

/// What the pages of a stack of a microscope are, as ImageJ and OME-TIFF say in the description of the first page.
struct TiffPages {
  Index channels = 1, slices = 1, frames = 1;
  std::string order = "CZT";  ///< which of them goes fastest from page to page
  Point<3> spacing{1, 1, 1};  ///< of x, y and z
  [[nodiscard]] Index count() const { return channels * slices * frames; }

  struct Place {
    Index channel, slice, frame;
  };
  [[nodiscard]] Place place(Index page) const;
};

/// Of the page that is open, the first of `pages` with so many values per pixel; nothing where it says nothing, or
/// something else than the file has.
std::optional<TiffPages> tiff_pages(TIFF* tiff, Index pages, Index components);

/// The description of a file with several frames, as ImageJ writes it.
std::string frames_text(const VolumeLayout& layout);

}  // namespace csrbf
