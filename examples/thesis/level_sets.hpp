#pragma once

#include "csrbf/approx/basis/expansion.hpp"
#include "csrbf/core/image.hpp"
#include "csrbf/levelset/baselines/collocation.hpp"
#include "csrbf/levelset/segment.hpp"
#include "phantoms.hpp"

#include <memory>

namespace csrbf::thesis {

/// 1 in the disc (or ball) of this radius, 0 elsewhere.
std::vector<std::uint8_t> ball_labels(const Grid& grid, const Point<3>& center, double radius);

/// 2 |A and B| / (|A| + |B|)
double dice(const std::vector<std::uint8_t>& a, const std::vector<std::uint8_t>& b);

/// (8.29), (8.30) and (8.31) with the sign of the errata: V = (I - C1)^2 - (I - C2)^2. Appends the energy of the labels
/// to `energy` unless null. `image` must outlive the result.
ForceUpdate chan_vese_force(const Volume<float>& image, std::vector<double>* energy = nullptr);

/// (8.32): the logarithm of the likelihood of a generalised Gaussian inside less that outside, averaged over boxes of
/// 2 half_window + 1 voxels (printed: a circular window), with the sign for (7.11). `image` must outlive the result.
ForceUpdate generalized_gaussian_force(const Volume<float>& image, int half_window);

/// A segmentation and what it took.
struct SegmentedImage {
  std::vector<std::uint8_t> labels;
  std::shared_ptr<const Field<2>> field;
  double dice = 0;  ///< with the truth
  int iterations = 0;
  double seconds = 0;
};

/// The scheme of the thesis: Wendland's C2 function with a support of rho fill distances, the normalisation (8.28).
CollocationOptions published_options(double rho = 4);

/// The scheme with forces of two means, or with those given.
SegmentedImage collocate_nodes(const Phantom& phantom, const Nodes<2>& nodes, const std::vector<std::uint8_t>& start,
                               const CollocationOptions& options, const ForceUpdate& force = {});

/// What segment() makes of it.
SegmentedImage segmented(const Phantom& phantom, const SegmentOptions& options);

/// Length of the zero set inside the image.
double contour_length(const Field<2>& field);

/// A disc as a field: what a start looks like on a picture.
std::shared_ptr<const Field<2>> disc_field(const Grid& grid, const Point<2>& center, double radius);

/// The image with the zero sets of the fields, red and yellow.
RgbImage drawn(const Volume<float>& image, const std::vector<const Field<2>*>& fields);

/// f over the plane as a relief, its inside red; `height` is drawn .3 times as high as the image is long.
RgbImage relief(const Field<2>& field, double height);

}  // namespace csrbf::thesis
