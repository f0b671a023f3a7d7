#pragma once

#include "csrbf/core/mesh.hpp"
#include "figure.hpp"
#include "level_sets.hpp"

namespace csrbf::thesis {

/// A segmentation of `bone(n)` with its surface, cut off at the border of the image.
struct SegmentedBone {
  double dice = 0;
  double seconds = 0;
  std::shared_ptr<const Field<3>> field;
  Mesh mesh;
  Topology topology;
};

/// By collocation with nodes^3 nodes, two means, from a ball in the middle; noise of `snr` dB.
SegmentedBone bone_by_collocation(Index n, Index nodes, double snr);

/// By segment().
SegmentedBone bone_by_segment(Index n, double snr, const SegmentOptions& options = {});

/// Wendland's C4 function with wide supports: level sets that have curvatures, and are smoother.
SegmentOptions options_for_curvatures();

/// The surface that the image was made from.
Topology bone_topology(Index n);

/// Differences of curvatures from the exact ones at the vertices that are not near the border: rms of the mean
/// curvature in units of the rms principal curvature, of the Gaussian in its square.
struct CurvatureErrors {
  double mean = 0, gaussian = 0;
  double gaussian_correlation = 0;  ///< of the found with the exact ones
};

CurvatureErrors curvature_errors(const SegmentedBone& run, Index n);

/// Figs. 8.8 and 8.9. `file`: the name of an image file of bone to segment too, or empty.
Figure figure_8_8(const std::string& file = {});

}  // namespace csrbf::thesis
