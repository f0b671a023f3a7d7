#pragma once

#include "figure.hpp"
#include "level_sets.hpp"

namespace csrbf::thesis {

/// The shape of Fig. 8.2 at one level of noise (infinite: none), from a disc in it.
struct NoiseCase {
  double snr = 0;            ///< dB
  SegmentedImage published;  ///< collocation with 100 x 100 nodes
  SegmentedImage ours;       ///< segment()
};

NoiseCase noise_case(double snr, unsigned seed);

/// Fig. 8.3: the same for supports of rho fill distances.
SegmentedImage with_support(double snr, double rho, unsigned seed);

/// Figs. 8.2 and 8.3.
Figure figure_8_2();

}  // namespace csrbf::thesis
