#pragma once

#include "csrbf/levelset/segment_options.hpp"

#include <vector>

namespace csrbf {

/// Segments an image of Dim axes into regions with smooth boundaries (thesis part IV). Of several components, such as
/// colours, a weighted sum is segmented: that in which the means of two classes differ (channel_contrast()), of roots
/// where no value is negative (root_channels()).
///
/// Order of the labels: of two regions, the seed marks label 1; without a seed, label 0 has most of the image
/// border. More than two are numbered by ascending mean. With seeds of all regions labels are those of the seeds.
///
/// With the energy `automatic`, in global mode and up to 8 million voxels, labels and model are those of the shortest
/// description (find_partition()) among means, means and deviations, generalised Gaussians, and means that vary
/// over the image, and the centres are as dense as the smallest objects ask for; else it is chan_vese. Two regions of
/// more voxels whose deviation is at most 0.3 of their contrast have labels of single voxels and a level set on blocks
/// of these (find_large_partition()), unless a center spacing is given.
///
/// A warning tells which region may be text or arrows drawn over a picture of two axes (find_drawn_over()). The noise
/// of two regions may vary over the place (find_uneven_noise()). Another warning tells which of two regions chosen by
/// description length consist of levels themselves (warn_of_levels()).
///
/// More than two regions may be classes of the blurred image instead (blurred_classes()). In local mode the energy
/// `automatic` finds the tissue that the seed lies in (find_seed_tissue()) and what borders on it, or, where there is
/// no such tissue, takes the better of means and of means with variances. Warnings say what is open.
///
/// Cost: of `automatic` 1 to 6 us per voxel; of the others about 0.1 us per voxel and iteration, 1 to 10 iterations,
/// 30 to 50 in local mode; memory up to 14 bytes per voxel besides the image
/// (2.4 GB in all for 512^3; 0.9 GB on blocks).
///
/// Throws InvalidInput for options out of their ranges, arrays of the wrong size, an image with fewer or more than Dim
/// axes, more than 64 components or one frame, infinite values inside the mask, a constant image, and a seed that is
/// empty or has no voxel inside the mask; Cancelled.
template <int Dim>
Segmentation<Dim> segment(const Volume<float>& image, const SegmentOptions& options = {});

/// The same by settings alone: `segment<2>(image, {.regions = 3})`.
template <int Dim>
Segmentation<Dim> segment(const Volume<float>& image, const SegmentSettings& settings) {
  return segment<Dim>(image, SegmentOptions{settings});
}

/// Size of one region of a segmentation.
struct RegionMeasure {
  int label = 0;
  Index voxels = 0;
  double volume = 0;  ///< of the level set, not of the voxels; 2D: area. In the unit of the spacing, cubed (squared)
  double area = 0;    ///< of its boundary inside the image; 2D: length
  double mean = 0;    ///< of the intensities of its voxels
};

/// Measures all regions but 0 by their contours within the image, with errors of fourth order in the spacing of the
/// centers (image_contour()). Ignores masks: a level set continues behind them.
template <int Dim>
std::vector<RegionMeasure> measure_segmentation(const Segmentation<Dim>& segmentation, const Grid& grid);

}  // namespace csrbf
