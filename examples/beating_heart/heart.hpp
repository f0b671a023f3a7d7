#pragma once

#include "csrbf/core/grid.hpp"

#include <vector>

/// What noise a scanner adds.
enum class Noise { gaussian, speckle };

/// A left ventricle that beats once: the cavity is bright, with two dark papillary muscles, in a darker wall, in
/// tissue.
struct Heart {
  int dimension = 2;  ///< 2: a short-axis slice, 3: a volume
  csrbf::Index size = 128, frames = 20;
  double voxel = 1;  ///< mm
  Noise noise = Noise::gaussian;
  double decibels = 20;  ///< 10 log10(variance of the image over that of the noise)
  unsigned seed = 1;
};

/// Depth of a point inside the cavity in mm, about its distance to the wall; negative outside. `phase` of the beat in
/// [0, 1), the end of diastole first.
double cavity_depth(const Heart& heart, const csrbf::Point<3>& p, double phase);

/// Volume (2D: area) of the cavity with its papillary muscles.
double cavity_volume(const Heart& heart, double phase);

csrbf::Volume<float> make_sequence(const Heart& heart);

/// 1 inside the cavity, for every voxel of a frame.
std::vector<std::uint8_t> true_labels(const Heart& heart, csrbf::Index frame);
