#pragma once

#include "csrbf/levelset/segment_options.hpp"

#include <vector>

namespace csrbf {

/// Segments an image of Dim axes into regions with smooth boundaries (thesis part IV).
///
/// Labels: with two regions, label 1 is the region that the seed covers more of; without a seed, label 0 is the one
/// with most of the image border, or, if both have a quarter of it, the one whose shape looks less like objects. More
/// than two regions are numbered by ascending mean intensity. With `seeds` the labels are those of the seeds.
///
/// Energy `automatic` in global mode, up to 8 million voxels (2^23): the model with the shortest description of the
/// image is chosen among means, means with standard deviations, generalised Gaussians, and means that vary over the
/// image; the centres are as dense as the smallest objects need. Noise may be correlated, grow with intensity or vary
/// over the image. More than two regions may be classes of the blurred image. Two regions of larger images, if the
/// standard deviation of the noise is at most 0.3 of the contrast and no centre spacing is given, get labels by two
/// means and a level set on blocks of voxels. In all other cases, and with a window, smoothness, start or prior, the
/// energy is chan_vese.
///
/// Energy `automatic` in local mode: follows the tissue that the seed lies in and what borders on it. If no such tissue
/// is found, takes the better one of a contour of means and a contour of means with variances.
///
/// Several components, such as colours: segments their weighted sum in which the means of two classes differ most; of
/// their square roots if no value is negative.
///
/// Warnings name what remains open: regions that may be noise, that consist of more levels of intensity, or that are
/// text or arrows drawn over a 2D picture.
///
/// Cost: 1 to 6 us per voxel with `automatic`; otherwise about 0.1 us per voxel and iteration, with 1 to 10 iterations,
/// 30 to 50 in local mode. Memory: up to 14 bytes per voxel besides the image (512^3: 2.4 GB in all, 0.9 GB on blocks).
///
/// Throws InvalidInput for options out of range or that do not go together, arrays of the wrong size, an image whose
/// number of axes is not Dim or that has more than 64 components or more than one frame, infinite values inside the
/// mask, a constant image, and a mask, seed or start without any voxel in the image and its mask; Cancelled.
template <int Dim>
Segmentation<Dim> segment(const Volume<float>& image, const SegmentOptions& options = {});

/// The same with settings alone: `segment<2>(image, {.regions = 3})`.
template <int Dim>
Segmentation<Dim> segment(const Volume<float>& image, const SegmentSettings& settings) {
  return segment<Dim>(image, SegmentOptions{settings});
}

/// Size of one region of a segmentation.
struct RegionMeasure {
  int label = 0;
  Index voxels = 0;
  double volume = 0;  ///< inside the level set, in the unit of the spacing, cubed; 2D: area, squared
  double area = 0;    ///< of the boundary inside the image; 2D: length
  double mean = 0;    ///< mean intensity of its voxels
};

/// Measures all regions but 0 by their contours within the image (image_contour()). The error is of fourth order in the
/// centre spacing. Masks are ignored: a level set continues behind them.
template <int Dim>
std::vector<RegionMeasure> measure_segmentation(const Segmentation<Dim>& segmentation, const Grid& grid);

}  // namespace csrbf
