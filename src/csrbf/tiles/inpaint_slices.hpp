#pragma once

#include "csrbf/approx/inpaint.hpp"

#include <string>

namespace csrbf {

struct InpaintSlicesOptions {
  double memory = 2e9;                 ///< bytes, from which the size of blocks follows
  std::string mask = {};               ///< file of an image of the same size, not 0 where values are missing
  std::optional<double> missing = {};  ///< value that marks missing ones
  InpaintOptions inpaint = {};
};

struct InpaintSlicesReport {
  InpaintReport inpaint;  ///< counts of the whole image; the rest is that of the block with the most missing values
  VolumeLayout layout;    ///< of the image
  Index blocks = 0;       ///< of slices, in which values were filled
};

/// inpaint() for images of three axes that are larger than memory, from file to file: .nii, .nii.gz and .npy, of one
/// component and one frame.
///
/// Slices are filled block by block, each seen with those around it, up to what is needed of known values. The block
/// with the most missing values chooses the plan for all, by trials. Blocks end where little is missing; values of one
/// that missing ones on both sides of its border belong to are filled from both sides. Slices in which nothing is
/// missing are copied. An image that fits in the memory is one block, and the result that of inpaint().
///
/// Throws as inpaint(), IoError for files, InvalidInput when the memory is too little or the image cannot be read by
/// slices.
InpaintSlicesReport inpaint_slices(const std::string& image, const std::string& output,
                                   const InpaintSlicesOptions& options);

}  // namespace csrbf
